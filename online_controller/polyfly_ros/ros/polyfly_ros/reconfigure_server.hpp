#pragma once

#include <dynamic_reconfigure/Config.h>
#include <dynamic_reconfigure/ConfigDescription.h>
#include <dynamic_reconfigure/Reconfigure.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/service_server.h>

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "polyfly_ros/option_table.hpp"

namespace polyfly_ros {

/// dynamic_reconfigure for an OptionTable: the service and the two topics that rqt_reconfigure and dynparam talk to.
/// Unlike the library's own server it tells all about changes later, with those together that came meanwhile. To
/// write parameters to the master takes milliseconds. While a message is serialised, no other thread of the process
/// can publish.
class ReconfigureServer {
 public:
  /// Applies the values that the table holds; throws polyfly::Error to refuse them.
  using Apply = std::function<void()>;
  /// Serves on the queue of `private_handle`.
  ReconfigureServer(const ros::NodeHandle& private_handle, OptionTable& table, Apply apply);

  /// To be called when something else has changed the values.
  void hasChanged() noexcept { told_ = false; }
  /// Publishes the values, if they changed since the last call.
  void publish();
  /// Writes the parameters that changed since the last call.
  void writeParameters();

 private:
  bool onRequest(dynamic_reconfigure::Reconfigure::Request& request,
                 dynamic_reconfigure::Reconfigure::Response& response);
  void take(const dynamic_reconfigure::Config& wanted, const std::vector<double>& before);
  void take(const std::string& name, double value, const std::vector<double>& before);
  void take(const OptionTable::Alias& alias, double value);
  void change(const OptionTable::Option& option, double value);
  dynamic_reconfigure::ConfigDescription description() const;
  dynamic_reconfigure::Config config(const std::function<double(const OptionTable::Option&)>& value) const;
  dynamic_reconfigure::Config current() const;

  ros::NodeHandle handle_;
  OptionTable& table_;
  Apply apply_;
  // Parameters that are not written to the master yet.
  std::set<std::string> changed_;
  // True when the values were published since they changed.
  bool told_ = false;
  ros::Publisher description_publisher_;
  ros::Publisher update_publisher_;
  ros::ServiceServer service_;
};

}  // namespace polyfly_ros
