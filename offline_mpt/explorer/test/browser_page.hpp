#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace polyfly {

/// Path of the browser: the environment's POLYFLY_CHROMIUM, else `chromium` in PATH. Empty: none.
std::string chromiumProgram();

/// Opens a page in headless Chromium and returns what its `#report` computes (region_maps/region_maps/explorer/page/report.js).
/// `view` is the rest of the fragment. Throws Error when the browser fails or the page writes no report.
nlohmann::json reportOf(const std::string& page, const std::string& view = "");

}  // namespace polyfly
