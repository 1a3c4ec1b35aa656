#include "validation_ros/bag_reader.hpp"

#include <gtest/gtest.h>
#include <online_controller/ControllerStatus.h>
#include <rosbag/view.h>
#include <std_msgs/String.h>
#include <trajectory_msgs/MultiDOFJointTrajectory.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <string>
#include <vector>

#include "flight_bag.hpp"
#include "polyfly_base/error.hpp"
#include "synthetic_flight.hpp"
#include "validation/validation.hpp"

namespace polyfly_ros {
namespace {

using polyfly::FlightLog;
using polyfly::SyntheticFlight;

class BagReader : public testing::Test {
 protected:
  BagReader() {
    polyfly::FlightRecorder recorder(maps_.axes(), options_);
    recorder.hold(SyntheticFlight::home());
    for (std::size_t sample = 0; sample < 200; ++sample) recorder.fly(stamped(sample));
    log_ = recorder.log();
  }

  // With a stamp that survives the way through a message: whole nanoseconds.
  static polyfly::VehicleState stamped(std::size_t sample) {
    polyfly::VehicleState state = SyntheticFlight::state(sample);
    state.stamp = ros::Time(state.stamp).toSec();
    return state;
  }

  std::string path() const { return folder_ / "flight.bag"; }

  std::string errorOf(const BagTopics& topics = {}) const { return errorOf(path(), topics); }

  // The error of reading, without the path in front.
  static std::string errorOf(const std::string& path, const BagTopics& topics) {
    try {
      readBag(path, topics);
    } catch (const polyfly::Error& error) {
      const std::string text = error.what();
      EXPECT_EQ(text.substr(0, path.size() + 2), path + ": ");
      return text.substr(std::min(text.size(), path.size() + 2));
    }
    return "no error";
  }

  void expectExactReplay(const FlightLog& log, std::size_t samples) {
    const auto replayed = polyfly::replay(log, maps_.axes(), options_);
    EXPECT_EQ(replayed.size(), samples);
    const polyfly::ValidationReport report = polyfly::validate(log, replayed, maps_.axes(), options_);
    EXPECT_EQ(report.commands.compared, samples);
    EXPECT_EQ(report.commands.max_difference, 0.0);
    EXPECT_EQ(report.statuses.compared, samples);
    EXPECT_EQ(report.statuses.differing, 0u);
  }

  polyfly::ScratchFolder folder_;
  polyfly::HandMadeMaps maps_{folder_};
  polyfly::MultirotorOptions options_;
  FlightLog log_;
};

TEST_F(BagReader, givesBackWhatWasWrittenWithEachCompression) {
  log_.disturbances.push_back({SyntheticFlight::kStart, {0.1, 0.2, 0.3}});
  for (const auto compression :
       {rosbag::compression::Uncompressed, rosbag::compression::BZ2, rosbag::compression::LZ4}) {
    FlightBagOptions options;
    options.compression = compression;
    writeFlightBag(log_, path(), options);
    const FlightLog read = readBag(path(), {});
    EXPECT_EQ(read.source, path());
    ASSERT_EQ(read.odometry.size(), 200u);
    EXPECT_EQ(read.odometry[7].position, log_.odometry[7].position);
    EXPECT_EQ(read.odometry[7].stamp, log_.odometry[7].stamp);
    ASSERT_EQ(read.disturbances.size(), 1u);
    EXPECT_EQ(read.disturbances[0].acceleration, Eigen::Vector3d(0.1, 0.2, 0.3));
    EXPECT_EQ(read.statuses[7].theta, log_.statuses[7].theta);
    EXPECT_NEAR(read.statuses[7].step_time, 1e-6, 1e-15);
    expectExactReplay(read, 200);
  }
}

TEST_F(BagReader, countsMessagesThatAreRecordedTwiceOnce) {
  for (const double later : {0.0, 0.034}) {
    rosbag::Bag bag(path(), rosbag::bagmode::Write);
    FlightBagOptions options;
    for (const double late : {0.0, later}) {
      options.late = {{0.0, late}};
      writeFlight(log_, options, &bag);
    }
    bag.close();
    const FlightLog read = readBag(path(), {});
    expectExactReplay(read, 200);
    const auto told = [](const std::string& remark) {
      return remark.find("odometry: 200 messages are recorded again; each counts once") != std::string::npos;
    };
    EXPECT_TRUE(std::any_of(read.remarks.begin(), read.remarks.end(), told));
  }
}

// The reference of the begin is not recorded, that of later is.
TEST_F(BagReader, doesNotMoveAReferenceToTheBeginOfARecordingInFlight) {
  FlightLog part;
  for (std::size_t sample = 50; sample < 200; ++sample) {
    if (sample == 120) part.add(log_.references[0].trajectory, std::nullopt);
    part.add(log_.odometry[sample]);
    part.commands.push_back(log_.commands[sample]);
    part.statuses.push_back(log_.statuses[sample]);
  }
  writeFlightBag(part, path());
  const FlightLog read = readBag(path(), {});
  ASSERT_EQ(read.events.size(), 151u);
  // It bears the time of the odometry before it, and comes first.
  EXPECT_EQ(read.events[69].kind, FlightLog::EventKind::kReference);
  const auto samples = polyfly::replay(read, maps_.axes(), options_);
  const polyfly::ValidationReport report = polyfly::validate(read, samples, maps_.axes(), options_);
  EXPECT_EQ(report.verdict(), polyfly::Verdict::kDoubtful);
  EXPECT_TRUE(polyfly::brokenThresholds(report, {}).empty());
  EXPECT_EQ(report.tracked_samples, 81u);
}

// The second half has no reference: it goes on with that of the first.
TEST_F(BagReader, readsThePiecesOfASplitRecordingAsOneFlight) {
  rosbag::Bag whole(path(), rosbag::bagmode::Write);
  writeFlight(log_, {}, &whole);
  whole.close();
  whole.open(path());
  const std::string second = folder_ / "a_second.bag";
  {
    rosbag::Bag one(folder_ / "first.bag", rosbag::bagmode::Write), other(second, rosbag::bagmode::Write);
    for (const rosbag::MessageInstance& message : rosbag::View(whole))
      (message.getTime().toSec() < 101.0 ? one : other).write(message.getTopic(), message.getTime(), message);
  }
  const auto recordings = recordingsOf({second, folder_ / "first.bag"});
  ASSERT_EQ(recordings.size(), 1u);
  EXPECT_EQ(recordings[0].back(), second);
  const FlightLog read = readBag(recordings[0], {});
  expectExactReplay(read, 200);
  EXPECT_TRUE(read.share && read.share->isWhole());
  EXPECT_EQ(read.remarks, std::vector<std::string>{"the recording was split and goes on in " + second});
}

// Early in the flight the recorder falls behind by 1.4 s in steps, and catches up.
TEST_F(BagReader, aLateRecorderIsANote) {
  rosbag::Bag bag(path(), rosbag::bagmode::Write);
  FlightBagOptions options;
  options.late = {{100.2, 0.7}, {100.3, 1.4}, {100.35, 0.0}};
  writeFlight(log_, options, &bag);
  bag.close();
  const FlightLog read = readBag(path(), {});
  expectExactReplay(read, 200);
  const auto replayed = polyfly::replay(read, maps_.axes(), options_);
  EXPECT_TRUE(polyfly::validate(read, replayed, maps_.axes(), options_).warnings.empty());
  ASSERT_FALSE(read.remarks.empty());
  EXPECT_EQ(read.remarks.back(), "the recorder was late by up to 1.4 s and caught up");
}

TEST_F(BagReader, readsEachStatusThatTheMessageDefines) {
  using Message = online_controller::ControllerStatus;
  for (std::size_t i = 0; i <= Message::LEAST_VIOLATION; ++i)
    log_.statuses[i].status = static_cast<polyfly::ControlStatus>(i);
  for (std::size_t i = 0; i < polyfly::kControlReasonCount; ++i)
    log_.statuses[20 + i].reason = static_cast<polyfly::ControlReason>(i);
  writeFlightBag(log_, path());
  const FlightLog read = readBag(path(), {});
  ASSERT_EQ(read.statuses.size(), log_.statuses.size());
  for (std::size_t i = 0; i < read.statuses.size(); ++i) {
    EXPECT_EQ(read.statuses[i].status, log_.statuses[i].status) << i;
    EXPECT_EQ(read.statuses[i].reason, log_.statuses[i].reason) << i;
  }
  log_.statuses[3].status = static_cast<polyfly::ControlStatus>(Message::LEAST_VIOLATION + 1);
  writeFlightBag(log_, path());
  EXPECT_NE(errorOf().find("status or reason is none of those that the message defines"), std::string::npos)
      << errorOf();
  log_.statuses[3].status = polyfly::ControlStatus::kOptimal;
  log_.statuses[3].reason = static_cast<polyfly::ControlReason>(polyfly::kControlReasonCount);
  writeFlightBag(log_, path());
  EXPECT_NE(errorOf().find("status or reason is none of those that the message defines"), std::string::npos)
      << errorOf();
}

TEST_F(BagReader, doesNotDependOnWhenAnswersReachedTheRecorder) {
  FlightBagOptions options;
  options.arrival_shift = 0.035;
  writeFlightBag(log_, path(), options);
  expectExactReplay(readBag(path(), {}), 200);
}

TEST_F(BagReader, placesTheFirstReferenceByTheNodesAccount) {
  polyfly::FlightRecorder recorder(maps_.axes(), options_);
  for (std::size_t sample = 0; sample < 5; ++sample) recorder.fly(stamped(sample));
  recorder.hold(SyntheticFlight::home());
  for (std::size_t sample = 5; sample < 50; ++sample) recorder.fly(stamped(sample));
  FlightLog& log = recorder.log();
  // Wrong places of the reference in the record.
  for (const std::size_t wrong_place : {0, 2, 20}) {
    FlightLog shuffled = log;
    const FlightLog::Event reference = shuffled.events[5];
    ASSERT_EQ(reference.kind, FlightLog::EventKind::kReference);
    shuffled.events.erase(shuffled.events.begin() + 5);
    shuffled.events.insert(shuffled.events.begin() + static_cast<std::ptrdiff_t>(wrong_place), reference);
    writeFlightBag(shuffled, path());
    expectExactReplay(readBag(path(), {}), 50);
    // On the ground and under the pilot's sticks there is none either.
    shuffled.statuses[0].status = polyfly::ControlStatus::kMotorsOff;
    shuffled.statuses[1].status = polyfly::ControlStatus::kManual;
    writeFlightBag(shuffled, path());
    const FlightLog read = readBag(path(), {});
    EXPECT_EQ(read.events[5].kind, FlightLog::EventKind::kReference) << wrong_place;
  }
}

TEST_F(BagReader, putsSilenceWhereTheNodeNoticedIt) {
  polyfly::FlightRecorder recorder(maps_.axes(), options_);
  recorder.hold(SyntheticFlight::home());
  for (std::size_t sample = 0; sample < 50; ++sample) recorder.fly(stamped(sample));
  recorder.beSilent(stamped(60).stamp);
  recorder.beSilent(stamped(61).stamp);
  for (std::size_t sample = 80; sample < 150; ++sample) recorder.fly(stamped(sample));
  writeFlightBag(recorder.log(), path());
  const FlightLog read = readBag(path(), {});
  EXPECT_EQ(read.silences.size(), 2u);
  expectExactReplay(read, 120);
}

TEST_F(BagReader, findsTheNamespaceOrAsksForIt) {
  {
    rosbag::Bag bag(path(), rosbag::bagmode::Write);
    for (const char* name : {"/one", "/two"}) {
      FlightBagOptions options;
      options.name_space = name;
      writeFlight(log_, options, &bag);
    }
  }
  EXPECT_EQ(errorOf(),
            "holds commands of several vehicles, in the namespaces /one/ /two/: choose one with --namespace");
  BagTopics topics;
  for (const char* name : {"two", "/two", "/two/"}) {
    topics.name_space = name;
    EXPECT_EQ(readBag(path(), topics).odometry.size(), 200u) << name;
  }
  topics.name_space = "three";
  EXPECT_EQ(errorOf(topics).substr(0, 34), "no message on /three/odometry; the");
  FlightBagOptions root;
  root.name_space = "";
  writeFlightBag(log_, path(), root);
  EXPECT_EQ(readBag(path(), {}).odometry.size(), 200u);
}

TEST_F(BagReader, readsTrajectoriesFromTheirStamp) {
  FlightBagOptions options;
  options.references = false;
  rosbag::Bag bag(path(), rosbag::bagmode::Write);
  writeFlight(log_, options, &bag);
  trajectory_msgs::MultiDOFJointTrajectory message;
  message.header.stamp = ros::Time(SyntheticFlight::kStart + 0.5);
  for (int index = 0; index < 3; ++index) {
    trajectory_msgs::MultiDOFJointTrajectoryPoint point;
    point.time_from_start = ros::Duration(index);
    point.transforms.resize(1);
    point.transforms[0].translation.x = index;
    point.transforms[0].rotation.w = 1.0;
    message.points.push_back(point);
  }
  bag.write("/firefly/command/trajectory", ros::Time(SyntheticFlight::kStart), message);
  bag.close();
  const FlightLog read = readBag(path(), {});
  ASSERT_EQ(read.references.size(), 1u);
  ASSERT_TRUE(read.references[0].start.has_value());
  EXPECT_EQ(*read.references[0].start, SyntheticFlight::kStart + 0.5);
  EXPECT_EQ(read.references[0].trajectory.samples().size(), 3u);
  EXPECT_EQ(read.events[0].kind, FlightLog::EventKind::kReference);
}

TEST_F(BagReader, namesTheTopicThatIsMissing) {
  FlightBagOptions options;
  options.odometry = false;
  writeFlightBag(log_, path(), options);
  EXPECT_EQ(errorOf(),
            "no message on /firefly/odometry; the bag has /firefly/command/pose, "
            "/firefly/command/roll_pitch_yawrate_thrust, /firefly/controller_status");
  options = {};
  options.references = false;
  writeFlightBag(log_, path(), options);
  EXPECT_EQ(errorOf().substr(0, 76),
            "no message on /firefly/command/trajectory nor on /firefly/command/pose; the ");
  options = {};
  options.commands = false;
  writeFlightBag(log_, path(), options);
  BagTopics topics;
  topics.name_space = "firefly";
  EXPECT_EQ(errorOf(topics).substr(0, 56), "no message on /firefly/command/roll_pitch_yawrate_thrust");
  options = {};
  // Only the statuses may be missing.
  options.statuses = false;
  writeFlightBag(log_, path(), options);
  EXPECT_EQ(errorOf(), "no error");
}

TEST_F(BagReader, refusesTopicsOfAnotherType) {
  FlightBagOptions options;
  options.odometry = false;
  rosbag::Bag bag(path(), rosbag::bagmode::Write);
  writeFlight(log_, options, &bag);
  bag.write("/firefly/odometry", ros::Time(SyntheticFlight::kStart), std_msgs::String());
  bag.close();
  EXPECT_EQ(errorOf(), "topic /firefly/odometry: must be nav_msgs/Odometry, is std_msgs/String");
}

TEST_F(BagReader, refusesAnotherDefinitionOfTheSameType) {
  FlightBagOptions options;
  options.odometry = false;
  rosbag::Bag bag(path(), rosbag::bagmode::Write);
  writeFlight(log_, options, &bag);
  const auto connection = boost::make_shared<ros::M_string>();
  (*connection)["type"] = "nav_msgs/Odometry";
  (*connection)["md5sum"] = "0123456789abcdef0123456789abcdef";
  (*connection)["message_definition"] = "string data\n";
  bag.write("/firefly/odometry", ros::Time(SyntheticFlight::kStart), std_msgs::String(), connection);
  bag.close();
  EXPECT_EQ(errorOf(), "topic /firefly/odometry: recorded with another definition of nav_msgs/Odometry");
}

TEST_F(BagReader, saysWhyNoReferenceIsUsable) {
  FlightBagOptions options;
  options.references = false;
  rosbag::Bag bag(path(), rosbag::bagmode::Write);
  writeFlight(log_, options, &bag);
  bag.write("/firefly/command/trajectory", ros::Time(SyntheticFlight::kStart),
            trajectory_msgs::MultiDOFJointTrajectory());
  bag.close();
  EXPECT_EQ(errorOf().substr(0, 38), "no usable reference, the last one: com");
}

TEST_F(BagReader, refusesABagWithoutMessages) {
  rosbag::Bag(path(), rosbag::bagmode::Write).close();
  EXPECT_EQ(errorOf(), "holds no message");
}

}  // namespace
}  // namespace polyfly_ros

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
