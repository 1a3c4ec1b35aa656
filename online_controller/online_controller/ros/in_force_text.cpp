#include "online_controller_ros/in_force_text.hpp"

#include <array>
#include <string>
#include <vector>

#include "mpc_core/calibration_provenance.hpp"
#include "polyfly_base/provenance.hpp"

namespace polyfly_ros {
namespace {

constexpr std::array<const char*, 3> kInForceAxes{"longitudinal", "lateral", "vertical"};

std::vector<std::vector<double>> rowsOf(const Eigen::MatrixXd& matrix) {
  std::vector<std::vector<double>> rows(static_cast<std::size_t>(matrix.rows()));
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    for (Eigen::Index column = 0; column < matrix.cols(); ++column)
      rows[static_cast<std::size_t>(row)].push_back(matrix(row, column));
  }
  return rows;
}

// The model x' = A x + B u, and the text that it is from, if it is not made from the options.
void writeProblem(const std::string& space, const polyfly::MpcProblem& problem, polyfly::OptionsText& text) {
  if (!problem.text.empty()) text.text(space + "/problem", polyfly::checksumOf(problem.text));
  const std::string calibrations = polyfly::calibrationsOf(problem.text);
  if (!calibrations.empty()) text.text(space + "/calibration", calibrations);
  text.matrix(space + "/A", rowsOf(problem.A_c));
  text.matrix(space + "/B", rowsOf(problem.B_c));
}

void writeMaps(const char* name, const polyfly::MapSet& set, polyfly::OptionsText& text) {
  for (std::size_t axis = 0; axis < set.maps.size(); ++axis) {
    const std::string space = std::string(polyfly::kInForceGroup) + "/" + name + "/" + kInForceAxes.at(axis);
    const polyfly::RegionMap& map = set.maps[axis];
    text.text(space + "/name", std::string(map.name()));
    text.text(space + "/checksum", polyfly::hexDigits(map.checksum()));
    writeProblem(space, set.problems.at(axis), text);
  }
}

}  // namespace

void writeInForce(const LawSetup& setup, polyfly::Law law, polyfly::OptionsText& text) {
  polyfly::MultirotorParameters now = setup.parameters;
  now.law = polyfly::lawName(law);
  const std::string space = polyfly::kInForceGroup;
  text.text(space + "/law", now.law);
  const std::vector<polyfly::LawType>& types = polyfly::lawTypes();
  for (std::size_t i = 0; i < types.size(); ++i) {
    if (types[i].maps != nullptr) writeMaps(types[i].maps, setup.sources->maps[i], text);
  }
  for (std::size_t axis = 0; axis < setup.sources->problems.size(); ++axis)
    writeProblem(space + "/linear/" + kInForceAxes.at(axis), setup.sources->problems.at(axis), text);
  polyfly::visitMultirotorParameters(now, text);
}

}  // namespace polyfly_ros
