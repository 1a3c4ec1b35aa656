// What the program `offline_mpt` writes into: links, FIFOs, devices, and never what it reads.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "run_program.hpp"

namespace polyfly {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

// min z^2/2 - (a + b) z, |z| <= 1: three regions
const char* const kToy = R"({"name": "toy", "H": [[1.0]], "f": [0.0], "F": [[-1.0, -1.0]],
    "A": [[1.0], [-1.0]], "b": [1.0, 1.0], "B": [[0.0, 0.0], [0.0, 0.0]], "eq_ids": [],
    "lb": [-2.0, -2.0], "ub": [2.0, 2.0], "A_theta": [], "b_theta": [], "out": [0]})";

class OutputCommand : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directory(work_);
    writeBytes(problem_, kToy);
    writeBytes(path("thetas.csv"), "0,0\n");
    ASSERT_EQ(run({"solve", problem_, "-o", map_}).exit_code, 0);
  }

  std::string path(const std::string& name) const { return work_ + "/" + name; }

  Outcome run(Words arguments) const {
    arguments.insert(arguments.begin(), OFFLINE_MPT_PROGRAM);
    return waitForProgram(startProgram(std::move(arguments), folder_.path(".")), folder_.path("."));
  }

  /// One line on standard error with these words; nothing is left behind.
  void expectRefused(const Words& arguments, const std::string& words) const {
    const std::size_t before = fileCount();
    const Outcome result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << result.out << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_NE(result.err.find(words), std::string::npos) << words << " in: " << result.err;
    EXPECT_EQ(fileCount(), before) << "a file was left behind";
  }

  std::size_t fileCount() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(work_), fs::directory_iterator()));
  }

  ScratchFolder folder_;
  const std::string work_ = folder_.path("work");
  const std::string problem_ = path("toy.json");
  const std::string map_ = path("toy.map");
};

TEST_F(OutputCommand, KeepsItsInputsUnderAnyNameAndItsOutputsApart) {
  fs::create_symlink("toy.json", path("link.map"));
  fs::create_hard_link(problem_, path("hard.json"));
  fs::create_directory_symlink(".", path("here"));
  const std::string bytes = readBytes(map_);
  for (const Words& arguments : std::vector<Words>{
           {"solve", problem_, "-o", path("link.map")},
           {"solve", problem_, "-o", path("new.map"), "--stats", path("here/new.map")},
           {"solve", problem_, "-o", path("new.map"), "--stats", path("new.map.checkpoint")},
           {"solve", problem_, "-o", path("new.map"), "--stats", path("hard.json")},
           {"reduce", map_, "-o", path("new.map"), "--stats", path("new"), "--certificate", path("./new")},
           {"verify", map_, "--exact", "--certificate", path("new"), "--json", path("./new")},
           {"verify", map_, "--reduced-from", map_, "--certificate", path("new"), "--json", path("./new")},
           {"eval", map_, "--csv", path("thetas.csv"), "-o", path("here/thetas.csv")},
           {"explore", map_, "--samples", path("thetas.csv"), "-o", path("here/thetas.csv")},
           {"plot", map_, "--slice", "theta_0,theta_1", "-o", path("here/toy.map")}})
    expectRefused(arguments, "name of its own");
  EXPECT_EQ(readBytes(problem_), kToy);
  EXPECT_EQ(readBytes(map_), bytes);
}

// A problem in YAML may name other files, which it reads too.
TEST_F(OutputCommand, KeepsTheFilesThatAProblemCites) {
  writeBytes(path("tracking.yaml"), "calibration: [../work/flight.yaml]\n");
  writeBytes(path("robust.yaml"),
             "model:\n  disturbances:\n    - {name: d, range: {from: flight.yaml, name: d}}\n");
  writeBytes(path("flight.yaml"), "kind: disturbance\n");
  for (const std::string name : {"tracking.yaml", "robust.yaml"}) {
    expectRefused({"solve", path(name), "-o", path("flight.yaml")}, "name of its own");
    expectRefused({"verify", map_, "--problem", path(name), "--json", path("flight.yaml")},
                  "name of its own");
  }
}

// A map is read back; a checkpoint is written in any order.
TEST_F(OutputCommand, NeedsAFileForMapsAndCheckpoints) {
  const std::string fifo = path("fifo"), device = path("device");
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  fs::create_symlink("/dev/full", device);
  fs::create_symlink("/dev/full", path("new.map.checkpoint"));
  for (const std::string& place : {fifo, device}) {
    expectRefused({"solve", problem_, "-o", place}, place + ": must be a file");
    expectRefused({"reduce", map_, "-o", place}, place + ": must be a file");
    expectRefused({"verify", map_, "--exact", "--repair", "-o", place}, place + ": must be a file");
  }
  expectRefused({"solve", problem_, "-o", path("new.map"), "--force"}, "new.map.checkpoint: must be a file");
  EXPECT_TRUE(fs::is_fifo(fifo));
  EXPECT_TRUE(fs::is_symlink(device));
}

TEST_F(OutputCommand, WritesTextsIntoAFifo) {
  const std::string fifo = path("fifo");
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  const int reader = open(fifo.c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  for (const Words& arguments :
       std::vector<Words>{{"solve", problem_, "-o", path("other.map"), "--stats", fifo},
                          {"reduce", map_, "-o", path("small.map"), "--stats", fifo},
                          {"reduce", map_, "-o", path("small.map"), "--certificate", fifo},
                          {"verify", map_, "--samples", "10", "--json", fifo},
                          {"verify", map_, "--exact", "--json", fifo},
                          {"verify", map_, "--exact", "--certificate", fifo},
                          {"eval", map_, "--csv", path("thetas.csv"), "-o", fifo}}) {
    const Outcome result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    char bytes[65536];
    EXPECT_GT(read(reader, bytes, sizeof bytes), 10) << arguments[0];
    EXPECT_TRUE(fs::is_fifo(fifo)) << arguments[0];
  }
  close(reader);
}

TEST_F(OutputCommand, WritesWhatALinkLeadsTo) {
  fs::create_directory(path("maps"));
  fs::create_symlink("maps/toy.map", path("link.map"));
  ASSERT_EQ(run({"solve", problem_, "-o", path("link.map")}).exit_code, 0);
  EXPECT_TRUE(fs::is_symlink(path("link.map")));
  EXPECT_EQ(readBytes(path("maps/toy.map")), readBytes(map_));
}

}  // namespace
}  // namespace polyfly
