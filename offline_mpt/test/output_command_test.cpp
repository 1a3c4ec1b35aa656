// What the program `offline_mpt` writes into: links, FIFOs, devices, and never what it reads.
#include <fcntl.h>
#include <sys/stat.h>

#include <filesystem>

#include "run_program.hpp"

namespace polyfly {
namespace {

namespace fs = std::filesystem;

class OutputCommand : public ToolTest {
 protected:
  void SetUp() override {
    write("toy.json", kToy);
    write("thetas.csv", "0,0\n");
    output("solve toy.json -o toy.map");
  }

  void expectNameOfItsOwn(const std::string& line) const { expectRefused(line, {"name of its own"}); }
};

TEST_F(OutputCommand, KeepsItsInputsUnderAnyNameAndItsOutputsApart) {
  fs::create_symlink("toy.json", path("link.map"));
  fs::create_hard_link(path("toy.json"), path("hard.json"));
  fs::create_directory_symlink(".", path("here"));
  const std::string bytes = text("toy.map");
  for (const std::string& line :
       Words{"solve toy.json -o toy.json", "solve toy.json -o " + path("toy.json"),
             "solve toy.json -o link.map", "solve toy.json -o new.map --stats ./toy.json",
             "solve toy.json -o new.map --stats new.map", "solve toy.json -o new.map --stats here/new.map",
             "solve toy.json -o new.map --stats new.map.checkpoint",
             "solve toy.json -o new.map --stats hard.json", "reduce toy.map -o toy.map",
             "reduce toy.map -o new.map --stats new --certificate ./new",
             "verify toy.map --problem toy.json --json toy.json",
             "verify toy.map --exact --certificate toy.map",
             "verify toy.map --exact --certificate new --json ./new",
             "verify toy.map --reduced-from toy.map --certificate new --json ./new",
             "eval toy.map --csv thetas.csv -o here/thetas.csv", "explore toy.map -o toy.map",
             "explore toy.map --samples thetas.csv -o here/thetas.csv",
             "plot toy.map --slice theta_0,theta_1 -o here/toy.map"})
    expectNameOfItsOwn(line);
  EXPECT_EQ(text("toy.json"), kToy);
  EXPECT_EQ(text("toy.map"), bytes);
}

// A problem in YAML may name other files, which it reads too.
TEST_F(OutputCommand, KeepsTheFilesThatAProblemCites) {
  write("tracking.yaml", "calibration: [../work/flight.yaml]\n");
  write("robust.yaml", "model:\n  disturbances:\n    - {name: d, range: {from: flight.yaml, name: d}}\n");
  write("flight.yaml", "kind: disturbance\n");
  for (const std::string name : {"tracking.yaml", "robust.yaml"}) {
    expectNameOfItsOwn("solve " + name + " -o flight.yaml");
    expectNameOfItsOwn("verify toy.map --problem " + name + " --json flight.yaml");
  }
}

// A map is read back; a checkpoint is written in any order.
TEST_F(OutputCommand, NeedsAFileForMapsAndCheckpoints) {
  ASSERT_EQ(mkfifo(path("fifo").c_str(), 0600), 0);
  fs::create_symlink("/dev/full", path("device"));
  fs::create_symlink("/dev/full", path("new.map.checkpoint"));
  for (const std::string place : {"fifo", "device"}) {
    expectRefused("solve toy.json -o " + place, {place + ": must be a file"});
    expectRefused("reduce toy.map -o " + place, {place + ": must be a file"});
    expectRefused("verify toy.map --exact --repair -o " + place, {place + ": must be a file"});
  }
  expectRefused("solve toy.json -o new.map --force", {"new.map.checkpoint: must be a file"});
  EXPECT_TRUE(fs::is_fifo(path("fifo")));
  EXPECT_TRUE(fs::is_symlink(path("device")));
}

TEST_F(OutputCommand, WritesTextsIntoAFifo) {
  ASSERT_EQ(mkfifo(path("fifo").c_str(), 0600), 0);
  const int reader = open(path("fifo").c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  for (const char* const line :
       {"solve toy.json -o other.map --stats fifo", "reduce toy.map -o small.map --stats fifo",
        "reduce toy.map -o small.map --certificate fifo", "verify toy.map --samples 10 --json fifo",
        "verify toy.map --exact --json fifo", "verify toy.map --exact --certificate fifo",
        "eval toy.map --csv thetas.csv -o fifo"}) {
    output(line);
    char bytes[65536];
    EXPECT_GT(read(reader, bytes, sizeof bytes), 10) << line;
    EXPECT_TRUE(fs::is_fifo(path("fifo"))) << line;
  }
  close(reader);
}

TEST_F(OutputCommand, WritesWhatALinkLeadsTo) {
  fs::create_directory(path("maps"));
  fs::create_symlink("maps/toy.map", path("link.map"));
  output("solve toy.json -o link.map");
  EXPECT_TRUE(fs::is_symlink(path("link.map")));
  EXPECT_EQ(text("maps/toy.map"), text("toy.map"));
}

}  // namespace
}  // namespace polyfly
