#pragma once

#include <online_controller/LookupStatus.h>
#include <online_controller/SwapMap.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/service_server.h>
#include <ros/spinner.h>
#include <ros/steady_timer.h>
#include <ros/subscriber.h>

#include <memory>
#include <string>
#include <vector>

#include "online_controller/realtime/object_swap.hpp"
#include "polyfly_ros/guarded_queue.hpp"
#include "polyfly_ros/parameter_reader.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly_ros {

/// Any region map on topics: parameters in, inputs and `lookup_status` out. Topics and parameters are listed in
/// online_controller/LOOKUP.md. Each message with the first measured parameter is answered at once, and silence once in each
/// period. All callbacks must be served by one thread; another one opens the files that are swapped in.
class LookupNode {
 public:
  /// Reads parameters and map. Throws Error, after logging it.
  LookupNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle);

 private:
  using Places = std::vector<std::size_t>;

  void readSafeInputs(ParameterReader& reader);
  void bind(std::size_t parameter, const std::string& source);
  void connect(const ros::NodeHandle& handle);
  /// Takes what `numbers` makes of each message as the values of these parameters.
  template <class Message, class Numbers>
  void listen(const std::string& topic, const Places& parameters, const Numbers& numbers);
  void take(const Places& parameters, const std::vector<double>& values);
  void answer();
  void send(bool is_inside);
  bool onSwap(online_controller::SwapMap::Request& request, online_controller::SwapMap::Response& response);

  GuardedQueue queue_;
  ros::NodeHandle topics_;
  std::unique_ptr<polyfly::RegionMap> map_;
  polyfly::ObjectSwap<polyfly::RegionMap> next_;
  double stale_ = 0.0;  // [s]
  int hold_ = 3;        // periods
  // Of each parameter, the value and when it came.
  std::vector<double> theta_;
  std::vector<ros::SteadyTime> came_;
  // Parameters by source, and which numbers of odometry or which last inputs they are.
  Places by_topic_, by_array_, by_odometry_, by_input_, fields_, last_inputs_;
  // The first measured parameter.
  std::size_t first_ = 0;
  std::vector<double> inputs_, safe_;
  int missed_ = 0;  // periods without an answer
  bool has_answered_ = false;
  ros::SteadyTime answer_time_;
  online_controller::LookupStatus status_;
  std::vector<ros::Publisher> publishers_;
  ros::Publisher status_publisher_;
  std::vector<ros::Subscriber> subscribers_;
  ros::SteadyTimer timer_;

  // The thread that opens files: the map in force or staged last, and the parameters of the last answer.
  const polyfly::RegionMap* staged_ = nullptr;
  std::vector<double> seen_;
  ThreadQueue config_queue_;
  ros::Subscriber own_status_;
  ros::ServiceServer swap_service_;
  ros::AsyncSpinner config_thread_{1, &config_queue_};
};

}  // namespace polyfly_ros
