#include "polyfly_base/change_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr double kRounding = 1e-9;  // relative

/// What may follow `base`, within the option's range.
Range around(double base, const Range& range) {
  const double less = base / range.factor, more = base * range.factor;
  const double slack = range.step + kRounding * std::abs(more);
  return {std::max(range.least, std::min(less, more) - slack),
          std::min(range.greatest, std::max(less, more) + slack)};
}

}  // namespace

ChangeBounds::ChangeBounds(std::vector<Option> options, const std::vector<double>& values)
    : options_(std::move(options)), past_(options_.size()) {
  settle(values);
}

double ChangeBounds::base(const Past& past, double now) noexcept {
  const bool rested = !past.changed || now - past.last_change >= kRest;
  return rested ? past.value : past.base;
}

void ChangeBounds::check(const std::vector<double>& wanted, double now) const {
  for (std::size_t i = 0; i < options_.size(); ++i) {
    if (wanted[i] == past_[i].value) continue;
    const double from = base(past_[i], now);
    const Range allowed = around(from, options_[i].range);
    // Written so that NaN fails.
    if (wanted[i] >= allowed.least && wanted[i] <= allowed.greatest) continue;
    std::ostringstream text;
    text << options_[i].name << ": while commands are sent it may go from " << from << " to at least "
         << allowed.least << " and at most " << allowed.greatest << " " << options_[i].unit << " within "
         << kRest << " s, got " << wanted[i];
    throw Error(text.str());
  }
}

void ChangeBounds::change(const std::vector<double>& values, double now) {
  for (std::size_t i = 0; i < options_.size(); ++i) {
    Past& past = past_[i];
    if (values[i] == past.value) continue;
    past = {base(past, now), values[i], true, now};
  }
}

void ChangeBounds::settle(const std::vector<double>& values) {
  for (std::size_t i = 0; i < options_.size(); ++i) past_[i] = {values[i], values[i], false, 0.0};
}

}  // namespace polyfly
