#pragma once

#include <string>
#include <vector>

#include "bags/message_layout.hpp"
#include "bags/scan_bag.hpp"
#include "identification/header_clock.hpp"
#include "identification/loop_record.hpp"

namespace polyfly {

/// Which times the signals of a topic have.
enum class SignalClock { kHeaders, kRecorder };

/// A signal in the messages of a topic.
struct FieldUse {
  std::string signal;
  /// Paths of the numbers that it is made of: one; four of a quaternion; or these and three of a vector.
  std::vector<std::string> paths;
  /// Of a quaternion roll, pitch or yaw; of a vector that it turns x, y or z; empty: the number itself.
  std::string part;
  /// Factor from the field's unit to that of the signal.
  double scale = 1.0;
  /// The lowest rank wins where several fields give one signal.
  int rank = 0;
};

/// From `FIELD`, `QUATERNION.roll` (or pitch, yaw), or `QUATERNION*VECTOR.x` (or y, z), the vector turned by the
/// quaternion.
FieldUse fieldUse(const std::string& signal, const std::string& place, double scale, int rank);

/// Collects signals from the messages of one topic.
class TopicSignals {
 public:
  TopicSignals(const BagConnection& connection, std::vector<FieldUse> uses);

  void add(const BagMessage& message);

  const std::string& type() const { return type_; }
  const std::vector<FieldUse>& uses() const { return uses_; }
  /// Whether no message was usable.
  bool isEmpty() const { return received_.empty(); }

  /// What the stamps are worth. Messages without a header have no stamp.
  HeaderClock clock() const { return headerClock(stamps_, received_); }

  /// The signal of this place in `uses`, in order of time, counted from `start`.
  TimeSeries series(std::size_t use, double start, SignalClock which) const;

  /// What is wrong with the messages and their stamps, in clauses; times are counted from `start`.
  std::vector<std::string> remarks(double start) const;

 private:
  std::string type_;
  MessageLayout layout_;
  std::vector<FieldUse> uses_;
  std::vector<std::string> paths_;
  // Stamps of the headers [s]; 0 where there is none.
  std::vector<double> stamps_;
  // Receive times of the recorder [s].
  std::vector<double> received_;
  // Values of each use.
  std::vector<std::vector<double>> values_;
  std::size_t misfits_ = 0;
};

}  // namespace polyfly
