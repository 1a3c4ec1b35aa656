// From a recorded bag to the range of a disturbance, from there into a problem file, and from that to a map.
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "identification/bag_signals.hpp"
#include "identification/motion_output.hpp"
#include "made_bag.hpp"
#include "offline_mpt/encode.hpp"
#include "polyfly_base/read_text.hpp"
#include "polyfly_test/aslquad_figures.hpp"
#include "project_root.hpp"
#include "region_maps/write_map.hpp"
#include "report/yaml.hpp"
#include "robust_mpc/robust_law.hpp"

namespace polyfly_test {
namespace {

namespace fs = std::filesystem;
using polyfly::test::MessageBytes;

constexpr double kStart = 1.6e9;  // [s]
const std::string kHeader = "===\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";
const std::string kVector = "===\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";
const std::string kCommand =
    "Header header\nfloat64 roll\nfloat64 pitch\nfloat64 yaw_rate\ngeometry_msgs/Vector3 thrust\n" + kHeader +
    kVector;
const std::string kOdometry =
    "Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
    "geometry_msgs/TwistWithCovariance twist\n" +
    kHeader +
    "===\nMSG: geometry_msgs/PoseWithCovariance\nPose pose\nfloat64[36] covariance\n"
    "===\nMSG: geometry_msgs/Pose\nPoint position\nQuaternion orientation\n"
    "===\nMSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n"
    "===\nMSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"
    "===\nMSG: geometry_msgs/TwistWithCovariance\nTwist twist\nfloat64[36] covariance\n"
    "===\nMSG: geometry_msgs/Twist\nVector3 linear\nVector3 angular\n" +
    kVector;

MessageBytes& put(MessageBytes& bytes, const Eigen::Vector3d& values) {
  return bytes.put(values.x()).put(values.y()).put(values.z());
}

std::vector<std::uint8_t> odometry(double stamp, const polyfly::PlantState& state) {
  const Eigen::Quaterniond attitude(Eigen::AngleAxisd(state.yaw, Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(state.pitch, Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(state.roll, Eigen::Vector3d::UnitX()));
  MessageBytes bytes;
  bytes.header(stamp).text("body");
  put(bytes, state.position);
  bytes.put(attitude.x()).put(attitude.y()).put(attitude.z()).put(attitude.w());
  for (int i = 0; i < 36; ++i) bytes.put(0.0);
  put(bytes, attitude.conjugate() * state.velocity);
  put(bytes, Eigen::Vector3d::Zero());
  for (int i = 0; i < 36; ++i) bytes.put(0.0);
  return bytes.bytes;
}

void writeBag(const std::string& path, const std::vector<AslquadSample>& flight) {
  polyfly::test::MadeBag bag;
  const auto commands =
      bag.connect("/command/roll_pitch_yawrate_thrust", "mav_msgs/RollPitchYawrateThrust", kCommand);
  const auto states = bag.connect("/odometry", "nav_msgs/Odometry", kOdometry);
  for (const AslquadSample& sample : flight) {
    const double time = kStart + sample.time;
    bag.write(states, time, odometry(time, sample.truth));
    MessageBytes bytes;
    bytes.header(time).put(sample.command.roll).put(sample.command.pitch).put(sample.command.yaw_rate);
    put(bytes, {0.0, 0.0, sample.command.thrust});
    bag.write(commands, time, bytes.bytes);
  }
  bag.endChunk();
  const std::vector<std::uint8_t> bytes = bag.bytes();
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

std::string replaced(std::string text, const std::string& old, const std::string& by) {
  const std::size_t place = text.find(old);
  if (place == std::string::npos) throw std::runtime_error("there is no " + old);
  return text.replace(place, old.size(), by);
}

TEST(DisturbanceRoundTrip, FromABagToAMap) {
  const std::string problems = polyfly::problemFile("robust");
  const std::string folder = testing::TempDir() + "round_trip_" + std::to_string(::getpid()) + "/";
  fs::create_directories(folder);
  const AslquadFlights flights(problems, folder);
  const std::vector<AslquadSample> flight =
      flights.fly(AslquadFigure::kHelix, AslquadLaw::kDisturbanceEstimate, 1);
  writeBag(folder + "helix.bag", flight);

  // calibrate disturbance
  const polyfly::FlightSignals signals = polyfly::signalsFromBag(folder + "helix.bag", {}).signals;
  polyfly::MotionOptions options;
  options.mass = figurePlant(AslquadFigure::kHelix, 1).mass;
  polyfly::MotionCalibration calibration;
  calibration.kind = "disturbance";
  calibration.data = {polyfly::provenanceOf(folder + "helix.bag")};
  calibration.windows.emplace_back();
  // Half a minute tells as much as twenty independent samples: enough to bound two thirds of the time,
  // and what it does not support is refused.
  calibration.limits.share = 0.65;
  calibration.bounds =
      polyfly::boundDisturbance({polyfly::motionOf(signals, options)}, options, calibration.limits);
  std::ofstream(folder + "disturbance.yaml") << polyfly::yamlText(polyfly::jsonOf(calibration));

  const std::string text =
      replaced(polyfly::readText(problems + "/aslquad_lateral.yaml"), "unit: m/s^2, range: [-0.5, 0.5]}",
               "unit: m/s^2, range: {from: disturbance.yaml, name: d_y}}");
  std::ofstream(folder + "cited.yaml") << text;
  const polyfly::RobustProblem problem = polyfly::loadRobustProblem(folder + "cited.yaml");
  const polyfly::Signal& channel = problem.disturbances[0];
  // The wind blows along +y with 0.3 m/s^2; drag against the helix' speed adds to it.
  EXPECT_LT(channel.lower, 0.3);
  EXPECT_GT(channel.upper, 0.3);
  int within = 0;
  for (const AslquadSample& sample : flight) {
    const double drag = 0.15 * sample.truth.velocity.y();
    const double w = sample.disturbance.y() - drag;
    within += w >= channel.lower && w <= channel.upper ? 1 : 0;
  }
  EXPECT_GT(within, 0.97 * static_cast<double>(flight.size()));
  EXPECT_LT(channel.upper - channel.lower, 1.2);

  const polyfly::RoundedLaw law = polyfly::roundLaw(
      problem,
      polyfly::explicitLaw(problem, polyfly::projectFeasibleSet(polyfly::buildRobustProgram(problem))),
      polyfly::ExploreStatus::kComplete);
  polyfly::writeMap(polyfly::encode(law.program, law.partition), folder + "cited.map");
  fs::remove(folder + "disturbance.yaml");
  const polyfly::RegionMap map = polyfly::RegionMap::open(folder + "cited.map");
  // what flies carries the numbers and where they are from
  const polyfly::MpcProblem model = polyfly::parseFlightModel(std::string(map.problemText()), map.path());
  EXPECT_EQ(model.disturbances[0].lower, channel.lower);
  EXPECT_NE(std::string(map.problemText()).find("# d_y of disturbance.yaml, from helix.bag"),
            std::string::npos);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace polyfly_test
