#include "identification/bag_signals.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>

#include "identification/identify_axis.hpp"
#include "made_bag.hpp"
#include "made_flight.hpp"
#include "polyfly_base/error.hpp"
#include "reference_data.hpp"

namespace polyfly {
namespace {

namespace fs = std::filesystem;
using test::MadeBag;
using test::MessageBytes;

// Start time of the made bags [s].
constexpr double kStart = 1.6e9;
const char* const kHeaderText =
    "Header header\n%\n===\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";

std::string definition(const std::string& fields, const std::string& types = "") {
  std::string text = kHeaderText;
  text.replace(text.find('%'), 1, fields);
  return text + types;
}

const std::string kCommand =
    definition("float64 roll\nfloat64 pitch\nfloat64 yaw_rate\ngeometry_msgs/Vector3 thrust",
               "===\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n");
const std::string kOdometry = definition(
    "string child_frame_id\ngeometry_msgs/PoseWithCovariance pose\ngeometry_msgs/TwistWithCovariance twist",
    "===\nMSG: geometry_msgs/PoseWithCovariance\nPose pose\nfloat64[36] covariance\n"
    "===\nMSG: geometry_msgs/Pose\nPoint position\nQuaternion orientation\n"
    "===\nMSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n"
    "===\nMSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"
    "===\nMSG: geometry_msgs/TwistWithCovariance\nTwist twist\nfloat64[36] covariance\n"
    "===\nMSG: geometry_msgs/Twist\nVector3 linear\nVector3 angular\n"
    "===\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n");

std::vector<std::uint8_t> commandMessage(double stamp, double roll) {
  return MessageBytes().header(stamp).put(roll).put(0.0).put(0.0).put(0.0).put(0.0).put(15.0).bytes;
}

// Rolled about x, moving up along the world's z with 1 m/s.
std::vector<std::uint8_t> odometryMessage(double stamp, double roll) {
  MessageBytes bytes;
  bytes.header(stamp).text("body").put(0.0).put(0.0).put(0.0);
  bytes.put(std::sin(0.5 * roll)).put(0.0).put(0.0).put(std::cos(0.5 * roll));
  for (int i = 0; i < 36; ++i) bytes.put(0.0);
  bytes.put(0.0).put(std::sin(roll)).put(std::cos(roll)).put(0.0).put(0.0).put(0.25);
  for (int i = 0; i < 36; ++i) bytes.put(0.0);
  return bytes.bytes;
}

class BagSignalsTest : public testing::Test {
 protected:
  BagSignalsTest() : path_(testing::TempDir() + "bag_signals_" + std::to_string(::getpid()) + ".bag") {}
  ~BagSignalsTest() override { fs::remove(path_); }

  // A made flight on the given topics; `clock` is added to the headers' time after half of it.
  void writeFlight(const std::vector<std::string>& vehicles, double clock = 0.0, bool shuffled = false,
                   const std::string& also = "") {
    const LoopRecord record = test::makeFlight({}, 1);
    MadeBag bag;
    for (const std::string& vehicle : vehicles) {
      // Another vehicle does something else.
      const double sign = vehicle == vehicles.front() ? 1.0 : -1.0;
      const auto command = bag.connect(vehicle + "/command/roll_pitch_yawrate_thrust",
                                       "mav_msgs/RollPitchYawrateThrust", kCommand);
      const auto odometry = bag.connect(vehicle + "/odometry", "nav_msgs/Odometry", kOdometry);
      if (!also.empty()) {
        bag.write(bag.connect(vehicle + also + "/odometry", "nav_msgs/Odometry", kOdometry), kStart,
                  odometryMessage(kStart, 0.0));
      }
      // All commands of a chunk come before its odometry: out of order if shuffled.
      std::size_t next = 0;
      for (std::size_t i = 0; i < record.response.time.size(); ++i) {
        const double ahead = shuffled ? 1.0 : 0.0;
        while (next < record.command.time.size() &&
               record.command.time[next] <= record.response.time[i] + ahead) {
          const double time = kStart + record.command.time[next];
          bag.write(command, time, commandMessage(time + command_lead_, sign * record.command.value[next]));
          ++next;
        }
        const double time = kStart + record.response.time[i];
        bag.write(odometry, time,
                  odometryMessage(stamp_(time) + (2 * i > record.response.time.size() ? clock : 0.0),
                                  sign * record.response.value[i]));
        if (i % 100 == 99) bag.endChunk();
      }
    }
    write(bag.bytes());
  }

  void write(const std::vector<std::uint8_t>& bytes) {
    std::ofstream file(path_, std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }

  std::string errorOf(const BagSignalOptions& options) {
    try {
      signalsFromBag(path_, options);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  AxisModel identifyRoll(const BagSignals& bag) {
    IdentifyOptions options;
    options.windows = {{0.0, 40.0}};
    return identifyAxis(axisRecords(bag.signals, "roll"), options);
  }

  std::string path_;
  // The stamp of an odometry message that the recorder receives at this time.
  std::function<double(double)> stamp_ = [](double time) { return time; };
  // Stamp of a command minus its receive time [s].
  double command_lead_ = 0.0;
};

TEST_F(BagSignalsTest, FindsCommandAndAttitude) {
  writeFlight({"/firefly"});
  const BagSignals bag = signalsFromBag(path_, {});
  EXPECT_TRUE(bag.health.remarks.empty());
  EXPECT_EQ(bag.signals.origin.at("roll"), "/firefly/odometry");
  EXPECT_NEAR(bag.signals.at("vz").value[100], 1.0, 1e-9);
  EXPECT_NEAR(bag.signals.at("vy").value[100], 0.0, 1e-9);
  EXPECT_NEAR(bag.signals.at("yaw_rate").value[0], 0.25, 1e-12);
  EXPECT_NEAR(bag.signals.at("thrust_cmd").value[0], 15.0, 1e-12);
  const test::MadeLoop made;
  const AxisModel model = identifyRoll(bag);
  EXPECT_NEAR(model.with_delay.gain, made.gain, 0.02);
  EXPECT_NEAR(model.with_delay.shape.tau, made.tau, 0.01);
  EXPECT_NEAR(model.with_delay.shape.delay, made.delay, 0.01);
}

TEST_F(BagSignalsTest, PutsMessagesInOrderOfTime) {
  writeFlight({""}, 0.0, true);
  const BagSignals bag = signalsFromBag(path_, {});
  EXPECT_GT(bag.health.out_of_order, 0u);
  const TimeSeries& command = bag.signals.at("roll_cmd");
  EXPECT_TRUE(std::is_sorted(command.time.begin(), command.time.end()));
  EXPECT_NEAR(identifyRoll(bag).with_delay.shape.delay, test::MadeLoop().delay, 0.01);
}

TEST_F(BagSignalsTest, UsesTheRecordersClockWhereTheHeadersJumps) {
  writeFlight({""}, 30.0);
  const BagSignals bag = signalsFromBag(path_, {});
  ASSERT_EQ(bag.health.remarks.size(), 1u);
  EXPECT_NE(bag.health.remarks[0].find("jumps by 30 s"), std::string::npos) << bag.health.remarks[0];
  EXPECT_NEAR(identifyRoll(bag).with_delay.shape.delay, test::MadeLoop().delay, 0.01);
}

TEST_F(BagSignalsTest, SaysWhichClockIsUsedWhereStampsAreMissing) {
  stamp_ = [](double) { return 0.0; };
  writeFlight({""});
  const BagSignals bag = signalsFromBag(path_, {});
  ASSERT_EQ(bag.health.remarks.size(), 1u);
  EXPECT_NE(bag.health.remarks[0].find("messages have no stamp; the times of the recorder are used"),
            std::string::npos)
      << bag.health.remarks[0];
  EXPECT_NEAR(identifyRoll(bag).with_delay.shape.delay, test::MadeLoop().delay, 0.01);
}

TEST_F(BagSignalsTest, SaysHowFarADelayMayBeOffWhereClocksAreMixed) {
  stamp_ = [](double time) { return time < kStart + 1.0 ? 0.0 : time; };
  command_lead_ = -0.03;
  writeFlight({""});
  const BagSignals bag = signalsFromBag(path_, {});
  ASSERT_EQ(bag.health.remarks.size(), 1u);
  EXPECT_NE(bag.health.remarks[0].find("up to 0.03 s after their stamps"), std::string::npos)
      << bag.health.remarks[0];
}

// Stamps of a clock that runs an hour ahead say nothing of messages that have the recorder's times only.
TEST_F(BagSignalsTest, LeavesAnotherClockOutWhereOneTopicHasNoStamps) {
  stamp_ = [](double) { return 0.0; };
  command_lead_ = 3600.0;
  writeFlight({""});
  const BagSignals bag = signalsFromBag(path_, {});
  ASSERT_EQ(bag.health.remarks.size(), 2u);
  EXPECT_NE(bag.health.remarks[0].find("the headers have another clock"), std::string::npos)
      << bag.health.remarks[0];
  EXPECT_NEAR(identifyRoll(bag).with_delay.shape.delay, test::MadeLoop().delay, 0.01);
}

TEST_F(BagSignalsTest, SaysThatPartsAreLost) {
  writeFlight({""});
  std::ifstream file(path_, std::ios::binary);
  std::vector<std::uint8_t> bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  bytes.resize(bytes.size() / 2);
  write(bytes);
  const BagSignals bag = signalsFromBag(path_, {});
  EXPECT_NE(bag.health.remarks.back().find("The end of the recording is missing"), std::string::npos)
      << bag.health.remarks.back();
}

TEST_F(BagSignalsTest, AsksWhichOfTwoVehicles) {
  writeFlight({"/one", "/two"});
  EXPECT_NE(errorOf({}).find("could come from /one/"), std::string::npos) << errorOf({});
  BagSignalOptions options;
  options.topics = {"/two/odometry", "/two/command/roll_pitch_yawrate_thrust"};
  EXPECT_EQ(signalsFromBag(path_, options).signals.origin.at("roll"), "/two/odometry");
}

TEST_F(BagSignalsTest, UsesTheTopicsOfOneNamespace) {
  writeFlight({"/alpha", "/bravo"});
  for (const std::string name : {"bravo", "/bravo", "/bravo/"}) {
    BagSignalOptions options;
    options.name_space = name;
    const BagSignals bag = signalsFromBag(path_, options);
    EXPECT_EQ(bag.signals.origin.at("roll_cmd"), "/bravo/command/roll_pitch_yawrate_thrust");
    EXPECT_EQ(bag.signals.origin.at("roll"), "/bravo/odometry");
  }
  // The beginning of a name is no namespace, and a chosen topic without a slash is one of the namespace.
  BagSignalOptions options;
  options.name_space = "brav";
  EXPECT_NE(errorOf(options).find("no topic in the namespace brav; there are /alpha/"), std::string::npos);
  options.name_space = "bravo";
  options.choice = {{"yaw_rate", "odometry:twist.twist.angular.z"}};
  EXPECT_EQ(signalsFromBag(path_, options).signals.origin.at("yaw_rate"), "/bravo/odometry");
  EXPECT_NE(errorOf({}).find("choose with --namespace"), std::string::npos) << errorOf({});
}

// As mavros and motion capture record a flight.
TEST_F(BagSignalsTest, ReadsAttitudeTargetsTransformsAndPoses) {
  const std::string quaternion =
      "===\nMSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n";
  const std::string vector = "===\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";
  const std::string target = definition(
      "uint8 IGNORE_THRUST=64\nuint8 type_mask\ngeometry_msgs/Quaternion orientation\n"
      "geometry_msgs/Vector3 body_rate\nfloat32 thrust",
      quaternion + vector);
  const std::string transform = definition("string child_frame_id\ngeometry_msgs/Transform transform",
                                           "===\nMSG: geometry_msgs/Transform\nVector3 translation\n"
                                           "Quaternion rotation\n" +
                                               vector + quaternion);
  const std::string pose = definition("geometry_msgs/Pose pose",
                                      "===\nMSG: geometry_msgs/Pose\nPoint position\nQuaternion orientation\n"
                                      "===\nMSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n" +
                                          quaternion);
  const auto rolled = [](MessageBytes bytes, double roll) {
    return bytes.put(std::sin(0.5 * roll)).put(0.0).put(0.0).put(std::cos(0.5 * roll));
  };
  MadeBag bag;
  const auto commands = bag.connect("/mavros/setpoint_raw/attitude", "mavros_msgs/AttitudeTarget", target);
  const auto vicon = bag.connect("/vicon/quad", "geometry_msgs/TransformStamped", transform);
  const auto local = bag.connect("/mavros/local_position/pose", "geometry_msgs/PoseStamped", pose);
  const auto asked = bag.connect("/mavros/setpoint_position/pose", "geometry_msgs/PoseStamped", pose);
  for (int i = 0; i < 5; ++i) {
    const double time = kStart + 0.01 * i;
    MessageBytes command = rolled(MessageBytes().header(time).put(std::uint8_t{0}), 0.3);
    command.put(0.0).put(0.0).put(0.5).put(0.6F);
    bag.write(commands, time, command.bytes);
    const MessageBytes head = MessageBytes().header(time).text("quad").put(0.0).put(0.0).put(0.0);
    bag.write(vicon, time, rolled(head, 0.2).bytes);
    const MessageBytes place = MessageBytes().header(time).put(0.0).put(0.0).put(0.0);
    bag.write(local, time, rolled(place, 0.1).bytes);
    bag.write(asked, time, rolled(place, 0.7).bytes);
  }
  bag.endChunk();
  write(bag.bytes());
  const FlightSignals signals = signalsFromBag(path_, {}).signals;
  EXPECT_NEAR(signals.at("roll_cmd").value[0], 0.3, 1e-9);
  EXPECT_NEAR(signals.at("yaw_rate_cmd").value[0], 0.5, 1e-9);
  EXPECT_NEAR(signals.at("thrust_cmd").value[0], 0.6, 1e-6);
  EXPECT_NEAR(signals.at("roll").value[0], 0.2, 1e-9);
  BagSignalOptions poses;
  poses.topics = {"attitude", "pose"};
  EXPECT_NEAR(signalsFromBag(path_, poses).signals.at("roll").value[0], 0.1, 1e-9);
}

TEST_F(BagSignalsTest, TakesASimulatorsTruthLast) {
  writeFlight({"/firefly"}, 0.0, false, "/ground_truth");
  EXPECT_EQ(signalsFromBag(path_, {}).signals.origin.at("roll"), "/firefly/odometry");
}

TEST_F(BagSignalsTest, TakesSignalsFromChosenFields) {
  writeFlight({"/one"});
  BagSignalOptions options;
  options.choice["roll_cmd"] = "/one/odometry:pose.pose.orientation.roll";
  options.choice["ve"] = "/one/odometry:twist.twist.linear.z";
  const BagSignals bag = signalsFromBag(path_, options);
  EXPECT_EQ(bag.signals.at("roll_cmd").value, bag.signals.at("roll").value);
  EXPECT_EQ(bag.signals.origin.at("ve"), "/one/odometry");
  options.choice["ve"] = "/nowhere:data";
  EXPECT_NE(errorOf(options).find("no topic /nowhere; there are /one/"), std::string::npos)
      << errorOf(options);
  options.choice["ve"] = "/one/odometry:nonsense";
  EXPECT_NE(errorOf(options).find("nav_msgs/Odometry has no number nonsense"), std::string::npos)
      << errorOf(options);
  options.choice["ve"] = "no colon";
  EXPECT_NE(errorOf(options).find("TOPIC:FIELD"), std::string::npos) << errorOf(options);
}

TEST_F(BagSignalsTest, LeavesOutMessagesThatAreNotWhatTheyShouldBe) {
  MadeBag bag;
  const auto odometry = bag.connect("/odometry", "nav_msgs/Odometry", kOdometry);
  bag.write(odometry, kStart, odometryMessage(kStart, 0.1));
  auto shorter = odometryMessage(kStart + 1.0, 0.1);
  shorter.resize(shorter.size() / 2);
  bag.write(odometry, kStart + 1.0, shorter);
  write(bag.bytes());
  const BagSignals signals = signalsFromBag(path_, {});
  EXPECT_EQ(signals.signals.at("roll").time.size(), 1u);
  ASSERT_EQ(signals.health.remarks.size(), 1u);
  EXPECT_NE(signals.health.remarks[0].find("1 messages are not what their definition says"),
            std::string::npos);
}

TEST_F(BagSignalsTest, RefusesATypeThatIsNotWhatItsNameSays) {
  MadeBag bag;
  bag.write(bag.connect("/odometry", "nav_msgs/Odometry", "float64 x\n"), kStart,
            MessageBytes().put(1.0).bytes);
  write(bag.bytes());
  EXPECT_NE(errorOf({}).find("topic /odometry: nav_msgs/Odometry has no number"), std::string::npos)
      << errorOf({});
  MadeBag none;
  write(none.bytes());
  EXPECT_NE(errorOf({}).find("holds no message"), std::string::npos) << errorOf({});
}

TEST(BagOfAFlight, GivesWhatItsTableGives) {
  const fs::path bag_path = referenceData("bags") / "jay_2017-04-10-10-09-32.bag";
  if (!fs::exists(bag_path))
    GTEST_SKIP() << "The recorded flights are not here: set POLYFLY_DATA to their folder.";
  IdentifyOptions options;
  options.windows = {{8.0, 20.0}, {24.0, 44.0}};
  const BagSignals bag = signalsFromBag(bag_path, {});
  const FlightSignals table = signalsFromCsv(readCsv(referenceData("flight_logs") / "mr_jay_100932.csv"), {});
  for (const char* axis : {"roll", "pitch"}) {
    const LoopFit from_bag = identifyAxis(axisRecords(bag.signals, axis), options).with_delay;
    const LoopFit from_table = identifyAxis(axisRecords(table, axis), options).with_delay;
    EXPECT_NEAR(from_bag.gain, from_table.gain, 0.002) << axis;
    EXPECT_NEAR(from_bag.shape.tau, from_table.shape.tau, 0.001) << axis;
    EXPECT_NEAR(from_bag.shape.delay, from_table.shape.delay, 0.001) << axis;
  }
}

}  // namespace
}  // namespace polyfly
