#include "online_controller/parameters/multirotor_parameters.hpp"

#include "online_controller/types/option_groups.hpp"
#include "online_controller/types/thrust_curve.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/options_from_yaml.hpp"

namespace polyfly {
namespace {

void checkTogether(const MultirotorParameters& parameters) {
  lawOfName(parameters.law);
  checkOptions(parameters.controller);
  checkOutputOptions(parameters.output);
  const MultirotorOptions& vehicle = parameters.controller;
  if (parameters.output.attitude_target)
    ThrustCurve(parameters.output.thrust, vehicle.mass * vehicle.thrust_min,
                vehicle.mass * vehicle.thrust_max, vehicle.mass * vehicle.gravity);
}

}  // namespace

MultirotorParameters parseMultirotorParameters(const std::string& text, const std::string& source) {
  OptionsFromYaml reader(text, source);
  MultirotorParameters parameters;
  visitMultirotorParameters(parameters, reader);
  reader.refuseUnknownGroups(knownGroups(), {kSingleOptions.begin(), kSingleOptions.end()});
  reader.refuseUnknownKeys(ownGroups());
  try {
    checkTogether(parameters);
  } catch (const Error& error) {
    throw Error(source + ": " + error.what());
  }
  return parameters;
}

}  // namespace polyfly
