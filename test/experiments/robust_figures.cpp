// Flies the ASLquad over Figs. 10 to 13 by the robust MPC and by others, and leaves what was flown: a CSV for
// each flight of the first seed, summary.json and the rows of the report's tables.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "command_line/command_line.hpp"
#include "polyfly_base/outputs.hpp"
#include "polyfly_base/write_file.hpp"
#include "polyfly_test/aslquad_figures.hpp"

namespace {

using namespace polyfly_test;

void writeFlight(const std::filesystem::path& path, const std::vector<AslquadSample>& flight) {
  std::ostringstream file;
  file.precision(9);
  file << "t,x,y,z,x_ref,y_ref,z_ref,v_x,v_y,v_z,roll,pitch,roll_cmd,pitch_cmd,load_x,load_y,load_z,d_x,d_y,"
          "status\n";
  for (const AslquadSample& sample : flight) {
    file << sample.time;
    const Eigen::Vector3d load = sample.truth.position + sample.truth.load_offset;
    for (const Eigen::Vector3d& triple :
         {sample.truth.position, sample.reference.position, sample.truth.velocity}) {
      file << ',' << triple.x() << ',' << triple.y() << ',' << triple.z();
    }
    file << ',' << sample.truth.roll << ',' << sample.truth.pitch << ',' << sample.command.roll << ','
         << sample.command.pitch;
    file << ',' << load.x() << ',' << load.y() << ',' << load.z() << ',' << sample.disturbance.x() << ','
         << sample.disturbance.y() << ',' << static_cast<int>(sample.status) << '\n';
  }
  polyfly::writeFileAtomically(path.string(), file.str());
}

/// A number of the flights of all seeds.
struct Column {
  const char* key;
  const char* title;
  double (*of)(const AslquadErrors&);
};

const std::vector<Column>& columns() {
  static const std::vector<Column> kAll{
      {"rms_m", "rms [m]", [](const AslquadErrors& e) { return e.rms; }},
      {"greatest_m", "greatest [m]", [](const AslquadErrors& e) { return e.greatest; }},
      {"greatest_x_m", "x [m]", [](const AslquadErrors& e) { return e.greatest_axis.x(); }},
      {"greatest_y_m", "y [m]", [](const AslquadErrors& e) { return e.greatest_axis.y(); }},
      {"greatest_z_m", "z [m]", [](const AslquadErrors& e) { return e.greatest_axis.z(); }},
      {"settled_s", "within 0.1 m after [s]", [](const AslquadErrors& e) { return e.settled; }},
      {"overshoot_m", "overshoot [m]", [](const AslquadErrors& e) { return e.overshoot; }},
      {"speed_m_s", "speed along x, y [m/s]", [](const AslquadErrors& e) { return e.speed; }},
      {"tilt_rad", "tilt [rad]", [](const AslquadErrors& e) { return e.tilt; }},
      {"input_change_rad", "command's change, rms [rad]",
       [](const AslquadErrors& e) { return e.input_change; }},
      {"within_bound", "disturbance in its range [share]", [](const AslquadErrors& e) { return e.within; }},
      {"degraded", "clipped [share]",
       [](const AslquadErrors& e) { return static_cast<double>(e.degraded) / std::max(1, e.samples); }},
  };
  return kAll;
}

const char* title(AslquadFigure figure) {
  switch (figure) {
    case AslquadFigure::kHelix:
      return "Fig. 10: helix in turbulent wind from one side";
    case AslquadFigure::kHit:
      return "Fig. 11: hover with a slung load that is hit";
    case AslquadFigure::kSquare:
      return "Fig. 12: a square, ten times, with the load";
    case AslquadFigure::kStep:
      return "Fig. 13: a step of 1.25 m with the load";
  }
  return "";
}

const char* title(AslquadLaw law) {
  switch (law) {
    case AslquadLaw::kRobust:
      return "robust MPC";
    case AslquadLaw::kNominal:
      return "linear MPC";
    case AslquadLaw::kLqr:
      return "LQR";
    case AslquadLaw::kDisturbanceEstimate:
      return "linear MPC with disturbance estimate";
  }
  return "";
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

void run(const std::string& problems, const std::filesystem::path& output, int seeds) {
  using polyfly::Output;
  const std::string page = (output / "summary.json").string();
  polyfly::checkOutputs({{page, Output::Kind::kText, Output::Folder::kIsMade}}, {});
  polyfly::makeFolder(output.string());
  const AslquadFlights flights(problems, output.string() + "/");
  nlohmann::json summary;
  for (int seed = 1; seed <= seeds; ++seed) summary["seeds"].push_back(seed);
  std::ostringstream tables;
  tables.precision(3);
  const std::string of_seeds = seeds == 1 ? "seed 1" : "seeds 1 to " + std::to_string(seeds);
  for (const AslquadFigure figure : kAslquadFigures) {
    tables << "<h2>" << title(figure) << "</h2>\n<p>Median of " << of_seeds
           << ", and the greatest of them; the picture is seed 1.</p>\n<table><tr><th>law</th>";
    for (const Column& column : columns()) tables << "<th>" << column.title << "</th>";
    tables << "</tr>\n";
    for (const AslquadLaw law : kAslquadLaws) {
      std::vector<AslquadErrors> errors;
      for (int seed = 1; seed <= seeds; ++seed) {
        const std::vector<AslquadSample> flight = flights.fly(figure, law, seed);
        if (seed == 1)
          writeFlight(output / (std::string(figureName(figure)) + "_" + lawName(law) + ".csv"), flight);
        errors.push_back(flights.judge(figure, flight));
      }
      tables << "<tr><td>" << title(law) << "</td>";
      for (const Column& column : columns()) {
        std::vector<double> values;
        for (const AslquadErrors& error : errors) values.push_back(column.of(error));
        const double middle = median(values), most = *std::max_element(values.begin(), values.end());
        summary["flights"][figureName(figure)][lawName(law)][column.key] = {{"median", middle},
                                                                            {"greatest", most}};
        tables << "<td>" << middle << " (" << most << ")</td>";
      }
      tables << "</tr>\n";
      // of a step, the error at its beginning says nothing
      const std::size_t first = figure == AslquadFigure::kStep ? 5 : 0;
      for (const Column& column : {columns()[first], columns()[first + 1]}) {
        summary["headline"].push_back(
            {std::string(figureName(figure)) + ", " + title(law) + ": " + column.title,
             summary["flights"][figureName(figure)][lawName(law)][column.key]["median"], ""});
      }
    }
    tables << "</table>\n<p><img src=\"" << figureName(figure) << ".svg\" alt=\"" << figureName(figure)
           << "\"></p>\n";
  }
  polyfly::writeFileAtomically((output / "summary.json").string(), summary.dump(2) + '\n');
  polyfly::writeFileAtomically((output / "tables.html").string(), tables.str());
}

}  // namespace

int main(int count, char** words) {
  CLI::App app("Flies the ASLquad over Figs. 10 to 13.", "robust_figures");
  std::string problems, output;
  int seeds = 20;
  app.add_option("--problems", problems, "folder with aslquad_*.yaml")->required();
  app.add_option("--output", output, "folder for the results")->required();
  app.add_option("--seeds", seeds, "flights of each kind, seeds 1, 2, ..")
      ->capture_default_str()
      ->check(polyfly::wholeNumber(1, 1000));
  return polyfly::runTool(app, count, words, [&] {
    run(problems, output, seeds);
    return 0;
  });
}
