#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace polyfly {

/// What each addition to the published configuration brings: flights over the chapter's figures with one addition more in
/// each row.
struct AdditionTable {
  /// Rows, each with `options` and the largest distances [m].
  nlohmann::json rows;
  std::string html;
};

/// Flies all of it, in simulated time.
AdditionTable flyAdditions();

}  // namespace polyfly
