#include "explore/state/region_store.hpp"

#include <algorithm>
#include <cmath>

namespace polyfly {

RegionStore::RegionStore(int p, int q, CountedMemory& memory)
    : p_(p), q_(q), arena_(memory), regions_(&memory) {}

double* RegionStore::add(std::uint32_t set, std::uint32_t facets) {
  double* const numbers = arena_.allocate(numberCount(facets));
  regions_.push_back({numbers, set, facets});
  return numbers;
}

CriticalRegion RegionStore::region(std::size_t index, const NormalisedProgram& program,
                                   RowSpan active) const {
  const Region& stored = regions_[index];
  const double* const centre = stored.numbers + 1;
  const double* const law = centre + p_;
  const double* const rows = law + q_ * (p_ + 1);
  CriticalRegion region;
  for (const std::uint16_t row : active) region.active.push_back(program.row_ids[row]);
  std::sort(region.active.begin(), region.active.end());
  region.G.resize(static_cast<Eigen::Index>(stored.facets), p_);
  region.g.resize(region.G.rows());
  for (Eigen::Index f = 0; f < region.G.rows(); ++f) {
    const double* const row = rows + f * (p_ + 1);
    double bound = row[p_];
    for (int j = 0; j < p_; ++j) {
      region.G(f, j) = row[j] / program.half(j);
      bound += region.G(f, j) * program.centre(j);
    }
    region.g(f) = bound;
  }
  region.K.resize(q_, p_);
  region.k.resize(q_);
  for (int i = 0; i < q_; ++i) {
    const int unit = program.outputs[static_cast<std::size_t>(i)];
    double constant = std::ldexp(law[i * (p_ + 1) + p_], unit);
    for (int j = 0; j < p_; ++j) {
      region.K(i, j) = std::ldexp(law[i * (p_ + 1) + j], unit) / program.half(j);
      constant -= region.K(i, j) * program.centre(j);
    }
    region.k(i) = constant;
  }
  region.centre.resize(p_);
  for (int j = 0; j < p_; ++j) region.centre(j) = program.centre(j) + program.half(j) * centre[j];
  region.radius = stored.numbers[0];
  return region;
}

}  // namespace polyfly
