#include "sample_check.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "verify/program_oracle.hpp"

namespace polyfly::bench {
namespace {

// Samples nearer to the edge of the feasible set are not decided.
constexpr double kMargin = 1e-6;
// Samples with a greater KKT residual are no reference.
constexpr double kSampleAccuracy = 1e-8;
// Distance outside a region at which it still holds a parameter, as in maps.
constexpr double kInside = 1e-8;  // [scaled]
// Slack of the rows in the best objective of an output, as in `verify`.
constexpr double kSlack = 1e-7;

Eigen::VectorXd vectorOf(const nlohmann::json& list) {
  const auto values = list.get<std::vector<double>>();
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

double numberOr(const nlohmann::json& sample, const char* key, double otherwise) {
  return sample.contains(key) && sample[key].is_number() ? sample[key].get<double>() : otherwise;
}

bool holds(const CriticalRegion& region, const Eigen::VectorXd& theta) {
  for (Eigen::Index i = 0; i < region.G.rows(); ++i) {
    if (region.G.row(i).dot(theta) - region.g(i) > kInside) return false;
  }
  return true;
}

double greatestOutput(const nlohmann::json& samples) {
  double greatest = 0.0;
  for (const auto& sample : samples) {
    if (sample.contains("u") && sample["u"].is_array()) {
      greatest = std::max(greatest, vectorOf(sample["u"]).lpNorm<Eigen::Infinity>());
    }
  }
  return greatest > 0.0 ? greatest : 1.0;
}

}  // namespace

SampleCheck checkSamples(const ParametricProgram& program, const Partition& partition,
                         const nlohmann::json& samples) {
  SampleCheck check;
  ProgramOracle oracle(program);
  check.of_objective = !oracle.strictlyConvex();
  const double output_scale = greatestOutput(samples);
  for (const auto& sample : samples) {
    const bool feasible = sample["feasible"].get<bool>();
    if (std::abs(numberOr(sample, "margin", 1.0)) < kMargin) continue;
    if (feasible && numberOr(sample, "kkt", 0.0) > kSampleAccuracy) continue;
    const Eigen::VectorXd theta = vectorOf(sample["theta"]);
    bool inside = false;
    for (const CriticalRegion& region : partition.regions) {
      if (!holds(region, theta)) continue;
      const bool first = !inside;
      inside = true;
      if (!feasible) break;
      const Eigen::VectorXd u = region.K * theta + region.k;
      double error = 0.0;
      if (!check.of_objective) {
        error = (u - vectorOf(sample["u"])).lpNorm<Eigen::Infinity>() / output_scale;
      } else if (first) {
        const double best = sample["obj"].get<double>();
        error = (oracle.objectiveWithOutput(theta, u, kSlack) - best) / std::max(1.0, std::abs(best));
      }
      check.u_error = std::isfinite(error) ? std::max(check.u_error, error) : 1e300;
    }
    (feasible ? check.feasible : check.infeasible) += 1;
    check.missed += feasible && !inside;
    check.false_inside += !feasible && inside;
  }
  return check;
}

}  // namespace polyfly::bench
