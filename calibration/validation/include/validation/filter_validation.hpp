#pragma once

#include <string>

#include "report/report.hpp"
#include "validation/filter_replay.hpp"

namespace polyfly {

/// Judges the replay of a log. The result is the content of `summary.json`, keys explained in README.md. `findings` are
/// sentences on what is to be looked at. Without any the `verdict` is `passed`.
Json judgeFilter(const FilterLog& log, const FilterReplay& replay, const CommandFilter& filter);

/// What page and console show of a judgement, without pictures.
Report reportOnFilter(const Json& judgement);

/// Writes `index.html` and `summary.json` into the folder, which is made where it is missing. Throws Error naming the file.
void writeFilterReport(const Json& judgement, const FilterReplay& replay, const CommandFilter& filter,
                       const std::string& folder);

}  // namespace polyfly
