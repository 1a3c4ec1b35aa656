#include "validation_ros/topic_reader.hpp"

#include <mav_msgs/RollPitchYawrateThrust.h>

#include <algorithm>
#include <deque>

#include "polyfly_base/read_text.hpp"

namespace polyfly_ros {
namespace {

// Longest time in which a message is recorded again [s].
constexpr double kLatestRepeat = 1.0;

}  // namespace

using polyfly::Error;

void TopicReader::findNamespace(const std::string& name_space, const std::string& command) {
  prefix_ = "/" + name_space + "/";
  if (name_space.empty()) {
    std::vector<std::string> found;
    for (const std::string& topic : topicsOf<mav_msgs::RollPitchYawrateThrust>()) {
      if (polyfly::endsWith(topic, "/" + command))
        found.push_back(topic.substr(0, topic.size() - command.size()));
    }
    if (found.size() > 1) {
      std::string names;
      for (const std::string& name : found) names += " " + name;
      throw Error(path_ + ": holds commands of several vehicles, in the namespaces" + names +
                  ": choose one with --namespace");
    }
    prefix_ = found.empty() ? "/" : found.front();
  }
  while (prefix_.find("//") != std::string::npos) prefix_.erase(prefix_.find("//"), 1);
}

void TopicReader::scan(const std::vector<std::string>& names, const BagProgress& progress) {
  polyfly::BagVisitor visitor;
  visitor.progress = progress;
  visitor.wants = [&](const polyfly::BagConnection& connection) {
    types_[connection.topic] = connection.type;
    definitions_[connection.topic].insert(connection.md5sum);
    return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
      return polyfly::endsWith("/" + connection.topic, name);
    });
  };
  visitor.message = [this](const polyfly::BagMessage& message) {
    held_.push_back({message.connection->topic, message.time(), {message.data, message.data + message.size}});
  };
  for (const std::string& path : paths_) healths_.push_back(polyfly::scanBag(path, visitor));
  std::stable_sort(held_.begin(), held_.end(),
                   [](const HeldMessage& one, const HeldMessage& other) { return one.time < other.time; });
  leaveRepeatsOut();
  if (types_.empty()) throw Error(path_ + ": holds no message" + remarkText());
}

// A publisher numbers its messages, so no two of them are the same. A second recorder may be late.
void TopicReader::leaveRepeatsOut() {
  std::vector<HeldMessage> once;
  once.reserve(held_.size());
  // Places of each topic's messages of the last second.
  std::map<std::string, std::deque<std::size_t>> before;
  for (HeldMessage& held : held_) {
    std::deque<std::size_t>& places = before[held.topic];
    while (!places.empty() && held.time - once[places.front()].time > kLatestRepeat) places.pop_front();
    const bool is_repeat = std::any_of(places.begin(), places.end(),
                                       [&](std::size_t place) { return once[place].bytes == held.bytes; });
    if (is_repeat) {
      ++repeated_[held.topic];
      continue;
    }
    places.push_back(once.size());
    once.push_back(std::move(held));
  }
  held_ = std::move(once);
}

void TopicReader::checkType(const std::string& topic, const std::string& type,
                            const std::string& md5sum) const {
  const std::string& found = types_.at(topic);
  if (found != type) throw Error(path_ + ": topic " + topic + ": must be " + type + ", is " + found);
  for (const std::string& recorded : definitions_.at(topic)) {
    if (recorded != md5sum)
      throw Error(path_ + ": topic " + topic + ": recorded with another definition of " + type);
  }
}

void TopicReader::missing(const std::string& topic, const std::string& hint) const {
  std::string known;
  for (const auto& [name, type] : types_) known += (known.empty() ? "" : ", ") + name;
  throw Error(path_ + ": no message on " + topic + "; the bag has " + known + hint + remarkText());
}

void TopicReader::read() {
  for (HeldMessage& held : held_) {
    const auto handler = handlers_.find(held.topic);
    if (handler == handlers_.end()) continue;
    try {
      handler->second(held);
    } catch (const Error& error) {
      throw Error(path_ + ": topic " + held.topic + ": " + error.what());
    }
    held.bytes = {};
  }
}

polyfly::RecordingShare TopicReader::share() const {
  std::set<std::string> topics;
  for (const auto& [topic, handler] : handlers_) topics.insert(topic);
  polyfly::RecordingShare share = polyfly::recordingShare(healths_.front(), topics);
  for (std::size_t piece = 1; piece < healths_.size(); ++piece) {
    share = polyfly::together(share, polyfly::recordingShare(healths_[piece], topics),
                              healths_[piece].first - healths_.front().first);
  }
  for (const auto& [topic, count] : misfits_) share.messages.read -= static_cast<double>(count);
  return share;
}

std::vector<polyfly::TimeSpan> TopicReader::lost() const {
  std::vector<polyfly::TimeSpan> lost;
  for (const polyfly::BagHealth& health : healths_)
    lost.insert(lost.end(), health.lost.begin(), health.lost.end());
  return lost;
}

std::vector<std::string> TopicReader::fileRemarks() const {
  std::vector<std::string> remarks = healths_.front().remarks;
  for (std::size_t piece = 1; piece < paths_.size(); ++piece) {
    remarks.push_back("the recording was split and goes on in " + paths_[piece]);
    for (const std::string& remark : healths_[piece].remarks)
      remarks.push_back(paths_[piece] + ": " + remark);
  }
  return remarks;
}

std::vector<std::string> TopicReader::remarks() const {
  std::vector<std::string> remarks = fileRemarks();
  for (const auto& [topic, count] : misfits_) {
    remarks.push_back("topic " + topic + ": " + std::to_string(count) +
                      " messages are not what their definition says and were left out");
  }
  for (const auto& [topic, count] : repeated_)
    remarks.push_back("topic " + topic + ": " + std::to_string(count) +
                      " messages are recorded again; each counts once");
  return remarks;
}

std::string TopicReader::remarkText() const {
  std::string text;
  for (const std::string& remark : fileRemarks()) text += "; " + remark;
  return text;
}

}  // namespace polyfly_ros
