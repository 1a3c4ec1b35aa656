#pragma once

#include <gtest/gtest.h>

#include "offline_mpt/partition.hpp"

namespace polyfly {

/// Every number of two partitions is the same, bit for bit.
inline void expectSameRegions(const Partition& a, const Partition& b) {
  ASSERT_EQ(a.regions.size(), b.regions.size());
  for (std::size_t k = 0; k < a.regions.size(); ++k) {
    const CriticalRegion& left = a.regions[k];
    const CriticalRegion& right = b.regions[k];
    const bool same = left.active == right.active && left.G == right.G && left.g == right.g &&
                      left.K == right.K && left.k == right.k && left.centre == right.centre &&
                      left.radius == right.radius;
    ASSERT_TRUE(same) << "region " << k;
  }
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.stats.candidate_sets, b.stats.candidate_sets);
  EXPECT_EQ(a.stats.degenerate_facets, b.stats.degenerate_facets);
  EXPECT_EQ(a.stats.lp_pivots, b.stats.lp_pivots);
  EXPECT_EQ(a.stats.open_sets, b.stats.open_sets);
}

}  // namespace polyfly
