#pragma once

#include <string>

#include "online_controller/types/options.hpp"

namespace polyfly {

/// Reads the controller's options from the YAML file that the flight's node was given
/// (launch/config/firefly.yaml): the maps `vehicle` and `controller`. Keys of the node that do not bear on a
/// replay are passed over. Throws Error naming file, line, key and rule.
MultirotorOptions loadControllerOptions(const std::string& path);

/// As loadControllerOptions, from text; `source` is used in errors. Options that are removed by now are refused, unless the
/// text was `told` by a node that had them.
MultirotorOptions parseControllerOptions(const std::string& text, const std::string& source,
                                         bool told = false);

/// Default of `nonlinear/period` [s].
constexpr double kPreviewPeriod = 0.1;

/// `nonlinear/period` of the same text [s]. It is the time between the references ahead that all laws of the node
/// read, and the sampling time of maps that can look ahead.
double parsePreviewPeriod(const std::string& text, const std::string& source);

}  // namespace polyfly
