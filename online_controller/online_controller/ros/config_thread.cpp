#include "online_controller_ros/config_thread.hpp"

#include <ros/ros.h>

#include <algorithm>

#include "mpc_core/calibration_provenance.hpp"
#include "online_controller/laws/axis.hpp"
#include "online_controller_ros/map_swap.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/provenance.hpp"

namespace polyfly_ros {
namespace {

constexpr double kTick = 0.05;  // [s]
// Number of ticks between two writes of changed parameters to the master.
constexpr int kTicksPerWrite = 20;
// Time after which a swap is said to wait for a control period [s].
constexpr double kSwapTimeout = 1.0;
// Time between two looks at a swap that is pending [s].
constexpr double kSwapInterval = 0.002;

/// Every weight, limit and gain; not what the memory of the laws depends on.
OptionTable tableOf(polyfly::MultirotorParameters& parameters, const LegacyNames& names) {
  OptionTable table({"controller/control_period", "nonlinear/horizon", "nonlinear/period"});
  polyfly::visitOptions(parameters.controller, table);
  polyfly::visitLinearTuning(parameters.linear, table);
  polyfly::visitNonlinearOptions(parameters.nonlinear, table);
  polyfly::visitMomentModel(parameters.moments, table);
  for (const LegacyName& name : names) table.alias(name);
  return table;
}

std::string joined(const std::array<std::string, 3>& paths) {
  return paths[0] + ", " + paths[1] + ", " + paths[2];
}

std::vector<std::vector<double>> rowsOf(const Eigen::MatrixXd& matrix) {
  std::vector<std::vector<double>> rows(static_cast<std::size_t>(matrix.rows()));
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    for (Eigen::Index column = 0; column < matrix.cols(); ++column)
      rows[static_cast<std::size_t>(row)].push_back(matrix(row, column));
  }
  return rows;
}

// The model x' = A x + B u, and the text that it is from, if it is not made from the options.
void writeProblem(const std::string& space, const polyfly::MpcProblem& problem, polyfly::OptionsText& text) {
  if (!problem.text.empty()) text.text(space + "/problem", polyfly::checksumOf(problem.text));
  const std::string calibrations = polyfly::calibrationsOf(problem.text);
  if (!calibrations.empty()) text.text(space + "/calibration", calibrations);
  text.matrix(space + "/A", rowsOf(problem.A_c));
  text.matrix(space + "/B", rowsOf(problem.B_c));
}

void writeMaps(const char* name, const polyfly::MapSet& set, polyfly::OptionsText& text) {
  for (std::size_t axis = 0; axis < set.maps.size(); ++axis) {
    const std::string space =
        std::string(polyfly::kInForceGroup) + "/" + name + "/" + polyfly::kAxisNames.at(axis).axis;
    const polyfly::RegionMap& map = set.maps[axis];
    text.text(space + "/name", std::string(map.name()));
    text.text(space + "/checksum", polyfly::hexDigits(map.checksum()));
    writeProblem(space, set.problems.at(axis), text);
  }
}

/// Writes what flies: `law` and the setup that is in force. Below `in_force`: the maps by name, checksum and problem, the
/// models, and the calibrations that these are from.
void writeInForce(const LawSetup& setup, polyfly::Law law, polyfly::OptionsText& text) {
  polyfly::MultirotorParameters now = setup.parameters;
  now.law = polyfly::lawName(law);
  const std::string space = polyfly::kInForceGroup;
  text.text(space + "/law", now.law);
  const std::vector<polyfly::LawType>& types = polyfly::lawTypes();
  for (std::size_t i = 0; i < types.size(); ++i) {
    if (types[i].maps != nullptr) writeMaps(types[i].maps, setup.sources->maps[i], text);
  }
  for (std::size_t axis = 0; axis < setup.sources->problems.size(); ++axis)
    writeProblem(space + "/linear/" + polyfly::kAxisNames.at(axis).axis, setup.sources->problems.at(axis),
                 text);
  polyfly::visitMultirotorParameters(now, text);
}

}  // namespace

ConfigThread::ConfigThread(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                           const LawSetup& setup, const LegacyNames& names, ActiveLaws& laws,
                           FlightRecord& record)
    : handle_(onQueue(handle, queue_)),
      private_handle_(onQueue(private_handle, queue_)),
      setup_(setup),
      laws_(laws),
      record_(record),
      table_(tableOf(setup_.parameters, names)),
      bounds_(table_.bounds()),
      reconfigure_(private_handle_, table_, [this] { apply(); }),
      law_(laws.active()),
      in_force_(
          private_handle_, "multirotor",
          [this](polyfly::OptionsText& text) { writeInForce(setup_, law_, text); },
          [this] { return !laws_.pending(); }),
      display_(handle_),
      diagnostics_(handle_, private_handle_, record, laws),
      swap_service_(handle_.advertiseService("swap_maps", &ConfigThread::onSwapMaps, this)),
      timer_(handle_.createSteadyTimer(ros::WallDuration(kTick),
                                       [this](const ros::SteadyTimerEvent&) { onTick(); })) {
  thread_.start();
}

void ConfigThread::apply() {
  if (record_.commands) bounds_.check(table_.values(), ros::SteadyTime::now().toSec());
  laws_.stage(setup_);
  noteInForce();
  in_force_.hasChanged("reconfigure");
}

void ConfigThread::noteInForce() {
  if (record_.commands) {
    bounds_.change(table_.values(), ros::SteadyTime::now().toSec());
  } else {
    bounds_.settle(table_.values());
  }
}

bool ConfigThread::onSwapMaps(online_controller::SwapMaps::Request& request,
                              online_controller::SwapMaps::Response& response) {
  std::array<double, 3> change{};
  try {
    const LawSetup next = withOtherMaps(setup_, request, snapshot(), change);
    // This throws before anything has changed.
    laws_.stage(next);
    // The option table keeps pointing into setup_.
    setup_ = next;
    noteInForce();
    response.success = 1;
    response.message =
        joined(setup_.parameters.maps.at(static_cast<std::size_t>(lawOfSwap(request)))) + waitForSwap();
    reconfigure_.hasChanged();
    in_force_.hasChanged("region maps");
    ROS_INFO("region maps: %s", response.message.c_str());
  } catch (const polyfly::Error& error) {
    response.success = 0;
    response.message = std::string(error.what()) + "; the maps in force stay";
    ROS_ERROR("region maps: %s", response.message.c_str());
  }
  std::copy(change.begin(), change.end(), response.change.begin());
  return true;
}

std::string ConfigThread::waitForSwap() const {
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(kSwapTimeout);
  while (laws_.pending() && ros::WallTime::now() < end) ros::WallDuration(kSwapInterval).sleep();
  return laws_.pending() ? " (from the next control period on; there is none at present)" : "";
}

// The control thread changes it, on the service select_law.
void ConfigThread::tellOfLaw() {
  const polyfly::Law law = laws_.active();
  if (law == law_) return;
  law_ = law;
  in_force_.hasChanged("law");
}

void ConfigThread::onTick() {
  laws_.reclaim();
  if (!record_.wanted.load(std::memory_order_acquire)) {
    snapshot_ = record_.snapshot;
    record_.show_paths.store(display_.isWatched(), std::memory_order_relaxed);
    record_.wanted.store(true, std::memory_order_release);
  }
  if (snapshot_) display_.show(*snapshot_);
  diagnostics_.update(snapshot());
  reconfigure_.publish();
  tellOfLaw();
  in_force_.publish();
  if (++ticks_ % kTicksPerWrite == 0) reconfigure_.writeParameters();
}

}  // namespace polyfly_ros
