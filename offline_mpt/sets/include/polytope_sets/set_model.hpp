#pragma once

#include <string>
#include <vector>

#include "polytope_sets/exact_polytope.hpp"
#include "region_maps/signal.hpp"

namespace polyfly {

/// A parameter of a map that is no state of the model.
struct ModelParameter {
  Signal signal;
  int input = -1;  ///< its next value is this input's present one (u_prev); -1: it is held constant
};

/// x+ = A x + B u + A_p q + E d + c,  x in X, u in U, d in D, with q the values of `parameters`.
///
/// Sizes: x nx, u nu, d nd, q nq; any but nx may be 0. X and U may be unbounded in a model that only says how the
/// state moves. D is bounded and not empty (the one point of zero dimensions when nd = 0).
struct SetModel {
  std::string name;
  /// Names and units of signals.
  std::vector<Signal> states;
  std::vector<Signal> inputs;
  std::vector<Signal> disturbances;
  std::vector<ModelParameter> parameters;
  RationalMatrix A;    ///< nx x nx
  RationalMatrix B;    ///< nx x nu
  RationalMatrix A_p;  ///< nx x nq
  RationalMatrix E;    ///< nx x nd
  RationalVector c;    ///< nx
  ExactPolytope X;
  ExactPolytope U;
  ExactPolytope D;

  int stateCount() const { return static_cast<int>(A.rows()); }
  int inputCount() const { return static_cast<int>(B.cols()); }
  int disturbanceCount() const { return static_cast<int>(E.cols()); }
};

/// Reads a set or a model, YAML or JSON, in the form that offline_mpt/sets/README.md describes. Numbers are
/// taken as they are written: 0.1 is one tenth. Throw Error `file:line: field: rule`.
ExactPolytope loadSet(const std::string& path);
ExactPolytope parseSet(const std::string& text, const std::string& source);
SetModel loadModel(const std::string& path);
SetModel parseModel(const std::string& text, const std::string& source);

/// A set as a JSON text that loadSet reads back to the same set: whole numbers and fractions.
std::string setText(const ExactPolytope& set);

}  // namespace polyfly
