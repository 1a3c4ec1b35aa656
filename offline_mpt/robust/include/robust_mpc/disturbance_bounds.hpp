#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "robust_mpc/robust_problem.hpp"

namespace polyfly {

struct BoundsOptions {
  /// Share of disturbances that the range of a channel shall hold, in (0, 1).
  double coverage = 0.99;
  /// Confidence that the range holds the share `coverage`, in (0, 1).
  double confidence = 0.95;
  /// Only every n-th step counts towards the confidence, which assumes independent samples.
  int every = 1;
};

/// What recorded flights say of one channel.
struct ChannelBounds {
  std::string name;
  std::string unit;
  std::size_t samples = 0;
  /// Range to write into a problem file.
  double lower = 0.0;  ///< [unit]
  double upper = 0.0;
  /// Share of all samples within the range.
  double covered = 0.0;
  /// Confidence that the range holds `coverage`: as asked, or less where there are too few samples.
  double confidence = 0.0;
  /// Least value of all samples.
  double least = 0.0;
  double greatest = 0.0;
  double mean = 0.0;
  /// Share of all samples within the range that the problem has now.
  double declared = 0.0;
};

struct DisturbanceBounds {
  std::vector<ChannelBounds> channels;
  /// Share of x_{k+1} - A x_k - B u_k that no disturbance of the model explains, root mean square relative to the
  /// whole. States are weighed alike in half ranges of their errors. Near 1 says that the model is wrong.
  double unexplained = 0.0;
};

/// Disturbances that act at each step of recorded flights, w_k = G^+ (x_{k+1} - A x_k - B u_k), and a range for each
/// channel. It is the shortest range between order statistics of equal rank from both ends that holds `coverage` with
/// `confidence`. That holds whatever their distribution (Wilks, 1941). A flight is rows of states, then inputs, one
/// sampling time apart; rows with a NaN split it. Throws Error when there is no pair of rows, options are out of
/// range, or columns of G depend on each other.
DisturbanceBounds boundDisturbances(const RobustProblem& problem,
                                    const std::vector<std::vector<std::vector<double>>>& flights,
                                    const BoundsOptions& options);

/// For people (ranges ready for a problem file), and as JSON.
std::string boundsText(const DisturbanceBounds& bounds, const BoundsOptions& options);
std::string boundsJson(const DisturbanceBounds& bounds, const BoundsOptions& options);

}  // namespace polyfly
