#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "polyfly_ros/parameter_reader.hpp"

namespace polyfly_ros {

/// Reads an options list below a group of private parameters, with vectors, and refuses keys that the list does not have.
class OptionsReader : public ParameterReader {
 public:
  OptionsReader(const ros::NodeHandle& private_nh, const std::string& group)
      : ParameterReader(ros::NodeHandle(private_nh, group)) {}

  using ParameterReader::operator();
  void operator()(const std::string& key, Eigen::Vector3d& field, const char*, const polyfly::Range&) {
    std::vector<double> value(field.data(), field.data() + field.size());
    (*this)(key, value);
    if (value.size() != 3) fail(root(), key, "must be a list of three numbers");
    field = Eigen::Vector3d(value[0], value[1], value[2]);
  }

  /// After the list was visited: throws Error when the group holds any other key.
  void refuseUnknown() const {
    for (const std::string& key : unread()) fail(root(), key, "unknown parameter");
  }
};

/// Throws Error naming the parameter when a plain private parameter is out of its range.
inline double readNumber(const ros::NodeHandle& nh, const std::string& key, double fallback, double least,
                         double greatest) {
  double value = fallback;
  ParameterReader reader(nh);
  reader(key, value, "", polyfly::Range{least, greatest});
  return value;
}

}  // namespace polyfly_ros
