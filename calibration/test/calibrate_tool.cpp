#include "calibrate_tool.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <utility>

#include "identification/loop_record.hpp"

namespace polyfly {

namespace fs = std::filesystem;

std::string contents(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

CalibrateTool::CalibrateTool()
    : folder_(fs::path(testing::TempDir()) / ("calibrate_tool_" + std::to_string(::getpid()))) {
  fs::create_directories(folder_);
  writeFlight({}, 1, "flight.csv");
}

CalibrateTool::~CalibrateTool() { fs::remove_all(folder_); }

void CalibrateTool::writeFlight(const test::MadeLoop& made, std::uint32_t seed, const std::string& name,
                                const std::function<double(double)>& clock) {
  const LoopRecord record = test::makeFlight(made, seed);
  std::ofstream file(folder_ / name);
  file.precision(14);
  file << "t_s,roll_cmd_rad,roll_rad\n";
  std::size_t held = 0;
  for (std::size_t i = 0; i < record.response.time.size(); ++i) {
    const auto& command = record.command;
    while (held + 1 < command.time.size() && command.time[held + 1] <= record.response.time[i]) ++held;
    file << clock(record.response.time[i]) << "," << command.value[held] << "," << record.response.value[i]
         << "\n";
  }
}

void CalibrateTool::writeStretches(const FlightSignals& signals, const std::string& name) {
  const std::pair<const char*, const char*> columns[] = {{"roll_cmd", "roll_cmd_rad"},
                                                         {"pitch_cmd", "pitch_cmd_rad"},
                                                         {"roll", "roll_rad"},
                                                         {"pitch", "pitch_rad"},
                                                         {"yaw", "yaw_rad"},
                                                         {"vx", "vx_mps"},
                                                         {"vy", "vy_mps"},
                                                         {"vz", "vz_mps"},
                                                         {"thrust_cmd", "thrust_cmd"}};
  std::ofstream file(folder_ / name);
  file << "t_s";
  for (const auto& [signal, column] : columns) file << "," << column;
  for (std::size_t i = 0; i < signals.at("roll").time.size(); ++i) {
    file << "\n" << signals.at("roll").time[i];
    for (const auto& [signal, column] : columns) file << "," << signals.at(signal).value[i];
  }
}

int CalibrateTool::run(const std::string& arguments, const std::string& before) {
  const std::string line = std::string("cd ") + folder_.string() + " && " + before + CALIBRATE_PROGRAM + " " +
                           arguments + " > out.txt 2> err.txt";
  const int status = std::system(line.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void CalibrateTool::expectPage(const std::string& report, const std::vector<std::string>& all_words) const {
  const std::string page = contents(folder_ / report / "index.html");
  for (const std::string& words : all_words) EXPECT_NE(page.find(words), std::string::npos) << words;
  EXPECT_NE(page.find("<svg"), std::string::npos);
  EXPECT_TRUE(fs::exists(folder_ / report / "calibration.yaml"));
}

}  // namespace polyfly
