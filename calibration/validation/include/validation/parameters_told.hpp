#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "online_controller/types/options.hpp"
#include "validation/flight_log.hpp"
#include "validation/replay.hpp"

namespace polyfly {

/// What a node told of its parameters in a flight, see polyfly_ros/parameters_in_force.hpp. Times count from the first
/// odometry [s].
struct ParametersTold {
  /// The problem that an axis flew, and its map where the law looks its command up.
  struct Axis {
    /// Name of the map; empty without one.
    std::string map;
    /// Checksum of the map's file, as `offline_mpt info` tells it; empty without one.
    std::string map_checksum;
    /// Checksum of the text of the problem; empty where the model is made of the options.
    std::string problem;
    /// Calibrations that the problem's numbers are from; empty: none.
    std::string calibration;
  };

  /// Parameters that were told anew while commands were sent.
  struct Change {
    double time = 0.0;  ///< [s]
    /// What changed them: reconfigure, region maps, law.
    std::string cause;
    /// "key: before -> after", of each parameter.
    std::vector<std::string> parameters;
    /// Whether the replay depends on one of them.
    bool bears_on_replay = false;
  };

  std::string node;
  /// Version of the controller; empty: it did not tell, as before 0.3.0.
  std::string version;
  std::string law;
  /// Where numbers of the options come from; empty: nobody said.
  std::string provenance;
  /// Longitudinal, lateral, vertical.
  std::array<Axis, 3> axes;
  std::vector<Change> changes;
  /// The text that was in force when the first command was sent; `rosparam load` reads it.
  std::string text;
};

/// None where nothing was recorded. Throws Error when a text is no YAML of a node.
std::optional<ParametersTold> parametersTold(const FlightLog& log);

/// Whether another version flew. False where nobody told parameters.
bool isOfOtherVersion(const FlightLog& log);

/// The options of the controller in such a text. Throws Error naming key and rule.
MultirotorOptions optionsInForce(const ParametersTold& told);

/// Where what was told contradicts the maps and options that the flight is judged by, in sentences.
std::vector<std::string> parameterWarnings(const ParametersTold& told, const AxisMaps& maps,
                                           const MultirotorOptions& options);

}  // namespace polyfly
