#include "online_controller/types/options.hpp"

#include <sstream>

#include "online_controller/types/flight_options.hpp"
#include "online_controller/types/moment_model.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/range_check.hpp"

namespace polyfly {
void checkOptions(const MultirotorOptions& options) {
  visitOptions(options, RangeCheck{});
  if (!(options.thrust_min < options.gravity && options.gravity < options.thrust_max)) {
    std::ostringstream text;
    text
        << "controller/thrust_min, controller/thrust_max: vehicle/gravity (hover) must lie between them, got "
        << options.thrust_min << " and " << options.thrust_max << " m/s^2";
    throw Error(text.str());
  }
}

void checkMomentModel(const MomentModel& moments) { visitMomentModel(moments, RangeCheck{}); }

void checkFlightOptions(const FlightOptions& options) { visitFlightOptions(options, RangeCheck{}); }

}  // namespace polyfly
