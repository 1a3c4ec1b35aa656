#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "identification/flight_signals.hpp"
#include "made_flight.hpp"

namespace polyfly {

/// The bytes of a file.
std::string contents(const std::filesystem::path& path);

/// Runs the command-line tool `calibrate` in a folder of its own, which holds flight.csv.
class CalibrateTool : public testing::Test {
 protected:
  CalibrateTool();
  ~CalibrateTool() override;

  /// Roll of a made flight, with the command held onto the rows of the response; `clock` gives their times.
  void writeFlight(
      const test::MadeLoop& made, std::uint32_t seed, const std::string& name,
      const std::function<double(double)>& clock = [](double time) { return time; });
  /// The signals of a made flight with stretches.
  void writeStretches(const FlightSignals& signals, const std::string& name);

  /// Exit code of the tool; `before` is a command of the shell in front of it.
  int run(const std::string& arguments, const std::string& before = "");
  std::string out() const { return contents(folder_ / "out.txt"); }
  std::string err() const { return contents(folder_ / "err.txt"); }
  void expectPage(const std::string& report, const std::vector<std::string>& all_words) const;

  std::filesystem::path folder_;
};

}  // namespace polyfly
