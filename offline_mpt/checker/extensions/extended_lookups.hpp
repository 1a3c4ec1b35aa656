#pragma once

#include <set>
#include <vector>

#include "core/lookups.hpp"

namespace checker {

/// Look-ups where slivers are left to their neighbours, or coverage is that of regions moved outwards.
class ExtendedLookups : public Lookups {
 public:
  struct Extension {
    /// All half-spaces of a region.
    RowsOfRegion conditions;
    /// The map's half-spaces of a region, moved outwards as covers of slivers have them.
    RowsOfRegion moved;
    bool is_widened = false;
  };

  using Lookups::Lookups;
  void extend(const Extension& extension) { extension_ = extension; }

 private:
  bool readFurther(Line& line) override;
  std::vector<Row> conditions(std::size_t candidate) const override {
    return extension_.conditions(candidate);
  }
  bool dropsShowOutside() const override { return !extension_.is_widened; }
  void beginWalk() override { beyond_.clear(); }
  void readBeyond(Line& line);
  void readSliver(Line& line);

  Extension extension_;
  /// Regions that do not reach into the leaf even if they are moved outwards.
  std::set<std::size_t> beyond_;
};

}  // namespace checker
