#include "verify/check_samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "lp/polytope.hpp"
#include "region_maps/region_map.hpp"
#include "verify/parameter_sampler.hpp"
#include "verify/tolerances.hpp"

namespace polyfly {
namespace {

constexpr std::uint64_t kLeastSamples = 200;
constexpr std::uint64_t kRegionsPerSample = 50;
constexpr std::uint64_t kCheckSeed = 1;

/// Parameters in the box [-1, 1]^p of the map's own regions.
class RegionSampler {
 public:
  explicit RegionSampler(const RegionMap& map)
      : map_(map), p_(map.parameters().size()), solver_(static_cast<int>(p_)) {
    for (const Signal& signal : map.parameters()) {
      middle_.push_back(0.5 * (signal.lower + signal.upper));
      half_.push_back(0.5 * (signal.upper - signal.lower));
    }
  }

  /// The centre of a region; false where it has none.
  bool centre(std::size_t region, Eigen::VectorXd& theta) {
    gatherRows(region);
    t_.assign(p_, 0.0);
    double radius = 0.0;
    const int count = static_cast<int>(rows_.size() / (p_ + 1));
    if (!solver_.chebyshevInBox(rows_.data(), count, t_.data(), radius) || !(radius > 0.0)) return false;
    theta = parameter();
    return true;
  }

  /// Just behind the facet that `along` points to from that centre; false where this is outside of the box.
  bool behindFacet(const Eigen::VectorXd& along, Eigen::VectorXd& theta) {
    double nearest = 2.0 * static_cast<double>(p_);
    for (std::size_t first = 0; first < rows_.size(); first += p_ + 1) {
      double speed = 0.0, slack = rows_[first + p_];
      for (std::size_t j = 0; j < p_; ++j) {
        speed += rows_[first + j] * along[static_cast<Eigen::Index>(j)];
        slack -= rows_[first + j] * t_[j];
      }
      if (speed > 0.0) nearest = std::min(nearest, (slack + tolerance::kCheckedBehind) / speed);
    }
    for (std::size_t j = 0; j < p_; ++j) {
      t_[j] += nearest * along[static_cast<Eigen::Index>(j)];
      if (!(std::abs(t_[j]) <= 1.0)) return false;
    }
    theta = parameter();
    return true;
  }

 private:
  void gatherRows(std::size_t index) {
    rows_.clear();
    for (std::size_t j = 0; j < 2 * p_; ++j) {
      for (std::size_t k = 0; k < p_; ++k) rows_.push_back(k != j / 2 ? 0.0 : j % 2 == 0 ? 1.0 : -1.0);
      rows_.push_back(1.0);
    }
    const RegionView region = map_.region(index);
    for (std::uint32_t i = 0; i < region.row_count; ++i) {
      const double sign = region.rows[i] > 0 ? 1.0 : -1.0;
      const double* plane = map_.plane(static_cast<std::size_t>(std::abs(region.rows[i])) - 1);
      double bound = plane[p_], squared = 0.0;
      for (std::size_t j = 0; j < p_; ++j) {
        bound -= plane[j] * middle_[j];
        squared += plane[j] * half_[j] * plane[j] * half_[j];
      }
      const double factor = sign / std::sqrt(squared);
      for (std::size_t j = 0; j < p_; ++j) rows_.push_back(factor * plane[j] * half_[j]);
      rows_.push_back(factor * bound);
    }
  }

  Eigen::VectorXd parameter() const {
    Eigen::VectorXd theta(static_cast<Eigen::Index>(p_));
    for (std::size_t j = 0; j < p_; ++j) {
      const Signal& signal = map_.parameters()[j];
      theta[static_cast<Eigen::Index>(j)] =
          std::clamp(middle_[j] + half_[j] * t_[j], signal.lower, signal.upper);
    }
    return theta;
  }

  const RegionMap& map_;
  std::size_t p_;
  PolytopeSolver solver_;
  std::vector<double> middle_, half_, rows_, t_;
};

}  // namespace

std::vector<Eigen::VectorXd> checkSamples(const RegionMap& map) {
  const std::uint64_t regions = map.firstFallback();
  const std::uint64_t count = kLeastSamples + regions / kRegionsPerSample;
  ParameterSampler uniform(map, kCheckSeed, 0);
  RegionSampler sampler(map);
  std::vector<Eigen::VectorXd> samples;
  Eigen::VectorXd theta;
  for (std::uint64_t i = 0; samples.size() < count; ++i) {
    samples.push_back(uniform.uniform().theta);
    // Regions at equal distances in the list, all where they are few.
    const std::uint64_t region = regions <= count / 3 ? i % regions : (i * 3 * regions / count) % regions;
    if (!sampler.centre(region, theta)) continue;
    samples.push_back(theta);
    if (sampler.behindFacet(uniform.direction(), theta)) samples.push_back(theta);
  }
  return samples;
}

}  // namespace polyfly
