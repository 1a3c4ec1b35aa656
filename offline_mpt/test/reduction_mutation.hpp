#pragma once

#include <string>
#include <utility>
#include <vector>

#include "region_maps/map_content.hpp"

namespace polyfly {

/// Empty where the certificate of a reduction is confirmed, else why not. Maps as bytes.
std::string reductionRefusal(const std::string& certificate, const std::string& reduced,
                             const std::string& original);

/// Maps that answer differently from `good`, a reduced map with two parameters and one input, and what is
/// wrong with each.
std::vector<std::pair<std::string, MapContent>> wrongMaps(const MapContent& good);

}  // namespace polyfly
