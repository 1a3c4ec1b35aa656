#pragma once

#include <map>
#include <string>
#include <vector>

#include "bags/message_layout.hpp"
#include "bags/scan_bag.hpp"
#include "identification/header_clock.hpp"
#include "identification/loop_record.hpp"

namespace polyfly {

/// Which times the signals of a topic have.
enum class SignalClock { kHeaders, kRecorder };

/// A number of a message: a field as it is, or an angle of a quaternion.
struct FieldUse {
  std::string signal;
  /// Path of a number, or of a quaternion if an angle is requested.
  std::string path;
  /// roll, pitch, yaw; empty: the number itself.
  std::string angle;
  /// Factor from the field's unit to that of the signal.
  double scale = 1.0;
};

/// Collects signals from the messages of one topic.
class TopicSignals {
 public:
  /// `with_velocity`: the message is an odometry, whose twist is turned into the world's frame for vx, vy,
  /// vz.
  TopicSignals(const BagConnection& connection, std::vector<FieldUse> uses, bool with_velocity);

  void add(const BagMessage& message);

  /// Names of the signals. Empty if no message was usable.
  std::vector<std::string> names() const;

  /// What the stamps are worth. Messages without a header have no stamp.
  HeaderClock clock() const { return headerClock(stamps_, received_); }

  /// Series by signal, in order of time, counted from `start`.
  std::map<std::string, TimeSeries> series(double start, SignalClock which) const;

  /// What is wrong with the messages and their stamps, in clauses; times are counted from `start`.
  std::vector<std::string> remarks(double start) const;

 private:
  std::string topic_;
  MessageLayout layout_;
  std::vector<FieldUse> uses_;
  bool with_velocity_ = false;
  std::vector<std::string> paths_;
  // Stamps of the headers [s]; 0 where there is none.
  std::vector<double> stamps_;
  // Receive times of the recorder [s].
  std::vector<double> received_;
  std::vector<std::string> names_;
  // Values of each name.
  std::vector<std::vector<double>> values_;
  std::size_t misfits_ = 0;
};

}  // namespace polyfly
