#include "online_controller/types/options.hpp"

#include <sstream>
#include <string>

#include "online_controller/types/flight_options.hpp"
#include "online_controller/types/moment_model.hpp"
#include "region_maps/error.hpp"

namespace polyfly {
namespace {

struct CheckRange {
  void operator()(const char* key, double value, const char* unit, const Range& range) const {
    // Written so that NaN fails.
    if (value >= range.least && value <= range.greatest) return;
    std::ostringstream text;
    text << key << ": must lie in [" << range.least << ", " << range.greatest << "] " << unit << ", got "
         << value;
    throw Error(text.str());
  }
  void operator()(const char*, bool) const {}
};

}  // namespace

void checkOptions(const MultirotorOptions& options) {
  visitOptions(options, CheckRange{});
  if (!(options.thrust_min < options.gravity && options.gravity < options.thrust_max)) {
    std::ostringstream text;
    text
        << "controller/thrust_min, controller/thrust_max: vehicle/gravity (hover) must lie between them, got "
        << options.thrust_min << " and " << options.thrust_max << " m/s^2";
    throw Error(text.str());
  }
}

void checkMomentModel(const MomentModel& moments) { visitMomentModel(moments, CheckRange{}); }

void checkFlightOptions(const FlightOptions& options) { visitFlightOptions(options, CheckRange{}); }

}  // namespace polyfly
