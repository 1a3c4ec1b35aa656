#include "extensions/extended_lookups.hpp"

namespace checker {

bool ExtendedLookups::readFurther(Line& line) {
  const bool is_beyond = line.next("beyond");
  if (is_beyond) readBeyond(line);
  const bool is_sliver = !is_beyond && line.next("sliver");
  if (is_sliver) readSliver(line);
  return is_beyond || is_sliver;
}

void ExtendedLookups::readBeyond(Line& line) {
  const std::size_t region = line.count(map_.regions.size() - 1);
  const std::vector<Row> rows = extension_.moved(region);
  requireEmpty(line, cellWith(rows), nullptr);
  beyond_.insert(region);
}

/// Of the regions that cover a sliver, moved outwards, only candidates reach into the leaf.
void ExtendedLookups::readSliver(Line& line) {
  const std::size_t sliver = line.count(regions_.size() - 1);
  require(sliver >= map_.regions.size(), "a region of the map is no sliver");
  for (const std::size_t region : regions_[sliver].covered_by)
    require(contains(candidates_, region) || beyond_.count(region) > 0,
            "a sliver reaches into a region that is no candidate");
  known_.insert(sliver);
  near_.push_back(sliver);
}

}  // namespace checker
