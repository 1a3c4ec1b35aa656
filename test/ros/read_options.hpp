#pragma once

#include <ros/ros.h>

#include <Eigen/Core>
#include <set>
#include <string>
#include <vector>

#include "online_controller/types/options.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly_ros {

/// Visitor of an options list: reads each field from the parameter server where it is given, and refuses keys
/// that the list does not have. Ranges are checked by the library that takes the options.
class OptionsReader {
 public:
  OptionsReader(const ros::NodeHandle& private_nh, const std::string& group) : nh_(private_nh, group) {}

  void operator()(const char* key, double& field, const char*, const polyfly::Range&) {
    if (given(key) && !nh_.getParam(key, field)) {
      refuse(key, "must be a number");
    }
  }

  void operator()(const char* key, int& field, const char*, const polyfly::Range&) {
    if (given(key) && !nh_.getParam(key, field)) {
      refuse(key, "must be a whole number");
    }
  }

  void operator()(const char* key, Eigen::Vector3d& field, const char*, const polyfly::Range&) {
    std::vector<double> value;
    if (!given(key)) {
      return;
    }
    if (!nh_.getParam(key, value) || value.size() != 3) {
      refuse(key, "must be a list of three numbers");
    }
    field = Eigen::Vector3d(value[0], value[1], value[2]);
  }

  /// After the list was visited: throws Error when the group holds any other key.
  void refuseUnknown() const {
    std::vector<std::string> names;
    ros::param::getParamNames(names);
    const std::string prefix = nh_.getNamespace() + "/";
    for (const std::string& name : names) {
      if (name.compare(0, prefix.size(), prefix) == 0 && keys_.count(name.substr(prefix.size())) == 0) {
        throw polyfly::Error(name + ": unknown parameter");
      }
    }
  }

 private:
  // Notes the key; whether the parameter server has it.
  bool given(const char* key) {
    keys_.insert(key);
    return nh_.hasParam(key);
  }

  [[noreturn]] void refuse(const char* key, const char* rule) const {
    throw polyfly::Error(nh_.resolveName(key) + ": " + rule);
  }

  ros::NodeHandle nh_;
  std::set<std::string> keys_;
};

/// Throws Error naming the parameter when a plain private parameter is out of its range.
inline double readNumber(const ros::NodeHandle& nh, const std::string& key, double fallback, double least,
                         double greatest) {
  double value = fallback;
  if (nh.hasParam(key) && !nh.getParam(key, value)) {
    throw polyfly::Error(nh.resolveName(key) + ": must be a number");
  }
  if (!(value >= least && value <= greatest)) {
    throw polyfly::Error(nh.resolveName(key) + ": must lie in [" + std::to_string(least) + ", " +
                         std::to_string(greatest) + "], got " + std::to_string(value));
  }
  return value;
}

}  // namespace polyfly_ros
