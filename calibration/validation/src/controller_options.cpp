#include "validation/controller_options.hpp"

#include "online_controller/parameters/multirotor_parameters.hpp"
#include "online_controller/types/node_options.hpp"
#include "online_controller/types/option_groups.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/options_from_yaml.hpp"
#include "polyfly_base/read_text.hpp"

namespace polyfly {

MultirotorOptions parseControllerOptions(const std::string& text, const std::string& source, bool told) {
  OptionsFromYaml reader(text, source);
  MultirotorOptions options;
  visitOptions(options, reader);
  // Of the node around the controller: they decide when it is called, which the bag tells.
  NodeOptions node;
  visitNodeOptions(node, reader);
  if (told) {
    reader.passOverRemoved(removedOptions());
  } else {
    reader.refuseRemoved(removedOptions());
  }
  reader.refuseUnknownGroups(knownGroups(), {kSingleOptions.begin(), kSingleOptions.end()});
  reader.refuseUnknownKeys({"vehicle", "controller"});
  try {
    checkOptions(options);
  } catch (const Error& error) {
    throw Error(source + ": " + error.what());
  }
  return options;
}

double parsePreviewPeriod(const std::string& text, const std::string& source) {
  OptionsFromYaml reader(text, source);
  double period = kPreviewPeriod;
  reader("nonlinear/period", period, "s", Range{0.001, 1.0});
  return period;
}

MultirotorOptions loadControllerOptions(const std::string& path) {
  return parseControllerOptions(readText(path), path);
}

}  // namespace polyfly
