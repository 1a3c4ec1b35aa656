#include <fcntl.h>
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "flight_bag.hpp"
#include "polyfly_base/provenance.hpp"
#include "polyfly_base/version.hpp"
#include "synthetic_flight.hpp"

extern char** environ;

namespace polyfly_ros {
namespace {

using polyfly::SyntheticFlight;

constexpr int kPassed = 0;
constexpr int kThresholdBroken = 1;
constexpr int kBadInput = 2;

std::string contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

class ValidateBag : public testing::Test {
 protected:
  ValidateBag() {
    polyfly::FlightRecorder recorder(maps_.axes(), {});
    recorder.hold(SyntheticFlight::home());
    for (std::size_t sample = 0; sample < 300; ++sample) {
      polyfly::VehicleState state = SyntheticFlight::state(sample);
      state.stamp = ros::Time(state.stamp).toSec();
      recorder.fly(state);
    }
    log_ = recorder.log();
    writeFlightBag(log_, folder_ / "flight.bag");
  }

  std::vector<std::string> inputs() const {
    return {"--bag", folder_ / "flight.bag", "--map", maps_.path(2), "--map", maps_.path(0), maps_.path(1)};
  }

  // Runs the tool; its exit code. What it wrote is in output_ and errors_.
  int run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), VALIDATE_BAG);
    std::vector<char*> words;
    for (std::string& argument : arguments) words.push_back(argument.data());
    words.push_back(nullptr);
    const std::string out = folder_ / "stdout";
    const std::string err = folder_ / "stderr";
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    constexpr int kFlags = O_WRONLY | O_CREAT | O_TRUNC;
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), kFlags, 0600);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), kFlags, 0600);
    pid_t child = 0;
    const int spawned = posix_spawn(&child, VALIDATE_BAG, &actions, nullptr, words.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    EXPECT_EQ(spawned, 0);
    int status = 0;
    EXPECT_EQ(waitpid(child, &status, 0), child);
    output_ = contents(out);
    errors_ = contents(err);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  int runWith(std::vector<std::string> more) {
    std::vector<std::string> arguments = inputs();
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }

  polyfly::ScratchFolder folder_;
  polyfly::HandMadeMaps maps_{folder_};
  polyfly::FlightLog log_;
  std::string output_;
  std::string errors_;
};

TEST_F(ValidateBag, passesAGoodFlight) {
  EXPECT_EQ(runWith({}), kPassed) << errors_;
  EXPECT_NE(output_.find("100 %  of 300 samples inside the maps"), std::string::npos);
  EXPECT_EQ(errors_, "");
}

TEST_F(ValidateBag, writesWhatItIsAskedFor) {
  EXPECT_EQ(runWith({"--quiet", "--json", folder_ / "numbers.json", "--report", folder_ / "report"}),
            kPassed);
  EXPECT_EQ(output_, "");
  EXPECT_EQ(nlohmann::json::parse(contents(folder_ / "numbers.json"))["coverage"], 1.0);
  EXPECT_EQ(nlohmann::json::parse(contents(folder_ / "report/summary.json"))["regions"], 6);
  EXPECT_NE(contents(folder_ / "report/index.html").find("Flight report"), std::string::npos);
}

TEST_F(ValidateBag, writesTheSamplesOfEachAxis) {
  EXPECT_EQ(runWith({"--quiet", "--report", folder_ / "report"}), kPassed) << errors_;
  const std::string lateral = contents(folder_ / "report/samples_lateral.csv");
  EXPECT_EQ(lateral.find("t,e_p_y,"), 0u) << lateral.substr(0, 80);
  EXPECT_GT(std::count(lateral.begin(), lateral.end(), '\n'), 100);
  EXPECT_EQ(runWith({"--explore", folder_ / "report"}), kBadInput);
  EXPECT_NE(errors_.find("offline_mpt explore MAP --samples"), std::string::npos) << errors_;
}

TEST_F(ValidateBag, failsWhenAThresholdIsBroken) {
  log_.commands[10].command.roll += 1e-3;
  writeFlightBag(log_, folder_ / "flight.bag");
  EXPECT_EQ(runWith({"--quiet"}), kThresholdBroken);
  EXPECT_EQ(errors_.substr(0, 47), "broken: difference to the recorded commands is ");
  EXPECT_EQ(runWith({"--max-command-difference", "0.01"}), kPassed);
}

// One clock for all stamps and the recorder, set after one of the three seconds.
TEST_F(ValidateBag, judgesInPiecesWhereTheClockWasSet) {
  for (const double jump : {1.7e9, 3600.0}) {
    polyfly::FlightLog log = log_;
    const double start = log.odometry.front().stamp;
    const auto set = [&](double* stamp) {
      if (*stamp > start + 1.0) *stamp = ros::Time(*stamp + jump).toSec();
    };
    for (polyfly::VehicleState& state : log.odometry) set(&state.stamp);
    for (polyfly::FlightLog::Command& command : log.commands) set(&command.stamp);
    for (polyfly::FlightLog::Status& status : log.statuses) set(&status.stamp);
    writeFlightBag(log, folder_ / "flight.bag");
    EXPECT_NE(runWith({"--json", folder_ / "numbers.json", "--report", folder_ / "report"}), kBadInput)
        << errors_;
    const nlohmann::json numbers = nlohmann::json::parse(contents(folder_ / "numbers.json"));
    EXPECT_EQ(numbers["samples"], log.odometry.size());
    EXPECT_NEAR(numbers["duration_s"].get<double>(), 3.0, 0.1);
    EXPECT_NE(numbers["warnings"].dump().find("Odometry: after "), std::string::npos) << numbers["warnings"];
    EXPECT_NE(contents(folder_ / "report/index.html").find("the times jump by"), std::string::npos);
    EXPECT_NE(output_.find("the times jump by"), std::string::npos) << output_;
  }
  constexpr long kMostMemory = 200'000;  // [KiB]
  rusage used{};
  getrusage(RUSAGE_CHILDREN, &used);
  EXPECT_LT(used.ru_maxrss, kMostMemory);
}

// Green means whole: the same flight, damaged in the ways of the field.
TEST_F(ValidateBag, isNotGreenWhereTheRecordingIsNotWhole) {
  const std::string good = contents(folder_ / "flight.bag");
  const std::string mark = "op=\x05";
  std::vector<std::size_t> chunks;
  for (std::size_t at = good.find(mark); at != std::string::npos; at = good.find(mark, at + 1))
    chunks.push_back(at);
  ASSERT_GT(chunks.size(), 4u);
  const auto change = [&good](std::size_t place, std::size_t count, char by) {
    std::string bad = good;
    for (std::size_t k = place; k < place + count; ++k) bad[k] = static_cast<char>(bad[k] ^ by);
    return bad;
  };
  const std::map<std::string, std::string> damaged = {
      {"cut", good.substr(0, good.size() / 2)},
      {"end", good.substr(0, good.size() - 10)},
      {"data", change(chunks[1] + 600, 400, 0x2a)},
      {"header", change(chunks[2] - 10, 4, 0x2a)},
  };
  EXPECT_EQ(runWith({"--strict"}), kPassed) << output_;
  EXPECT_NE(output_.find("Passed: "), std::string::npos);
  EXPECT_NE(output_.find("Read: 100 % of the messages"), std::string::npos) << output_;
  for (const auto& [name, bytes] : damaged) {
    std::ofstream(folder_ / "flight.bag", std::ios::binary) << bytes;
    EXPECT_EQ(runWith({"--strict", "--report", folder_ / name}), kThresholdBroken) << name << output_;
    EXPECT_EQ(output_.find("Passed"), std::string::npos) << name;
    EXPECT_NE(output_.find("recording"), std::string::npos) << name << output_;
    EXPECT_EQ(contents(folder_ / (name + "/index.html")).find("verdict good"), std::string::npos) << name;
    const auto json = nlohmann::json::parse(contents(folder_ / (name + "/summary.json")));
    EXPECT_NE(json["verdict"], "passed") << name;
    EXPECT_EQ(json["recording"]["whole"], false) << name;
  }
}

// Chunks of a few messages, of which one is lost.
TEST_F(ValidateBag, isDoubtfulWhereAPartIsMissing) {
  FlightBagOptions options;
  options.chunk_threshold = 4000;
  writeFlightBag(log_, folder_ / "flight.bag", options);
  const std::string good = contents(folder_ / "flight.bag");
  const std::string mark = "op=\x05";
  std::vector<std::size_t> chunks;
  for (std::size_t at = good.find(mark); at != std::string::npos; at = good.find(mark, at + 1))
    chunks.push_back(at);
  ASSERT_GT(chunks.size(), 20u);
  for (const std::size_t chunk : {std::size_t{1}, std::size_t{11}, chunks.size() - 1}) {
    std::string bad = good;
    for (std::size_t k = chunks[chunk] - 10; k < chunks[chunk] - 6; ++k) bad[k] ^= 0x2a;
    std::ofstream(folder_ / "flight.bag", std::ios::binary) << bad;
    EXPECT_EQ(runWith({"--json", folder_ / "numbers.json"}), kPassed) << output_;
    EXPECT_NE(output_.find("Doubtful: "), std::string::npos) << output_;
    EXPECT_NE(output_.find(" Lost: "), std::string::npos) << output_;
    EXPECT_EQ(nlohmann::json::parse(contents(folder_ / "numbers.json"))["recording"]["lost"].size(), 1u);
  }
}

TEST_F(ValidateBag, optionsOfTheNodeBearOnTheReplay) {
  std::ofstream(folder_ / "heavy.yaml") << "vehicle: {mass: 2.0}\n";
  EXPECT_EQ(runWith({"--options", folder_ / "heavy.yaml"}), kThresholdBroken);
  std::ofstream(folder_ / "default.yaml") << "vehicle: {mass: 1.52}\n";
  EXPECT_EQ(runWith({"--options", folder_ / "default.yaml"}), kPassed);
}

// What the bag tells is what the replay uses, and what --options and --map are held against.
TEST_F(ValidateBag, readsTheParametersInForce) {
  std::string told = "in_force:\n  node: \"/firefly/controller\"\n  version: \"" +
                     std::string(polyfly::kVersion) +
                     "\"\n  change: \"start\"\n  law: \"explicit_linear\"\n  "
                     "maps:\n";
  constexpr const char* kNames[] = {"longitudinal", "lateral", "vertical"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    told += "    " + std::string(kNames[axis]) + ": {name: \"made\", problem: \"" +
            polyfly::checksumOf(std::string(maps_.axes()[axis]->problemText())) + "\"}\n";
  }
  told += "law: \"explicit_linear\"\nprovenance: \"vehicle/mass from mass.yaml\"\nvehicle:\n  mass: 1.52\n";
  log_.parameters = {{log_.odometry.front().stamp, told}};
  writeFlightBag(log_, folder_ / "flight.bag");
  EXPECT_EQ(runWith({"--strict", "--report", folder_ / "report"}), kPassed) << output_ << errors_;
  EXPECT_NE(output_.find("law explicit_linear, told by /firefly/controller"), std::string::npos) << output_;
  EXPECT_EQ(contents(folder_ / "report/parameters_in_force.yaml"), told);
  const auto json = nlohmann::json::parse(contents(folder_ / "report/summary.json"));
  EXPECT_EQ(json["parameters"]["provenance"], "vehicle/mass from mass.yaml");
  // Another mass flew than these options have, and it is the replay's without them.
  const std::string mass = "mass: 1.52";
  log_.parameters[0].text.replace(told.find(mass), mass.size(), "mass: 1.6");
  writeFlightBag(log_, folder_ / "flight.bag");
  EXPECT_EQ(runWith({}), kThresholdBroken);
  std::ofstream(folder_ / "options.yaml") << "vehicle: {mass: 1.52}\n";
  EXPECT_EQ(runWith({"--strict", "--options", folder_ / "options.yaml"}), kThresholdBroken);
  EXPECT_NE(output_.find("not those that were in force: vehicle/mass 1.52 (in force 1.6)"), std::string::npos)
      << output_;
}

TEST_F(ValidateBag, badInputHasItsOwnExitCode) {
  EXPECT_EQ(run({}), kBadInput);
  EXPECT_EQ(runWith({"--no-such-option"}), kBadInput);
  for (const std::vector<std::string>& removed :
       std::vector<std::vector<std::string>>{{"--propose", folder_ / "wider"}, {"--propose-limit", "10"}}) {
    EXPECT_EQ(runWith(removed), kBadInput);
    EXPECT_NE(errors_.find("'proposed_range' in the JSON"), std::string::npos) << errors_;
  }
  EXPECT_EQ(runWith({"--map", maps_.path(1)}), kBadInput);
  EXPECT_NE(errors_.find("another one takes a run of its own"), std::string::npos) << errors_;
  EXPECT_EQ(runWith({"--min-coverage", "1.5"}), kBadInput);
  EXPECT_EQ(runWith({"--options", folder_ / "missing.yaml"}), kBadInput);
  EXPECT_NE(errors_.find("missing.yaml: file: cannot be opened"), std::string::npos);
  EXPECT_EQ(run({"--bag", folder_ / "missing.bag", "--map", maps_.path(0), maps_.path(1), maps_.path(2)}),
            kBadInput);
  EXPECT_NE(errors_.find("missing.bag: no such file"), std::string::npos);
  EXPECT_EQ(run({"--bag", folder_ / "flight.bag", "--map", maps_.path(0)}), kBadInput);
  EXPECT_NE(errors_.find("none for the lateral axis"), std::string::npos);
  EXPECT_EQ(run({"--bag", folder_ / "flight.bag", "--map", folder_ / "flight.bag"}), kBadInput);
  EXPECT_NE(errors_.find("flight.bag: is not a region map"), std::string::npos);
  EXPECT_EQ(runWith({"--json", folder_ / "missing/numbers.json"}), kBadInput);
}

TEST_F(ValidateBag, takesSeveralFlights) {
  writeFlightBag(log_, folder_ / "again.bag");
  EXPECT_EQ(
      runWith({"--bag", folder_ / "again.bag", "--json", folder_ / "all.json", "--report", folder_ / "all"}),
      kPassed)
      << errors_;
  const auto json = nlohmann::json::parse(contents(folder_ / "all.json"));
  EXPECT_EQ(json["samples"], 600);
  EXPECT_EQ(json["flights"].size(), 2u);
  EXPECT_NE(contents(folder_ / "all/index.html").find("flight_2/index.html"), std::string::npos);
  EXPECT_NE(contents(folder_ / "all/flight_2/samples_lateral.csv").find("t,"), std::string::npos);
}

TEST_F(ValidateBag, writesTopicsForRqt) {
  EXPECT_EQ(runWith({"--quiet", "--topics-bag", folder_ / "topics.bag"}), kPassed) << errors_;
  rosbag::Bag bag(folder_ / "topics.bag");
  rosbag::View view(bag);
  std::map<std::string, std::size_t> counts;
  for (const rosbag::MessageInstance& message : view) ++counts[message.getTopic()];
  for (const char* axis : {"longitudinal", "lateral", "vertical"}) {
    for (const char* topic : {"inside", "region", "edge_distance", "face_distance", "qp_difference"}) {
      EXPECT_EQ(counts["/validation/" + std::string(axis) + "/" + topic], 300u) << axis << topic;
    }
  }
  EXPECT_EQ(counts["/validation/tracking_error"], 300u);
}

TEST_F(ValidateBag, writesOverNothingThatItReads) {
  namespace fs = std::filesystem;
  const std::string flight = folder_ / "flight.bag", options = folder_ / "default.yaml";
  std::ofstream(options) << "vehicle: {mass: 1.52}\n";
  fs::create_symlink("flight.bag", folder_ / "link.bag");
  fs::create_hard_link(flight, folder_ / "hard.bag");
  fs::create_directory(folder_ / "report");
  fs::create_symlink("../flight.bag", folder_ / "report/summary.json");
  const std::string bytes = contents(flight), map = contents(maps_.path(1));
  for (const std::vector<std::string>& more : std::vector<std::vector<std::string>>{
           {"--json", flight},
           {"--json", folder_ / "./flight.bag"},
           {"--json", folder_ / "hard.bag"},
           {"--json", maps_.path(1)},
           {"--options", options, "--json", options},
           {"--topics-bag", flight},
           {"--topics-bag", folder_ / "link.bag"},
           {"--json", folder_ / "new", "--topics-bag", folder_ / "./new"},
           {"--report", folder_ / "report"},
           {"--report", folder_ / "new", "--json", folder_ / "new/summary.json"}}) {
    EXPECT_EQ(runWith(more), kBadInput) << more[1];
    EXPECT_EQ(std::count(errors_.begin(), errors_.end(), '\n'), 1) << errors_;
    EXPECT_NE(errors_.find("name of its own"), std::string::npos) << errors_;
    EXPECT_EQ(output_, "") << "told after the work";
  }
  EXPECT_EQ(contents(flight), bytes);
  EXPECT_EQ(contents(maps_.path(1)), map);
  EXPECT_FALSE(fs::exists(folder_ / "new"));
}

// A limit on the size of files stands for a full disk.
TEST_F(ValidateBag, keepsTheOldBagWhereTheDiskIsFull) {
  const std::string topics = folder_ / "topics.bag";
  ASSERT_EQ(runWith({"--quiet", "--topics-bag", topics}), kPassed) << errors_;
  const rlim_t whole = std::filesystem::file_size(topics);
  std::ofstream(topics) << "old";
  struct rlimit limit = {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &limit), 0);
  for (const rlim_t bytes : {rlim_t{1}, rlim_t{8000}, whole - 1}) {
    struct rlimit small = limit;
    small.rlim_cur = bytes;
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
    const int exit_code = runWith({"--quiet", "--topics-bag", topics});
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
    EXPECT_EQ(exit_code, kBadInput) << bytes;
    // Of the limit of one byte, the line that is said is cut too.
    if (bytes > 1) {
      EXPECT_EQ(errors_.rfind("validate_bag: " + topics + ": cannot be written: ", 0), 0u) << errors_;
      EXPECT_EQ(std::count(errors_.begin(), errors_.end(), '\n'), 1) << errors_;
    }
    EXPECT_EQ(contents(topics), "old");
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
    EXPECT_EQ(entry.path().string().find(".tmp-"), std::string::npos) << entry.path();
}

TEST_F(ValidateBag, helpTellsExitCodesAndDefaults) {
  EXPECT_EQ(run({"--help"}), kPassed);
  EXPECT_NE(output_.find("Exit codes: 0"), std::string::npos);
  EXPECT_NE(output_.find("command/roll_pitch_yawrate_thrust"), std::string::npos);
}

}  // namespace
}  // namespace polyfly_ros

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
