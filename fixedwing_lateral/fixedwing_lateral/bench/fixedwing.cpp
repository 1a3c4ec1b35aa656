// Times the real-time iteration along a closed loop: a box pattern with the chapter's weights. CPU time of
// the thread, iteration by iteration; prints rows as JSON.
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <vector>

#include "fixedwing_lateral/lateral_nmpc.hpp"

namespace {

using namespace polyfly;

constexpr int kCalls = 8000;
constexpr int kFlights = 5;
constexpr double kPeriod = 0.05;  // [s]

double cpuMicroseconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

/// A square of lines, flown round and round.
class Box {
 public:
  explicit Box(double side) : corners_{{0.0, 0.0}, {side, 0.0}, {side, side}, {0.0, side}} {}

  void fill(HorizonData& data) const {
    data.current = side(leg_);
    data.next = side(leg_ + 1);
    data.conditions.gate = SwitchGate(data.current);
  }
  bool advance(const HorizonData& data, const LateralState& state) {
    const Eigen::Vector2d velocity = groundVelocity(data.conditions, state[LateralIndex::kHeading]);
    if (!data.conditions.gate.isMet(state.head<2>(), velocity)) return false;
    leg_ = (leg_ + 1) % 4;
    return true;
  }

 private:
  LineSegment side(int leg) const { return {corners_[leg % 4], corners_[(leg + 1) % 4]}; }

  std::vector<Eigen::Vector2d> corners_;
  int leg_ = 0;
};

struct Times {
  std::vector<double> whole, preparation, feedback;
};

Times fly(int horizon) {
  const LateralModel model;
  LateralNmpc nmpc(model, {horizon, 0.1}, "bench");
  Box box(250.0);
  HorizonData data;
  data.conditions.wind = {3.0, -4.0};
  box.fill(data);
  LateralState state = LateralState::Zero();
  state[LateralIndex::kEast] = 20.0;
  nmpc.reset(data, state, 0.0);
  Times times;
  for (int i = 0; i < kCalls; ++i) {
    if (box.advance(data, state)) {
      box.fill(data);
      nmpc.clearSwitch();
    }
    const double start = cpuMicroseconds();
    nmpc.keepAsPrevious(kPeriod / 0.1);
    nmpc.prepare(data);
    const double prepared = cpuMicroseconds();
    nmpc.feedback(state);
    const double end = cpuMicroseconds();
    times.preparation.push_back(prepared - start);
    times.feedback.push_back(end - prepared);
    times.whole.push_back(end - start);
    state = integrate(model, data.conditions, state, {nmpc.moves()[1], kPeriod});
    state[LateralIndex::kSwitch] = 0.0;
  }
  return times;
}

/// Element by element, of the flights.
std::vector<double> medians(const std::vector<Times>& flights, std::vector<double> Times::*part) {
  std::vector<double> result(kCalls);
  std::vector<double> same(flights.size());
  for (int i = 0; i < kCalls; ++i) {
    for (std::size_t f = 0; f < flights.size(); ++f) same[f] = (flights[f].*part)[i];
    std::nth_element(same.begin(), same.begin() + kFlights / 2, same.end());
    result[i] = same[kFlights / 2];
  }
  return result;
}

Times flyAgainAndAgain(int horizon) {
  std::vector<Times> flights;
  for (int i = 0; i < kFlights; ++i) flights.push_back(fly(horizon));
  return {medians(flights, &Times::whole), medians(flights, &Times::preparation),
          medians(flights, &Times::feedback)};
}

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

void print(bool first, const std::string& name, double value, const char* unit, const char* more = "") {
  std::printf("%s{\"name\": \"fixed wing: %s\", \"value\": %.4g, \"unit\": \"%s\"%s}", first ? "[" : ",\n ",
              name.c_str(), value, unit, more);
}

/// What there is to reach: a number that must not be exceeded.
std::string mark(double value, double most) {
  char text[80];
  std::snprintf(text, sizeof text, ", \"mark\": %.3g, \"reached\": %s", most,
                value <= most ? "true" : "false");
  return text;
}

}  // namespace

int main() {
  // Warm-up run.
  fly(40);
  bool first = true;
  for (const int horizon : {20, 40, 60, 80, 100, 200}) {
    const Times times = flyAgainAndAgain(horizon);
    const std::string name = "iteration, N = " + std::to_string(horizon);
    const double median = quantile(times.whole, 0.5);
    const bool published = horizon == 40;
    const char* peer = ", \"peer\": \"acados, full condensing (noted elsewhere)\", \"peer_value\": 74";
    print(first, name + ", median", median, "us", published ? (peer + mark(median, 40.0)).c_str() : "");
    first = false;
    if (published) {
      const double feedback = quantile(times.feedback, 0.5);
      const double late = quantile(times.whole, 0.99) / median;
      print(false, name + ", 99 %", quantile(times.whole, 0.99), "us");
      print(false, name + ", 99 % by median", late, "", mark(late, 2.0).c_str());
      print(false, name + ", preparation, median", quantile(times.preparation, 0.5), "us");
      print(false, name + ", feedback, median", feedback, "us", mark(feedback, 8.0).c_str());
      print(false, name + ", feedback, 99 %", quantile(times.feedback, 0.99), "us");
    }
  }
  std::printf("]\n");
  return 0;
}
