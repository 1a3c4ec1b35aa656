#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "region_maps/signal.hpp"

namespace polyfly {

class RegionMap;

/// The model that the page flies a map's law with: e+ = A e + B (u - U theta) + G w. Matrices are row-major. The
/// first nu inputs of the map are u; entries of theta that are neither an error nor a previous input stay as they are.
struct ExplorerModel {
  struct PreviousInput {
    std::size_t parameter = 0;
    std::size_t input = 0;
  };

  double period = 0.0;  ///< [s]
  /// Per state, the entry of theta that is its error.
  std::vector<std::size_t> errors;
  std::size_t input_count = 0;  ///< nu
  std::vector<double> A;        ///< nx x nx
  std::vector<double> B;        ///< nx x nu
  /// Steady-state input as a function of theta.
  std::vector<double> U;  ///< nu x p
  std::vector<double> G;  ///< nx x nw
  /// The w that a user may choose, constant over a flight.
  std::vector<Signal> disturbances;
  std::vector<PreviousInput> previous_inputs;
};

/// min_z 1/2 z'Hz + (f + F theta)'z, A z <= b + S theta, and the part of the cost without z. Row-major.
struct ExplorerProgram {
  std::size_t variables = 0;  ///< n
  std::vector<double> H;      ///< n x n
  std::vector<double> f;      ///< n
  std::vector<double> F;      ///< n x p
  std::vector<double> A;      ///< m x n
  std::vector<double> b;      ///< m
  std::vector<double> S;      ///< m x p
  std::vector<int> equalities;
  /// Symmetric, in (theta, 1).
  std::vector<double> rest;  ///< (p + 1) x (p + 1)
};

/// Samples of a recorded flight.
struct ExplorerFlight {
  /// What the samples are, for people.
  std::string source;
  std::vector<double> times;   ///< [s]
  std::vector<double> thetas;  ///< p numbers for each time
};

/// What the page shows beyond the map itself.
struct ExplorerContent {
  std::optional<ExplorerModel> model;
  /// A sentence for the page where there is no model.
  std::string no_model;
  std::optional<ExplorerProgram> program;
  /// A sentence for the page where there is no program.
  std::string no_cost;
  /// Names of the program's rows. Rows beyond them are shown by number.
  std::vector<std::string> constraints;
  std::optional<ExplorerFlight> flight;
};

/// One HTML file that shows the map and computes everything else in the browser. It holds the bytes of the map, needs
/// no network, and names in it cannot become markup. The same arguments give the same bytes. Sizes of model and program fit the
/// map. Throws Error when those of the flight do not, or the program lacks active rows.
std::string explorerPage(const RegionMap& map, const ExplorerContent& content);

/// RFC 4648, with padding.
std::string base64(std::string_view bytes);

}  // namespace polyfly
