#pragma once

#include <nav_msgs/Odometry.h>
#include <online_controller/SelectLaw.h>
#include <ros/ros.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "online_controller/realtime/poll_window.hpp"
#include "online_controller/types/options.hpp"
#include "online_controller_ros/background.hpp"
#include "online_controller_ros/callback_thread.hpp"
#include "online_controller_ros/command_output.hpp"
#include "online_controller_ros/direct_queue.hpp"
#include "online_controller_ros/flight_interface.hpp"
#include "online_controller_ros/flight_reporter.hpp"
#include "online_controller_ros/flight_snapshot.hpp"
#include "online_controller_ros/law_keeper.hpp"
#include "online_controller_ros/law_setup.hpp"
#include "online_controller_ros/topic_rehearsal.hpp"
#include "online_controller_ros/vigil.hpp"
#include "polyfly_base/time_source.hpp"
#include "polyfly_ros/parameter_reader.hpp"

namespace polyfly_ros {

/// What the node needs beyond the controller's own options.
struct NodeOptions {
  int stale_periods = 10;  ///< control periods without odometry after which it counts as silent
};

template <class Options, class Visit>
void visitNodeOptions(Options& options, Visit&& visit) {
  visit("controller/stale_periods", options.stale_periods, "control periods", polyfly::Range{2.0, 10000.0});
}

/// Who is in the process beside the controller.
enum class Household {
  kShared,  ///< other nodelets, which may publish odometry
  kAlone,   ///< nobody: odometry comes over connections only
};

/// The controller on ROS topics, explicit unless another law is chosen: odometry and references in, attitude
/// commands and status out. Topics and parameters are listed in online_controller/README.md. It has two
/// threads of its own: one for control, and one for all that control must not wait for. Odometry of the same
/// process is answered in the thread that publishes it, where the baton is free, and that of another, where
/// the controller is alone in its own, in the one that reads the connection; the control thread does the rest
/// (IN_FLIGHT.md).
class ExplicitMpcNode {
 public:
  /// Reads the parameters, opens the maps, connects. Logs one fatal sentence and throws polyfly::Error when
  /// the parameters or a map are not fit to fly. `names`: under which options can be changed besides ours.
  ExplicitMpcNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                  const ForeignNames& names = {}, Household household = Household::kShared);

 private:
  struct Setup {
    LawSetup laws;
    FlightSetup flight;
    NodeOptions node;
    OutputOptions output;
    RealTimeOptions real_time;
    bool in_publisher = true;  // odometry is answered where it comes from
    bool alone = false;        // in the process
  };

  /// Who brings odometry, and where.
  struct Publisher {
    pid_t thread = 0;
    int core = -1;
  };

  static Setup readSetup(const ros::NodeHandle& private_handle, const ForeignNames& names,
                         Household household);
  ExplicitMpcNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                  const ForeignNames& names, const Setup& setup);
  void connect();
  void startWatchdog();

  using OdometryEvent = ros::MessageEvent<const nav_msgs::Odometry>;
  void onOdometry(const OdometryEvent& event);
  void answer(const nav_msgs::Odometry& message);
  polyfly::PollWindow::Clock::time_point arrivalOfThis();
  void onFollowUp();
  void onManual(const ros::Time& now);
  void onWatchdog();
  void onWallTime();
  void tellOfClock();
  bool onSelectLaw(online_controller::SelectLaw::Request& request,
                   online_controller::SelectLaw::Response& response);
  void publishLaw();

  Answered& remember(const polyfly::ControlReport& report, const std_msgs::Header& header,
                     const StageTimes& times);
  void finish();
  void prepare();
  double sleep(double most);
  void rehearse();
  void rehearseWith(const nav_msgs::Odometry& like);
  void followPublisher();
  void exchangeLaws();
  void countLost(const ros::Time& stamp);
  polyfly::LawSwitch& laws() { return keeper_.flight(); }

  // All that follows is guarded by the baton, which the control thread and those who publish odometry share.
  polyfly::Baton baton_;
  WatchedQueue queue_;   // of the control thread; outlives all that is served on it
  DirectQueue at_once_;  // of odometry that is answered where it is published
  PublishedHere published_here_;
  nav_msgs::Odometry::ConstPtr left_;  // for the control thread to answer
  ros::NodeHandle handle_;
  LawKeeper keeper_;
  polyfly::TimeSource time_;
  polyfly::FlightSupervisor flight_;
  FlightInterface interface_;
  CommandOutput output_;
  FlightRecord record_;
  FlightReporter reporter_;
  AnsweredList answered_;
  bool in_publisher_;
  bool alone_;
  double control_period_;  // [s]
  polyfly::PollWindow poll_;
  polyfly::PollWindow::Clock::time_point served_at_;  // the last odometry
  std::optional<TopicRehearsal> topics_;              // of rehearsals of the whole way
  std::optional<Vigil> vigil_;                        // between a rehearsal and its odometry
  Publisher publisher_;    // of the last odometry that was answered where it was published
  pid_t followed_ = 0;     // below whose priority the control thread shall be
  int core_ = -1;          // where it is kept; -1: anywhere
  bool follows_core_;      // while it rehearses, it shall be kept where the publisher runs
  bool follows_priority_;  // it shall have a priority just below that of the publisher
  double silence_;         // longer than this without odometry is silence [s]

  ros::Publisher law_publisher_;
  ros::ServiceServer law_service_;
  ros::Subscriber odometry_subscriber_;
  // roscpp takes a lock of its timers after each callback: not with the baton in one's hands.
  WatchedQueue timer_queue_;
  ros::Timer watchdog_;
  ros::SteadyTimer wall_watchdog_;                            // where time is simulated
  ros::CallbackInterfacePtr watchdog_task_, wall_time_task_;  // of the control thread
  std::atomic<bool> watchdog_waits_{false}, wall_time_waits_{false};

  bool has_odometry_ = false;
  bool told_of_wall_time_ = false;
  ros::Time arrival_;          // of the last odometry
  std::string frame_;          // of the last odometry
  double odometry_age_ = 0.0;  // at its arrival [s]
  ros::Time last_stamp_;       // of the last odometry
  std::uint32_t sequence_ = 0;

  // These end first.
  std::optional<CallbackThread> timer_thread_;
  std::optional<Background> background_;
  std::optional<CallbackThread> control_thread_;
};

}  // namespace polyfly_ros
