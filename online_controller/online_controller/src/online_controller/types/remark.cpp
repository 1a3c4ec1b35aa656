#include "online_controller/types/remark.hpp"

#include <iomanip>
#include <sstream>

namespace polyfly {
namespace {

constexpr const char* kSwings =
    "the commanded tilt swings from side to side by more than the reference needs: calibrate gain, lag "
    "and delay of the attitude loops, or raise the law's command weights";
constexpr const char* kHowRemoved =
    " is not removed: controller/robust_estimate_time above 0 removes it, but while that estimate "
    "settles the promise of recursive feasibility does not hold";
constexpr const char* kAxes[] = {"x", "y", "z"};

}  // namespace

std::string remarkOn(const ControlReport& report) {
  std::ostringstream text;
  if (report.swings) text << kSwings;
  if (report.force_left.isZero(0.0)) return text.str();
  text << (report.swings ? "; " : "") << std::fixed << std::setprecision(2) << "a constant force of";
  const char* before = " ";
  for (int i = 0; i < 3; ++i) {
    if (report.force_left[i] == 0.0) continue;
    text << before << report.force_left[i] << " N along " << kAxes[i];
    before = ", ";
  }
  text << kHowRemoved;
  return text.str();
}

}  // namespace polyfly
