#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>

#include <functional>
#include <string>

#include "polyfly_base/options_text.hpp"

namespace polyfly_ros {

/// Tells the parameters in force as YAML: by the latched topic `parameters_in_force` of a node's private namespace. The group `in_force` of the text says of which node they are and what changed last. Its
/// functions are to run in one thread, and not in one that controls.
class ParametersInForce {
 public:
  /// Writes all parameters, and what else is in force below `in_force`.
  using Write = std::function<void(polyfly::OptionsText&)>;
  /// Whether changes have taken effect.
  using Settled = std::function<bool()>;

  /// `vehicle`: multirotor or fixed_wing.
  ParametersInForce(
      const ros::NodeHandle& private_handle, std::string vehicle, Write write,
      Settled settled = [] { return true; });

  /// To be called when something has changed; `cause` is a word or two.
  void hasChanged(const std::string& cause);
  /// Publishes the text if something has changed and all changes have taken effect.
  void publish();

 private:
  std::string node_;
  std::string vehicle_;
  Write write_;
  Settled settled_;
  // Causes since the last text, separated by commas; empty: none.
  std::string causes_ = "start";
  ros::Publisher publisher_;
};

}  // namespace polyfly_ros
