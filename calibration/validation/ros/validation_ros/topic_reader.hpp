#pragma once

#include <ros/exception.h>
#include <ros/message_traits.h>
#include <ros/serialization.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "bags/message_layout.hpp"
#include "bags/recording_share.hpp"
#include "bags/scan_bag.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly_ros {

/// Told the share of the file that was read, 0..1.
using BagProgress = std::function<void(double)>;

template <class Message>
std::string typeOf() {
  return ros::message_traits::DataType<Message>::value();
}

/// The messages of a recording by topic and type, in the order in which the recorder received them. All of them are held until
/// they are read, since a vehicle's namespace is not known before the bag's end.
class TopicReader {
 public:
  /// The pieces of one recording, in order; at least one.
  explicit TopicReader(std::vector<std::string> paths) : paths_(std::move(paths)), path_(paths_.front()) {}

  /// Reads the files and holds the messages of all topics whose names end with one of `names`. Called once.
  /// Throws Error.
  void scan(const std::vector<std::string>& names, const BagProgress& progress);

  /// Takes the given namespace as the vehicle's. Where it is empty, it is that of the topic `command` of type
  /// mav_msgs/RollPitchYawrateThrust. Throws Error where there are several.
  void findNamespace(const std::string& name_space, const std::string& command);

  /// The name of a topic that lies in the vehicle's namespace, unless it has a leading slash.
  std::string fullName(const std::string& topic) const {
    return !topic.empty() && topic.front() == '/' ? topic : prefix_ + topic;
  }

  /// Whether a topic lies in the vehicle's namespace.
  bool isOfVehicle(const std::string& topic) const { return topic.rfind(prefix_, 0) == 0; }

  bool has(const std::string& topic) const { return types_.count(topic) > 0; }

  template <class Message>
  std::vector<std::string> topicsOf() const {
    std::vector<std::string> names;
    for (const auto& [name, type] : types_) {
      if (type == typeOf<Message>()) names.push_back(name);
    }
    return names;
  }

  /// Whether the topic is in the bag. Then `take` will be called with each of its messages and its receive time [s]. Throws
  /// Error where the topic has another type, or another definition of it.
  template <class Message>
  bool use(const std::string& topic, const std::function<void(const Message&, double)>& take) {
    if (!has(topic)) return false;
    checkType(topic, typeOf<Message>(), ros::message_traits::MD5Sum<Message>::value());
    // Lengths inside are checked before anything is made that they ask for.
    const auto layout = std::make_shared<polyfly::MessageLayout>(
        typeOf<Message>(), ros::message_traits::Definition<Message>::value());
    handlers_[topic] = [this, topic, layout, take](const HeldMessage& held) {
      if (!layout->fits(held.bytes.data(), held.bytes.size())) {
        ++misfits_[topic];
        return;
      }
      Message message;
      // The stream reads only, through a pointer that is not const.
      ros::serialization::IStream stream(const_cast<std::uint8_t*>(held.bytes.data()),
                                         static_cast<std::uint32_t>(held.bytes.size()));
      ros::serialization::deserialize(stream, message);
      take(message, held.time);
    };
    return true;
  }

  /// As use; throws Error naming `option` where the topic is not in the bag.
  template <class Message>
  void require(const std::string& topic, const std::string& option,
               const std::function<void(const Message&, double)>& take) {
    if (use<Message>(topic, take)) return;
    std::string names;
    for (const std::string& name : topicsOf<Message>()) names += (names.empty() ? "" : ", ") + name;
    missing(topic,
            names.empty() ? "" : "; " + typeOf<Message>() + " is on " + names + ": choose with " + option);
  }

  /// Throws the Error that no message of the topic is there.
  [[noreturn]] void missing(const std::string& topic, const std::string& hint = "") const;

  /// Hands over all held messages of the topics in use. An Error of a receiver gets the file and the topic.
  void read();

  /// Of the topics in use. Messages that do not fit their definition were not read.
  polyfly::RecordingShare share() const;

  /// Receive times of the parts that are known to be lost [s].
  std::vector<polyfly::TimeSpan> lost() const;

  /// Every irregularity of the file, as clauses without its name. Complete after `read`.
  std::vector<std::string> remarks() const;

  /// The irregularities of the file behind an error's sentence.
  std::string remarkText() const;

 private:
  // A message as it stands in the bag, until all of them can be put in order.
  struct HeldMessage {
    std::string topic;
    // Receive time of the recorder [s].
    double time = 0.0;
    std::vector<std::uint8_t> bytes;
  };

  std::vector<std::string> fileRemarks() const;
  void leaveRepeatsOut();
  void checkType(const std::string& topic, const std::string& type, const std::string& md5sum) const;

  std::vector<std::string> paths_;
  // The first one, for messages.
  std::string path_;
  // Of each file.
  std::vector<polyfly::BagHealth> healths_;
  // The vehicle's namespace, with slashes on both sides.
  std::string prefix_ = "/";
  std::map<std::string, std::string> types_;
  // Checksums by topic.
  std::map<std::string, std::set<std::string>> definitions_;
  std::vector<HeldMessage> held_;
  // Number of misfits by topic.
  std::map<std::string, std::size_t> misfits_;
  // Number of messages that are recorded again, by topic.
  std::map<std::string, std::size_t> repeated_;
  std::map<std::string, std::function<void(const HeldMessage&)>> handlers_;
};

}  // namespace polyfly_ros
