#include "online_controller_ros/law_setup.hpp"

#include <algorithm>

#include "online_controller/laws/axis.hpp"
#include "online_controller/laws/linear_tuning.hpp"

namespace polyfly_ros {
namespace {

// Sampling time of linear problems that are made from the model [s].
constexpr double kSamplingTime = 0.1;
constexpr int kHorizon = 20;

/// Throws Error naming the parameter that is missing: below `group` stand three paths, or none where that is not `required`.
void requireAxes(ParameterReader& reader, const std::string& group, const char* what,
                 const polyfly::AxisPaths& paths, bool required) {
  const bool any =
      std::any_of(paths.begin(), paths.end(), [](const std::string& path) { return !path.empty(); });
  for (std::size_t i = 0; i < paths.size(); ++i) {
    if ((required || any) && paths[i].empty())
      reader.requiredText(group + "/" + polyfly::kAxisNames.at(i).axis, what);
  }
}

void requireFiles(ParameterReader& reader, const LawSetup& setup) {
  const std::vector<polyfly::LawType>& types = polyfly::lawTypes();
  for (std::size_t i = 0; i < types.size(); ++i) {
    if (types[i].maps == nullptr) continue;
    const char* what =
        types[i].robust_maps ? "the path of a map of a minimum-peak robust MPC" : "the path of a region map";
    requireAxes(reader, types[i].maps, what, setup.parameters.maps[i],
                static_cast<std::size_t>(setup.law()) == i);
  }
  requireAxes(reader, "problems", "the path of a problem file", setup.parameters.problems, false);
}

std::array<std::vector<polyfly::Signal>, 3> parametersOf(const std::vector<polyfly::RegionMap>& maps) {
  std::array<std::vector<polyfly::Signal>, 3> parameters;
  for (std::size_t i = 0; i < maps.size(); ++i) parameters.at(i) = maps[i].parameters();
  return parameters;
}

std::array<std::vector<polyfly::Signal>, 3> parametersOf(const std::array<polyfly::MpcProblem, 3>& problems) {
  std::array<std::vector<polyfly::Signal>, 3> parameters;
  for (std::size_t i = 0; i < problems.size(); ++i) {
    for (const auto& parameter : problems[i].parameters) parameters[i].push_back(parameter.signal);
  }
  return parameters;
}

}  // namespace

const polyfly::MapSet& LawSources::explicitMaps() const {
  return mapsOf(polyfly::lawOfName("explicit_linear"));
}

std::shared_ptr<const LawSources> LawSources::load(const polyfly::MultirotorParameters& parameters) {
  auto sources = std::make_shared<LawSources>();
  sources->maps = polyfly::openMaps(polyfly::lawTypes(), parameters.maps, parameters.controller);
  sources->problems = polyfly::linearProblems(parameters.nonlinear.model, kSamplingTime, kHorizon);
  const polyfly::MapSet& mapped = sources->explicitMaps();
  for (std::size_t i = 0; i < sources->problems.size(); ++i) {
    if (!parameters.problems[i].empty()) {
      sources->problems[i] = polyfly::loadProblem(parameters.problems[i]);
    } else if (!mapped.empty() && !mapped.problems[i].minimum_peak) {
      sources->problems[i] = mapped.problems[i];
    }
  }
  return sources;
}

LawSetup LawSetup::read(ParameterReader& reader) {
  LawSetup setup;
  polyfly::MultirotorParameters& parameters = setup.parameters;
  polyfly::visitMultirotorParameters(parameters, reader);
  requireFiles(reader, setup);
  polyfly::checkTogether(parameters);
  parameters.nonlinear.model.gravity = parameters.controller.gravity;
  setup.sources = LawSources::load(parameters);
  parameters.linear = polyfly::linearTuning(setup.sources->problems);
  polyfly::visitLinearTuning(parameters.linear, reader);
  return setup;
}

Laws::Laws(const LawSetup& setup)
    : sources_(setup.sources),
      options_(setup.parameters.controller),
      observer_(setup.parameters.nonlinear.model, options_, setup.parameters.moments) {
  const std::array<polyfly::MpcProblem, 3> problems =
      polyfly::tuned(sources_->problems, setup.parameters.linear);
  const polyfly::MapSet& mapped = sources_->explicitMaps();
  const auto of_linear = mapped.empty() ? parametersOf(problems) : parametersOf(mapped.maps);
  for (const polyfly::MapSet& set : sources_->maps)
    parameters_.push_back(set.empty() ? of_linear : parametersOf(set.maps));
  switch_ = polyfly::makeLaws(polyfly::lawTypes(),
                              {options_, setup.parameters.nonlinear, problems, &sources_->maps}, setup.law());
}

}  // namespace polyfly_ros
