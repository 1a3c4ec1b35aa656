#include "polyfly_test/robust_campaign.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "mpc_core/mpc_problem.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "polyfly_base/read_text.hpp"
#include "region_maps/write_map.hpp"
#include "robust_mpc/robust_law.hpp"

namespace polyfly_test {
namespace {

using Eigen::Vector3d;
using polyfly::RegionMap;

constexpr double kBounds = 1e-9;     // rounding of state bounds and promises
constexpr double kStart = 1.5;       // [m]
constexpr double kLead = 0.4;        // how far ahead kWorst looks [s]
constexpr double kSwitching = 0.08;  // share of steps at which kTelegraph changes

std::unique_ptr<RegionMap> solve(const polyfly::RobustProblem& problem, const std::string& path) {
  const polyfly::RobustProgram program = polyfly::buildRobustProgram(problem);
  const polyfly::FeasibleSet set = polyfly::projectFeasibleSet(program);
  const polyfly::RoundedLaw law =
      polyfly::roundLaw(problem, polyfly::explicitLaw(problem, set), polyfly::ExploreStatus::kComplete);
  polyfly::writeMap(polyfly::encode(law.program, law.partition), path);
  return std::make_unique<RegionMap>(RegionMap::open(path));
}

/// The nominal linear MPC of the same model (Eq. 38 without state bounds, which no disturbance would
/// respect), with the weights of the tie-break.
std::unique_ptr<RegionMap> solveNominal(const std::string& path) {
  const polyfly::ParametricProgram program = polyfly::condense(polyfly::parseProblem(R"(polyfly_problem: 1
name: nominal_lateral
type: tracking_mpc
model:
  states: [{name: p_y, unit: m}, {name: v_y, unit: m/s}, {name: phi, unit: rad}]
  inputs: [{name: phi_cmd, unit: rad, range: [-0.35, 0.35]}]
  A: [[0, 1, 0], [0, -0.01, -9.81], [0, 0, -5]]
  B: [[0], [0], [4.5]]
  C: [[1, 0, 0]]
sampling_time: 0.08
horizon: 20
weights: {Q: [40, 20, 10], R: [35]}
parameters:
  - {name: e_p_y, role: error, of: p_y, unit: m, range: [-8, 8]}
  - {name: e_v_y, role: error, of: v_y, unit: m/s, range: [-6, 6]}
  - {name: e_phi, role: error, of: phi, unit: rad, range: [-0.6, 0.6]}
)",
                                                                                     "nominal"));
  polyfly::writeMap(polyfly::encode(program, polyfly::explore(program, {})), path);
  return std::make_unique<RegionMap>(RegionMap::open(path));
}

double uniformOf(std::mt19937_64& engine) { return static_cast<double>(engine() >> 11U) * 0x1p-53; }

}  // namespace

RobustCampaign::RobustCampaign(const std::string& problem_file, const std::string& folder) {
  const polyfly::RobustProblem problem = polyfly::loadRobustProblem(problem_file);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) A_(i, j) = polyfly::nearestDouble(problem.A(i, j));
    B_[i] = polyfly::nearestDouble(problem.B(i, 0));
    G_[i] = polyfly::nearestDouble(problem.G(i, 0));
    K_[i] = polyfly::nearestDouble(problem.tie_gain(0, i));
    const auto& range = problem.state_ranges[static_cast<std::size_t>(i)];
    range_[i] = range ? polyfly::nearestDouble(range->upper) : std::numeric_limits<double>::infinity();
  }
  input_range_ = problem.inputs[0].upper;
  map_ = solve(problem, folder + "robust.map");
  polyfly::RobustProblem with_peak = problem;
  with_peak.peak_in_map = true;
  peak_map_ = solve(with_peak, folder + "robust_peak.map");
  nominal_map_ = solveNominal(folder + "nominal.map");
  polyfly::MultirotorOptions options;
  options.offset_free = false;
  axis_ = std::make_unique<polyfly::Axis>(*map_, polyfly::kAxisNames[1], options);
}

void RobustCampaign::Result::add(const Result& other) {
  steps += other.steps;
  violations += other.violations;
  worst_violation = std::max(worst_violation, other.worst_violation);
  infeasible += other.infeasible;
  late_degraded += other.late_degraded;
  broken_promises += other.broken_promises;
  peak = std::max(peak, other.peak);
  peak_promised = std::max(peak_promised, other.peak_promised);
  greatest_speed = std::max(greatest_speed, other.greatest_speed);
  last_position = std::max(last_position, other.last_position);
  finite = finite && other.finite;
}

double RobustCampaign::promise(const Vector3d& x) const {
  std::array<double, 2> output{};
  const auto found = peak_map_->evaluate(x.data(), output.data());
  return found.status == polyfly::LookupStatus::kInside ? output[1] : std::numeric_limits<double>::infinity();
}

double RobustCampaign::command(Controller controller, const Vector3d& x, bool& degraded) const {
  degraded = false;
  double u = 0.0;
  switch (controller) {
    case Controller::kRobust: {
      polyfly::AxisReport report;
      const auto status = axis_->evaluate({x[0], x[1], x[2]}, {}, 0.0, 0.0, report);
      degraded = status != polyfly::ControlStatus::kOptimal;
      return report.input;
    }
    case Controller::kLqr:
      u = K_ * x;
      break;
    case Controller::kNominalMpc:
      if (nominal_map_->evaluate(x.data(), &u).status != polyfly::LookupStatus::kInside) u = K_ * x;
      break;
  }
  return std::clamp(u, -input_range_, input_range_);
}

double RobustCampaign::choose(const Options& options, double share, const Vector3d& x, double u,
                              double uniform, double& telegraph) const {
  switch (options.adversary) {
    case Adversary::kRandom:
      return share * (2.0 * uniform - 1.0);
    case Adversary::kTelegraph:
      if (uniform < kSwitching) telegraph = -telegraph;
      return share * telegraph;
    case Adversary::kWorst:
      return x[0] + kLead * x[1] >= 0.0 ? share : -share;
    case Adversary::kGreedy: {
      const Vector3d middle = A_ * x + B_ * u;
      const double up = promise(middle + share * G_), down = promise(middle - share * G_);
      if (up == down) return middle[0] >= 0.0 ? share : -share;
      return up > down ? share : -share;
    }
  }
  return 0.0;
}

RobustCampaign::Result RobustCampaign::fly(const Options& options) const {
  std::mt19937_64 engine(options.seed);
  Result result;
  for (int flight = 0; flight < options.flights; ++flight) {
    Vector3d x = Vector3d::Zero();
    while (!options.from_origin) {
      x[0] = kStart * (2.0 * uniformOf(engine) - 1.0);
      for (int i = 1; i < 3; ++i) x[i] = range_[i] * (2.0 * uniformOf(engine) - 1.0);
      if (std::isfinite(promise(x))) break;
    }
    double telegraph = 1.0;
    for (int step = 0; step < options.steps; ++step) {
      const double tau = promise(x);
      bool degraded = false;
      const double u = command(options.controller, x, degraded);
      const double share = 2 * step < options.steps ? options.share : options.late_share;
      const double w = choose(options, share, x, u, uniformOf(engine), telegraph);
      const bool late = 4 * step >= 3 * options.steps;
      x = A_ * x + B_ * u + w * G_;
      ++result.steps;
      if (degraded) ++result.infeasible;
      if (degraded && late) ++result.late_degraded;
      double violation = 0.0;
      for (int i = 1; i < 3; ++i) violation = std::max(violation, std::abs(x[i]) / range_[i] - 1.0);
      if (violation > kBounds) ++result.violations;
      result.worst_violation = std::max(result.worst_violation, violation);
      if (std::isfinite(tau)) {
        result.peak_promised = std::max(result.peak_promised, tau);
        if (std::abs(x[0]) > tau + kBounds) ++result.broken_promises;
      }
      result.peak = std::max(result.peak, std::abs(x[0]));
      result.greatest_speed = std::max(result.greatest_speed, std::abs(x[1]));
      if (late) result.last_position = std::max(result.last_position, std::abs(x[0]));
      result.finite = result.finite && x.allFinite();
    }
  }
  return result;
}

}  // namespace polyfly_test
