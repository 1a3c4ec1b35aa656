#include "online_support.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <new>
#include <stdexcept>

#include "mpc_core/mpc_problem.hpp"
#include "polyfly_base/error.hpp"
#include "region_maps/write_map.hpp"

namespace polyfly_test {
namespace {

constexpr std::align_val_t kMapAlignment{64};
constexpr std::array<const char*, 3> kProblemFiles{"multirotor_longitudinal.yaml", "multirotor_lateral.yaml",
                                                   "multirotor_vertical.yaml"};

std::unique_ptr<std::byte[], void (*)(std::byte*)> aligned(std::size_t size) {
  auto* memory = static_cast<std::byte*>(::operator new(size, kMapAlignment));
  return {memory, [](std::byte* bytes) { ::operator delete(bytes, kMapAlignment); }};
}

}  // namespace

namespace {

std::string problemText(const std::string& file) {
  const char* root = std::getenv("POLYFLY_ROOT");
  const std::string path = std::string(root != nullptr ? root : ".") + "/region_maps/problems/" + file;
  std::ifstream stream(path);
  if (!stream) throw std::runtime_error("cannot read " + path);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

}  // namespace

std::string axisProblem(std::size_t axis) { return problemText(kProblemFiles.at(axis)); }

std::string robustAxisProblem(const std::string& axis) {
  return problemText("robust/aslquad_" + axis + ".yaml");
}

polyfly::MapContent oneRegionContent(const std::string& problem_text, const std::vector<double>& gains) {
  const polyfly::ParametricProgram program = polyfly::parseProgram(problem_text, "yaml", "made problem");
  polyfly::MapContent content;
  content.name = "made";
  content.problem_text = problem_text;
  content.problem_kind = "yaml";
  content.solver_status = "complete";
  content.period = program.period;
  content.tolerance = 1e-9;
  content.parameters = program.parameters;
  content.inputs = program.inputs;
  content.laws = gains;
  content.laws.push_back(0.0);  // previous input
  content.laws.push_back(1.0);  // input reference
  content.laws.push_back(0.0);  // constant
  content.regions.resize(1);
  content.root = polyfly::MapContent::kLeaf;
  content.leaves.push_back({0, 1});
  content.candidates.push_back(0);
  return content;
}

polyfly::MapContent axisContent(std::size_t axis) {
  switch (axis) {
    case 0:
      return oneRegionContent(axisProblem(0), {-0.3, -0.35, -1.0});
    case 1:
      return oneRegionContent(axisProblem(1), {0.3, 0.35, -1.0});
    default:
      return oneRegionContent(axisProblem(2), {-4.0, -3.5});
  }
}

std::array<polyfly::MapContent, 3> axisContents() { return {axisContent(0), axisContent(1), axisContent(2)}; }

void cutOff(polyfly::MapContent& content, std::size_t index, double limit) {
  const double half = 0.5 * (content.parameters[index].upper - content.parameters[index].lower);
  content.planes.assign(content.parameters.size() + 1, 0.0);
  content.planes[index] = 1.0 / half;  // a distance in scaled parameters
  content.planes.back() = limit / half;
  content.rows.assign(1, 1);
  content.regions[0].row_count = 1;
}

MapInMemory::MapInMemory(const polyfly::MapContent& content, const std::string& name)
    : bytes_(nullptr, nullptr) {
  const std::vector<std::byte> bytes = polyfly::layOut(content);
  bytes_ = aligned(bytes.size());
  std::copy(bytes.begin(), bytes.end(), bytes_.get());
  map_ = std::make_unique<polyfly::RegionMap>(polyfly::RegionMap::view(bytes_.get(), bytes.size(), name));
}

Flight::Flight(const polyfly::MultirotorOptions& options) : Flight(axisContents(), options) {}

Flight::Flight(const std::array<polyfly::MapContent, 3>& contents,
               const polyfly::MultirotorOptions& options) {
  std::array<const polyfly::RegionMap*, 3> pointers{};
  for (std::size_t i = 0; i < 3; ++i) {
    maps[i] = std::make_unique<MapInMemory>(contents[i]);
    pointers[i] = &maps[i]->map();
  }
  controller =
      std::make_unique<OneLaw>(std::make_unique<polyfly::MultirotorController>(pointers, options), options);
}

std::string axisRefusal(std::size_t axis, const polyfly::MapContent& content) {
  const MapInMemory made(content);
  try {
    const polyfly::Axis refused(made.map(), polyfly::kAxisNames.at(axis), polyfly::MultirotorOptions{});
    return {};
  } catch (const polyfly::Error& error) {
    return error.what();
  }
}

}  // namespace polyfly_test
