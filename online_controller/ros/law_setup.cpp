#include "online_controller_ros/law_setup.hpp"

#include <algorithm>
#include <utility>

#include "online_controller/laws/multirotor_controller.hpp"
#include "online_controller/laws/nonlinear_controller.hpp"
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

std::unique_ptr<polyfly::ControlLaw> explicitLaw(const MapSet& set,
                                                 const polyfly::MultirotorOptions& options) {
  if (set.empty()) return nullptr;
  return std::make_unique<polyfly::MultirotorController>(
      std::array<const polyfly::RegionMap*, 3>{&set.maps[0], &set.maps[1], &set.maps[2]}, set.problems,
      options);
}

/// `problems`: of the linear law, tuned.
std::unique_ptr<polyfly::LawSwitch> everyLaw(const LawSetup& setup,
                                             const std::array<polyfly::MpcProblem, 3>& problems) {
  std::array<std::unique_ptr<polyfly::ControlLaw>, polyfly::kLawCount> laws;
  const auto place = [&](polyfly::Law law) -> auto& { return laws[static_cast<std::size_t>(law)]; };
  place(polyfly::Law::kExplicitLinear) = explicitLaw(setup.sources->explicit_maps, setup.controller);
  place(polyfly::Law::kLinear) = std::make_unique<polyfly::MultirotorController>(problems, setup.controller);
  place(polyfly::Law::kRobustExplicit) = explicitLaw(setup.sources->robust_maps, setup.controller);
  place(polyfly::Law::kNonlinear) =
      std::make_unique<polyfly::NonlinearController>(setup.controller, setup.nonlinear);
  return std::make_unique<polyfly::LawSwitch>(std::move(laws), setup.law);
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
  setup.files.maps =
      readPaths(reader, "maps", "the path of a region map", setup.law == polyfly::Law::kExplicitLinear);
  setup.files.robust_maps = readPaths(reader, "robust_maps", "the path of a map of a minimum-peak robust MPC",
                                      setup.law == polyfly::Law::kRobustExplicit);
  setup.files.problems = readPaths(reader, "problems", "the path of a problem file", false);
  polyfly::visitOptions(setup.controller, reader);
  polyfly::visitNonlinearOptions(setup.nonlinear, reader);
  polyfly::visitMomentModel(setup.moments, reader);
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
  parameters_ =
      sources_->explicit_maps.empty() ? parametersOf(problems) : parametersOf(sources_->explicit_maps.maps);
  robust_parameters_ = parametersOf(sources_->robust_maps.maps);
  switch_ = everyLaw(setup, problems);
}

const std::vector<polyfly::RegionMap>& Laws::maps(polyfly::Law law) const {
  switch (law) {
    case polyfly::Law::kExplicitLinear:
      return sources_->explicit_maps.maps;
    case polyfly::Law::kRobustExplicit:
      return sources_->robust_maps.maps;
    case polyfly::Law::kLinear:
    case polyfly::Law::kNonlinear:
      break;
  }
  static const std::vector<polyfly::RegionMap> none;
  return none;
}

}  // namespace polyfly_ros
