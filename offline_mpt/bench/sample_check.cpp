#include "sample_check.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "verify/exact_sample.hpp"

namespace polyfly::bench {
namespace {

// Samples nearer to the edge of the feasible set are not decided.
constexpr double kMargin = 1e-6;
// Samples with a greater KKT residual are no reference.
constexpr double kSampleAccuracy = 1e-8;
// Distance outside a region at which it still holds a parameter, as in maps.
constexpr double kInside = 1e-8;  // [scaled]

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
  const bool is_linear = program.H.isZero(0.0);
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
      if (is_linear && !first) continue;
      const Eigen::VectorXd u = region.K * theta + region.k, ranges = Eigen::VectorXd::Ones(u.size());
      const Eigen::VectorXd right =
          is_linear ? ExactSample(program, theta).nearestOptimum(u, ranges) : vectorOf(sample["u"]);
      check.u_error = std::max(check.u_error, (u - right).lpNorm<Eigen::Infinity>() / output_scale);
    }
    (feasible ? check.feasible : check.infeasible) += 1;
    check.missed += feasible && !inside;
    check.false_inside += !feasible && inside;
  }
  return check;
}

}  // namespace polyfly::bench
