#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "online_controller/laws/law_switch.hpp"
#include "online_controller/laws/multirotor_controller.hpp"
#include "region_maps/map_content.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly_test {

/// Text of the project's problem file of an axis: 0 longitudinal, 1 lateral, 2 vertical.
std::string axisProblem(std::size_t axis);

/// Text of the project's robust problem file of an axis, by name.
std::string robustAxisProblem(const std::string& axis);

/// Content of a map of one region that covers the box, with the law of unit slope in the reference,
/// u = u_ref + gains . errors. `gains` are those of the errors, in the problem's order.
polyfly::MapContent oneRegionContent(const std::string& problem_text, const std::vector<double>& gains);

/// As above, with the project's problem and gains that stabilise it.
polyfly::MapContent axisContent(std::size_t axis);

/// Makes the map infeasible above `limit` of parameter `index`.
void cutOff(polyfly::MapContent& content, std::size_t index, double limit);

/// A map in memory.
class MapInMemory {
 public:
  explicit MapInMemory(const polyfly::MapContent& content, const std::string& name = "made.map");
  const polyfly::RegionMap& map() const { return *map_; }

 private:
  std::unique_ptr<std::byte[], void (*)(std::byte*)> bytes_;
  std::unique_ptr<polyfly::RegionMap> map_;
};

/// One law with what is sent without its answer, told one reference in each step.
class OneLaw : public polyfly::LawSwitch {
 public:
  using LawSwitch::LawSwitch;
  using LawSwitch::step;
  const polyfly::ControlReport& step(const polyfly::VehicleState& state,
                                     const polyfly::Reference& reference) noexcept {
    return step(state, &reference);
  }
};

/// The three maps and a controller on them.
struct Flight {
  explicit Flight(const polyfly::MultirotorOptions& options = {});
  explicit Flight(const std::array<polyfly::MapContent, 3>& contents,
                  const polyfly::MultirotorOptions& options = {});

  std::array<std::unique_ptr<MapInMemory>, 3> maps;
  std::unique_ptr<OneLaw> controller;
};

std::array<polyfly::MapContent, 3> axisContents();

/// The message of the polyfly::Error that building the axis throws, empty if it throws none.
std::string axisRefusal(std::size_t axis, const polyfly::MapContent& content);

}  // namespace polyfly_test
