// Flies Figs. 7 and 8 of the chapter with each law of the multirotor and leaves what was flown: a CSV for
// each flight, summary.json and the rows of the report's table.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "command_line/command_line.hpp"
#include "online_controller/laws/multirotor_controller.hpp"
#include "online_controller/laws/nonlinear_controller.hpp"
#include "online_controller/types/attitude.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/outputs.hpp"
#include "polyfly_base/write_file.hpp"
#include "polyfly_test/law_flight.hpp"
#include "region_maps/region_map.hpp"

namespace {

using namespace polyfly;

struct Figure {
  const char* name;
  const char* title;
  /// Rate of the eight [rad/s].
  double rate;
};
constexpr Figure kFigures[] = {{"fig7", "Fig. 7: aggressive trajectory", 0.53},
                               {"fig8", "Fig. 8: more aggressive trajectory", 0.9}};
constexpr const char* kLaws[] = {"explicit_linear", "linear", "nonlinear"};

struct Result {
  double rms = 0.0, greatest = 0.0, rms_velocity = 0.0, rms_yaw = 0.0;
  double greatest_speed = 0.0, greatest_tilt = 0.0;
  int samples = 0, not_optimal = 0;
};

std::ostringstream sheet() {
  std::ostringstream text;
  text.precision(9);
  return text;
}

void writeSample(std::ostream& file, double time, const VehicleState& truth, const Reference& reference,
                 const ControlReport& report) {
  const EulerAngles angles = eulerAngles(truth.attitude);
  file << time;
  for (const Eigen::Vector3d& triple :
       {truth.position, reference.position, truth.velocity, reference.velocity}) {
    file << ',' << triple.x() << ',' << triple.y() << ',' << triple.z();
  }
  file << ',' << angles.roll << ',' << angles.pitch << ',' << angles.yaw << ',' << wrapAngle(reference.yaw)
       << ',' << report.command.roll << ',' << report.command.pitch << ',' << report.command.thrust << ','
       << static_cast<int>(report.status) << '\n';
}

Result fly(ControlLaw& law, const FlightFigure& figure, const PlantOptions& options,
           const std::filesystem::path& path) {
  std::ostringstream file = sheet();
  file << "t,x,y,z,x_ref,y_ref,z_ref,v_x,v_y,v_z,v_x_ref,v_y_ref,v_z_ref,roll,pitch,yaw,yaw_ref,roll_cmd,"
          "pitch_cmd,thrust,status\n";
  LawFlight flown(figure, options, law);
  Result result;
  while (!flown.over()) {
    flown.measure();
    const ControlReport report = law.step(flown.state(), flown.preview());
    const VehicleState truth = flown.plant().truth();
    const Reference reference = figure.at(flown.time());
    writeSample(file, flown.time(), truth, reference, report);
    law.prepare();
    flown.advance(report.command);

    const double error = (truth.position - reference.position).norm();
    const EulerAngles angles = eulerAngles(truth.attitude);
    result.rms += error * error;
    result.greatest = std::max(result.greatest, error);
    result.rms_velocity += (truth.velocity - reference.velocity).squaredNorm();
    const double yaw = wrapAngle(angles.yaw - reference.yaw);
    result.rms_yaw += yaw * yaw;
    result.greatest_speed = std::max(result.greatest_speed, truth.velocity.norm());
    result.greatest_tilt = std::max({result.greatest_tilt, std::abs(angles.roll), std::abs(angles.pitch)});
    result.not_optimal += report.status == ControlStatus::kOptimal ? 0 : 1;
    ++result.samples;
  }
  for (double* sum : {&result.rms, &result.rms_velocity, &result.rms_yaw})
    *sum = std::sqrt(*sum / result.samples);
  writeFileAtomically(path.string(), file.str());
  return result;
}

std::unique_ptr<ControlLaw> make(const std::string& law, const std::vector<RegionMap>& maps,
                                 const std::array<MpcProblem, 3>& problems) {
  if (law == "nonlinear")
    return std::make_unique<NonlinearController>(MultirotorOptions{}, NonlinearMpcOptions{});
  if (law == "linear") return std::make_unique<MultirotorController>(problems, MultirotorOptions{});
  return std::make_unique<MultirotorController>(std::array<const RegionMap*, 3>{&maps[0], &maps[1], &maps[2]},
                                                MultirotorOptions{});
}

void addRow(std::ostream& table, const Figure& figure, const std::string& law, const Result& result) {
  char row[400];
  std::snprintf(row, sizeof row,
                "<tr><td>%s</td><td>%s</td><td>%.4f</td><td>%.4f</td><td>%.4f</td><td>%.4f</td><td>%.2f</td>"
                "<td>%.1f</td><td>%d of %d</td></tr>\n",
                figure.title, law.c_str(), result.rms, result.greatest, result.rms_velocity, result.rms_yaw,
                result.greatest_speed, result.greatest_tilt * 180.0 / 3.14159265358979, result.not_optimal,
                result.samples);
  table << row;
}

void run(const std::string& maps_folder, const std::string& problems_folder,
         const std::filesystem::path& folder) {
  std::vector<RegionMap> maps;
  std::array<MpcProblem, 3> problems;
  const char* axes[] = {"longitudinal", "lateral", "vertical"};
  for (std::size_t i = 0; i < 3; ++i) {
    maps.push_back(RegionMap::open(maps_folder + "/multirotor_" + axes[i] + ".map"));
    problems[i] = loadProblem(problems_folder + "/multirotor_" + axes[i] + ".yaml");
  }
  // Conditions of the laboratory: some noise, almost no wind.
  PlantOptions plant;
  plant.gust_sigma = {0.05, 0.05, 0.02};
  plant.position_noise = 0.002;
  plant.velocity_noise = 0.01;
  plant.attitude_noise = 0.002;
  nlohmann::json summary;
  std::ostringstream table = sheet();
  for (const Figure& chosen : kFigures) {
    FigureOptions options;
    options.rate = chosen.rate;
    const FlightFigure figure(options);
    std::map<std::string, double> rms;
    for (const std::string law : kLaws) {
      const std::unique_ptr<ControlLaw> flown = make(law, maps, problems);
      const Result result =
          fly(*flown, figure, plant, folder / (std::string(chosen.name) + "_" + law + ".csv"));
      rms[law] = result.rms;
      addRow(table, chosen, law, result);
      summary["flights"][std::string(chosen.name) + "_" + law] = {
          {"rms_m", result.rms},
          {"greatest_m", result.greatest},
          {"rms_velocity_m_s", result.rms_velocity},
          {"rms_yaw_rad", result.rms_yaw},
          {"greatest_speed_m_s", result.greatest_speed},
          {"greatest_tilt_rad", result.greatest_tilt},
          {"not_optimal", result.not_optimal},
          {"samples", result.samples}};
      summary["headline"].push_back(
          {std::string(chosen.name) + ": position error of " + law + ", RMS", result.rms, "m"});
    }
    summary["headline"].push_back(
        {std::string(chosen.name) + ": nonlinear over linear, RMS", rms["nonlinear"] / rms["linear"], ""});
  }
  writeFileAtomically((folder / "table.html").string(), table.str());
  writeFileAtomically((folder / "summary.json").string(), summary.dump(2) + '\n');
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Flies Figs. 7 and 8 of the chapter with each law of the multirotor in simulated time.",
               "multirotor_figures");
  std::string maps, problems, folder;
  app.add_option("--maps", maps, "folder of the solved maps")->required();
  app.add_option("--problems", problems, "folder of their problem files")->required();
  app.add_option("-o,--output", folder, "folder for what was flown")->required();
  return polyfly::runTool(app, argc, argv, [&] {
    checkOutputs({{folder + "/summary.json", Output::Kind::kText, Output::Folder::kIsMade}}, {});
    makeFolder(folder);
    run(maps, problems, folder);
    return 0;
  });
}
