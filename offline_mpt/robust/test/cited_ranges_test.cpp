// Ranges of disturbances that a problem file takes from another file.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "error_of.hpp"
#include "holds.hpp"
#include "made_robust.hpp"

namespace polyfly {
namespace {

namespace fs = std::filesystem;

class CitedRanges : public testing::Test {
 protected:
  CitedRanges() : folder_(testing::TempDir() + "cited_ranges_" + std::to_string(::getpid())) {
    fs::create_directories(folder_ + "/data");
    write("data/bounds.yaml",
          "kind: disturbance\ndata: {file: hover.bag, checksum: fnv1a:12ab, recorded: x}\nshare: 0.99\n"
          "disturbances:\n  - {name: d_x, unit: m/s^2, range: [-0.1, 0.2]}\n"
          "  - {name: d_y, unit: m/s^2, range: [-3.5e-1, 0.4375]}\n  - {name: d_r, unit: rad, range: [-1, "
          "1]}\n");
  }
  ~CitedRanges() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ + "/" + name) << text;
  }
  RobustProblem load(const std::string& range) const {
    MadeRobust made;
    made.disturbance = range;
    write("problem.yaml", made.text());
    return loadRobustProblem(folder_ + "/problem.yaml");
  }
  std::string refusal(const std::string& range) const {
    return errorOf([&] { load(range); });
  }

  std::string folder_;
};

TEST_F(CitedRanges, AreTheNumbersOfTheFileExactly) {
  const RobustProblem cited = load("{from: data/bounds.yaml, name: d_y}");
  const RobustProblem written = load("[-3.5e-1, 0.4375]");
  EXPECT_EQ(cited.drift, written.drift);
  EXPECT_EQ(cited.G(1, 0), written.G(1, 0));
  EXPECT_DOUBLE_EQ(cited.disturbances[0].upper, 0.4375);
}

TEST_F(CitedRanges, LeaveATextThatNeedsNoOtherFileAndSaysWhereTheyAreFrom) {
  const RobustProblem cited = load("{from: data/bounds.yaml, name: d_y}");
  fs::remove_all(folder_ + "/data");
  const RobustProblem again = parseRobustProblem(cited.text, "map");
  EXPECT_EQ(again.G(1, 0), cited.G(1, 0));
  EXPECT_EQ(again.text, cited.text);
  EXPECT_EQ(cited.text.find("from:"), std::string::npos);
  EXPECT_NE(cited.text.find("# d_y of data/bounds.yaml, from hover.bag fnv1a:12ab, share 0.99"),
            std::string::npos);
}

TEST_F(CitedRanges, NameAllFlights) {
  write("data/bounds.yaml",
        "kind: disturbance\ndata:\n  - {file: one.bag, checksum: x1}\n  - {file: two.bag, checksum: x2}\n"
        "disturbances:\n  - {name: d_y, unit: m/s^2, range: [-0.35, 0.4]}\n");
  EXPECT_NE(load("{from: data/bounds.yaml, name: d_y}").text.find("from one.bag x1, from two.bag x2"),
            std::string::npos);
}

TEST_F(CitedRanges, SeveralChannelsEachHaveTheirOwn) {
  MadeRobust made;
  made.torque = true;
  std::string text = made.text();
  const std::string torque = "range: [-0.1, 0.2]";
  ASSERT_NE(text.find(torque), std::string::npos);
  text.replace(text.find(torque), torque.size(), "range: {from: data/bounds.yaml, name: d_t}");
  write("two.yaml", text);
  write("data/bounds.yaml", "disturbances:\n  - {name: d_t, unit: rad/s, range: [-0.3, 0.5]}\n");
  const RobustProblem problem = loadRobustProblem(folder_ + "/two.yaml");
  EXPECT_DOUBLE_EQ(problem.disturbances[0].upper, 0.5);
  EXPECT_DOUBLE_EQ(problem.disturbances[1].lower, -0.3);
  EXPECT_DOUBLE_EQ(problem.disturbances[1].upper, 0.5);
}

TEST_F(CitedRanges, AreThoseOfAMultirotorAndOfKnownKeys) {
  const std::string begin = "polyfly_calibration: 1\nkind: disturbance\nvehicle: {kind: ";
  const std::string end =
      ", reason: \"It circles.\"}\ndata: {file: a.bag}\ndisturbances:\n  - {name: d_y, unit: m/s^2, range: "
      "[-1, 1]}\n"
      "axes:\n  y: {supported: true}\n";
  const auto told = [&](const std::string& text) {
    write("data/bounds.yaml", text);
    return refusal("{from: data/bounds.yaml, name: d_y}");
  };
  EXPECT_EQ(told(begin + "multirotor" + end), "no error");
  EXPECT_EQ(told(begin + "unknown" + end), "no error");
  const std::string wing = told(begin + "fixed_wing" + end);
  EXPECT_NE(wing.find("bounds.yaml:3: vehicle.kind: must be multirotor"), std::string::npos) << wing;
  EXPECT_NE(wing.find("It circles."), std::string::npos) << wing;
  EXPECT_NE(told(begin + "multirotor" + end + "odd: 1\n").find("odd"), std::string::npos);
  EXPECT_NE(told(begin + "multirotor" + end + "  z: {suported: false}\n").find("suported"),
            std::string::npos);
  const std::string mass =
      "polyfly_calibration: 1\nkind: mass\ndata: {file: a.bag}\nparameters: {mass: {value: 1}}\n";
  EXPECT_NE(told(mass).find("kind: must be disturbance"), std::string::npos);
  const std::string own = "disturbances:\n  - {name: d_y, unit: m/s^2, range: [-1, 1]";
  EXPECT_EQ(told(own + "}\n"), "no error");
  EXPECT_NE(told(own + ", supported: false}\n").find("supported"), std::string::npos);
  EXPECT_NE(told(own + "}\nrage: 1\n").find("rage"), std::string::npos);
}

TEST_F(CitedRanges, RefuseWhatIsNotThere) {
  EXPECT_TRUE(holds(refusal("{from: data/none.yaml, name: d_y}"), "data/none.yaml"));
  EXPECT_TRUE(holds(refusal("{from: data/bounds.yaml, name: d_z}"), "must be a disturbance of"));
  EXPECT_TRUE(holds(refusal("{from: data/bounds.yaml, name: d_r}"), "must be m/s^2"));
  EXPECT_TRUE(holds(refusal("{from: data/bounds.yaml}"), "name: missing"));
  EXPECT_TRUE(holds(refusal("{name: d_y, from: data/bounds.yaml}"), "on one line"));
  write("data/bounds.yaml", "disturbances:\n  - {name: d_y, unit: m/s^2, range: [1]}\n");
  EXPECT_TRUE(holds(refusal("{from: data/bounds.yaml, name: d_y}"), "[lower, upper]"));
  const std::string bounds =
      "disturbances:\n  - {name: d_y, unit: m/s^2, range: [-1, 1]}\naxes:\n  y: {supported: ";
  write("data/bounds.yaml", bounds + "false}\n");
  EXPECT_TRUE(holds(refusal("{from: data/bounds.yaml, name: d_y}"), "name: the data do not support"));
  write("data/bounds.yaml", bounds + "true}\n");
  EXPECT_EQ(refusal("{from: data/bounds.yaml, name: d_y}"), "no error");
  // a text alone has no folder to look in
  MadeRobust made;
  made.disturbance = "{from: data/bounds.yaml, name: d_y}";
  EXPECT_THROW(made.problem(), Error);
}

}  // namespace
}  // namespace polyfly
