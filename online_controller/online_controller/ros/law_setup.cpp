#include "online_controller_ros/law_setup.hpp"

#include <algorithm>
#include <utility>

#include "online_controller_ros/law_sources.hpp"

namespace polyfly_ros {
namespace {

constexpr std::array<const char*, 3> kAxes{"longitudinal", "lateral", "vertical"};

/// All three paths below `space`, or none. `required`: none will not do.
std::array<std::string, 3> readPaths(ParameterReader& reader, const std::string& space,
                                     const std::string& what, bool required) {
  std::array<std::string, 3> paths;
  for (std::size_t i = 0; i < 3; ++i) paths[i] = reader.text(space + "/" + kAxes[i], what, "");
  const bool any =
      std::any_of(paths.begin(), paths.end(), [](const std::string& path) { return !path.empty(); });
  for (std::size_t i = 0; i < 3; ++i) {
    if ((required || any) && paths[i].empty()) reader.requiredText(space + "/" + kAxes[i], what);
  }
  return paths;
}

/// Of the laws that have maps; the one that flies first needs them.
polyfly::MapPaths readMapPaths(ParameterReader& reader, polyfly::Law first) {
  const std::vector<polyfly::LawType>& types = polyfly::lawTypes();
  polyfly::MapPaths paths(types.size());
  for (std::size_t i = 0; i < types.size(); ++i) {
    if (types[i].maps == nullptr) continue;
    const char* what =
        types[i].robust_maps ? "the path of a map of a minimum-peak robust MPC" : "the path of a region map";
    paths[i] = readPaths(reader, types[i].maps, what, static_cast<std::size_t>(first) == i);
  }
  return paths;
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

LawSetup LawSetup::read(ParameterReader& reader) {
  LawSetup setup;
  setup.law = polyfly::lawOfName(reader.text("law", "the name of a law", "explicit_linear"));
  setup.files.maps = readMapPaths(reader, setup.law);
  setup.files.problems = readPaths(reader, "problems", "the path of a problem file", false);
  polyfly::visitOptions(setup.controller, reader);
  polyfly::visitNonlinearOptions(setup.nonlinear, reader);
  polyfly::visitMomentModel(setup.moments, reader);
  polyfly::visitLawOptions(polyfly::lawTypes(), setup.law_options, reader);
  polyfly::checkOptions(setup.controller);
  setup.nonlinear.model.gravity = setup.controller.gravity;
  setup.sources = LawSources::load(setup.files, setup.nonlinear.model, setup.controller);
  setup.linear = polyfly::linearTuning(setup.sources->problems);
  polyfly::visitLinearTuning(setup.linear, reader);
  return setup;
}

Laws::Laws(const LawSetup& setup)
    : sources_(setup.sources),
      options_(setup.controller),
      observer_(setup.nonlinear.model, setup.controller, setup.moments) {
  const std::array<polyfly::MpcProblem, 3> problems = polyfly::tuned(sources_->problems, setup.linear);
  const polyfly::MapSet& mapped = sources_->explicitMaps();
  const auto of_linear = mapped.empty() ? parametersOf(problems) : parametersOf(mapped.maps);
  for (const polyfly::MapSet& set : sources_->maps)
    parameters_.push_back(set.empty() ? of_linear : parametersOf(set.maps));
  switch_ = polyfly::makeLaws(
      polyfly::lawTypes(), {setup.controller, setup.nonlinear, problems, &sources_->maps, setup.law_options},
      setup.law);
}

const std::vector<polyfly::RegionMap>& Laws::maps(polyfly::Law law) const {
  return sources_->mapsOf(law).maps;
}

}  // namespace polyfly_ros
