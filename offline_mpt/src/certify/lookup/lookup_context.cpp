#include "certify/lookup/lookup_context.hpp"

namespace polyfly {

const DroppedRow* LookupContext::findDropped(std::size_t visit, std::uint32_t region,
                                             std::uint32_t row) const {
  for (;; visit = tree.parent(visit)) {
    for (const DroppedRow& dropped : drops[region].at(visit)) {
      if (dropped.row == row) return &dropped;
    }
    if (visit == 0) return nullptr;
  }
}

}  // namespace polyfly
