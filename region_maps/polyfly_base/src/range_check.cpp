#include "polyfly_base/range_check.hpp"

#include <sstream>

#include "polyfly_base/error.hpp"

namespace polyfly {

void RangeCheck::operator()(const char* key, double value, const char* unit, const Range& range) const {
  // Written so that NaN fails.
  if (value >= range.least && value <= range.greatest) return;
  std::ostringstream text;
  if (!where.empty()) text << where << ": ";
  text << key << ": must lie in [" << range.least << ", " << range.greatest << "] " << unit << ", got "
       << value;
  throw Error(text.str());
}

}  // namespace polyfly
