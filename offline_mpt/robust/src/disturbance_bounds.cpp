#include "robust_mpc/disturbance_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "mpc_core/decompositions.hpp"
#include "polyfly_base/error.hpp"
#include "rational_parts.hpp"

namespace polyfly {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// P(at least `count` of n samples lie in the tails that hold 1 - coverage): with the ranks that leave out
/// `count` - 1 samples, the confidence that what is between holds `coverage`.
double confidenceOf(std::size_t n, std::size_t count, double coverage) {
  double sum = 0.0;  // P(fewer than count)
  const double log_in = std::log(coverage), log_out = std::log1p(-coverage);
  const auto size = static_cast<double>(n);
  for (std::size_t k = 0; k < count && k <= n; ++k) {
    const auto out = static_cast<double>(k);
    sum += std::exp(std::lgamma(size + 1.0) - std::lgamma(out + 1.0) - std::lgamma(size - out + 1.0) +
                    out * log_out + (size - out) * log_in);
  }
  return std::max(0.0, 1.0 - sum);
}

class Estimation {
 public:
  explicit Estimation(const RobustProblem& problem)
      : problem_(problem), A_(toDoubles(problem.A)), B_(toDoubles(problem.B)), G_(toDoubles(problem.G)) {
    // Scales each column of G back to the channel's unit.
    for (Eigen::Index c = 0; c < G_.cols(); ++c) {
      const Signal& channel = problem.disturbances[at(c)];
      G_.col(c) *= 2.0 / (channel.upper - channel.lower);
    }
    weight_ = VectorXd::Ones(G_.rows());
    const std::vector<int> errors = problem.errorParameters();
    for (Eigen::Index i = 0; i < weight_.size(); ++i) {
      const Signal& error = problem.parameters[at(errors[at(i)])].signal;
      weight_[i] = 2.0 / (error.upper - error.lower);
    }
    solver_.emplace(weight_.asDiagonal() * G_);
    if (solver_->rank() < G_.cols())
      throw Error(problem.source + ": model.G: columns must not depend on each other");
    samples_.resize(at(G_.cols()));
  }

  void add(const std::vector<std::vector<double>>& rows) {
    for (std::size_t k = 0; k + 1 < rows.size(); ++k) {
      const VectorXd row =
          Eigen::Map<const VectorXd>(rows[k].data(), static_cast<Eigen::Index>(rows[k].size()));
      const VectorXd next = Eigen::Map<const VectorXd>(rows[k + 1].data(), A_.rows());
      if (!row.allFinite() || !next.allFinite()) continue;
      const VectorXd rest =
          weight_.asDiagonal() * (next - A_ * row.head(A_.rows()) - B_ * row.segment(A_.rows(), B_.cols()));
      const VectorXd w = solver_->solve(rest);
      total_ += rest.squaredNorm();
      unexplained_ += (rest - weight_.asDiagonal() * G_ * w).squaredNorm();
      for (Eigen::Index c = 0; c < w.size(); ++c) samples_[at(c)].push_back(w[c]);
    }
  }

  DisturbanceBounds result(const BoundsOptions& options) const {
    if (samples_[0].empty()) throw Error(problem_.source + ": no two rows of a flight follow each other");
    DisturbanceBounds bounds;
    bounds.unexplained = total_ > 0.0 ? std::sqrt(unexplained_ / total_) : 0.0;
    for (std::size_t c = 0; c < samples_.size(); ++c)
      bounds.channels.push_back(channel(samples_[c], problem_.disturbances[c], options));
    return bounds;
  }

 private:
  static double share(const std::vector<double>& sorted, double lower, double upper) {
    const auto first = std::lower_bound(sorted.begin(), sorted.end(), lower);
    const auto last = std::upper_bound(sorted.begin(), sorted.end(), upper);
    return static_cast<double>(last - first) / static_cast<double>(sorted.size());
  }

  static ChannelBounds channel(std::vector<double> all, const Signal& signal, const BoundsOptions& options) {
    std::vector<double> counted;
    for (std::size_t k = 0; k < all.size(); k += static_cast<std::size_t>(options.every))
      counted.push_back(all[k]);
    std::sort(counted.begin(), counted.end());
    std::sort(all.begin(), all.end());
    // leave out `cut` samples at each end, as many as the confidence admits
    std::size_t cut = 0;
    while (2 * (cut + 1) + 1 < counted.size() &&
           confidenceOf(counted.size(), 2 * (cut + 2), options.coverage) >= options.confidence)
      ++cut;
    ChannelBounds bounds;
    bounds.name = signal.name;
    bounds.unit = signal.unit;
    bounds.samples = all.size();
    bounds.lower = counted[cut];
    bounds.upper = counted[counted.size() - 1 - cut];
    bounds.covered = share(all, bounds.lower, bounds.upper);
    bounds.confidence = confidenceOf(counted.size(), 2 * (cut + 1), options.coverage);
    bounds.least = all.front();
    bounds.greatest = all.back();
    for (const double value : all) bounds.mean += value / static_cast<double>(all.size());
    bounds.declared = share(all, signal.lower, signal.upper);
    return bounds;
  }

  const RobustProblem& problem_;
  MatrixXd A_, B_, G_;
  VectorXd weight_;
  std::optional<PivotedQr> solver_;
  // Samples of each channel.
  std::vector<std::vector<double>> samples_;
  double total_ = 0.0;
  double unexplained_ = 0.0;
};

void requireShare(double value, const char* name) {
  if (!(value > 0.0 && value < 1.0))
    throw Error(std::string("disturbance bounds: ") + name + ": must lie between 0 and 1");
}

}  // namespace

DisturbanceBounds boundDisturbances(const RobustProblem& problem,
                                    const std::vector<std::vector<std::vector<double>>>& flights,
                                    const BoundsOptions& options) {
  requireShare(options.coverage, "coverage");
  requireShare(options.confidence, "confidence");
  if (options.every < 1) throw Error("disturbance bounds: every: must be at least 1");
  Estimation estimation(problem);
  const std::size_t width = problem.states.size() + problem.inputs.size();
  for (const auto& flight : flights) {
    for (const std::vector<double>& row : flight) {
      if (row.size() != width) throw Error("disturbance bounds: a row must have all states and inputs");
    }
    estimation.add(flight);
  }
  return estimation.result(options);
}

std::string boundsText(const DisturbanceBounds& bounds, const BoundsOptions& options) {
  std::ostringstream text;
  text.precision(4);
  for (const ChannelBounds& channel : bounds.channels) {
    text << channel.name << ": range: [" << channel.lower << ", " << channel.upper << "]  # " << channel.unit
         << ", holds " << options.coverage << " with confidence " << channel.confidence << "\n"
         << "  covers " << channel.covered << " of " << channel.samples << " samples; mean " << channel.mean
         << ", least " << channel.least << ", greatest " << channel.greatest << "\n"
         << "  the problem's range covers " << channel.declared << "\n";
    if (channel.confidence < options.confidence)
      text << "  too few samples for a confidence of " << options.confidence
           << ": all of them are in the range\n";
  }
  text << "not explained by any disturbance: " << bounds.unexplained << " of the prediction error\n";
  return text.str();
}

std::string boundsJson(const DisturbanceBounds& bounds, const BoundsOptions& options) {
  nlohmann::ordered_json json;
  json["coverage"] = options.coverage;
  json["confidence"] = options.confidence;
  json["every"] = options.every;
  json["unexplained"] = bounds.unexplained;
  json["channels"] = nlohmann::ordered_json::array();
  for (const ChannelBounds& channel : bounds.channels) {
    json["channels"].push_back({{"name", channel.name},
                                {"unit", channel.unit},
                                {"samples", channel.samples},
                                {"range", {channel.lower, channel.upper}},
                                {"covered", channel.covered},
                                {"confidence", channel.confidence},
                                {"least", channel.least},
                                {"greatest", channel.greatest},
                                {"mean", channel.mean},
                                {"declared_covers", channel.declared}});
  }
  return json.dump(2) + "\n";
}

}  // namespace polyfly
