#include "program/unbounded_cost.hpp"

#include <algorithm>
#include <cmath>

#include "lp/polytope.hpp"
#include "mpc_core/decompositions.hpp"
#include "polyfly_base/error.hpp"
#include "program/slater_point.hpp"
#include "program/tolerances.hpp"

namespace polyfly {
namespace {

// Directions that the search for a start cuts off at most.
constexpr int kMostCuts = 300;
// Number of parameters up to which all corners of their box are tested.
constexpr int kMostCorners = 10;
// A quick search tests 2^6 corners at most.
constexpr int kQuickBits = 6;
// A quick search gives up after this number of harmless directions. Each costs a linear program.
constexpr std::size_t kQuickHarmless = 8;
// Odd, so that its multiples take all values of their low bits.
constexpr std::uint64_t kSpread = 0x9E3779B97F4A7C15;

/// `program` for those t alone where sign * affine(t) >= 0.
void restrictParameters(ParametricProgram& program, const NormalisedProgram& reduced,
                        const Eigen::RowVectorXd& affine, double sign) {
  const Eigen::Index k = program.A_theta.rows(), p = reduced.p;
  const Eigen::RowVectorXd slope = sign * affine.head(p).cwiseQuotient(reduced.half.transpose());
  program.A_theta.conservativeResize(k + 1, p);
  program.b_theta.conservativeResize(k + 1);
  program.A_theta.row(k) = -slope;
  program.b_theta(k) = sign * affine(p) - slope.dot(reduced.centre);
}

/// A parameter inside, if there is an interior.
std::optional<Eigen::VectorXd> inside(ParametricProgram program) {
  try {
    const SlaterPoint margin = findSlaterPoint(program);
    if (margin.feasible) return margin.t;
  } catch (const Error&) {  // a lower-dimensional set
  }
  return std::nullopt;
}

}  // namespace

UnboundedCost::UnboundedCost(const ParametricProgram& program, const NormalisedProgram& reduced)
    : program_(program), reduced_(reduced) {
  if (!reduced.linear) return;
  size_ = reduced.cost.size() > 0 ? reduced.cost.cwiseAbs().maxCoeff() : 0.0;
  if (reduced.n == 0 || size_ == 0.0) return;
  qp_.emplace(Eigen::MatrixXd::Identity(reduced.n, reduced.n), reduced.M);
}

std::optional<Eigen::VectorXd> UnboundedCost::direction(const Eigen::VectorXd& t) {
  if (!qp_) return std::nullopt;
  Eigen::VectorXd t1(reduced_.p + 1);
  t1 << t, 1.0;
  const Eigen::VectorXd slope = reduced_.cost * t1 / size_;
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(reduced_.m);
  if (qp_->solve(slope.data(), zero.data()) != QpStatus::kOptimal) return std::nullopt;
  const double length = qp_->z().norm();
  if (length <= tolerance::kLevelCost) return std::nullopt;
  Eigen::VectorXd direction = qp_->z() / length;
  // Where it is short, it is a difference of numbers that nearly cancel: once more onto the rows it runs
  // along.
  if (qp_->activeCount() > 0) {
    Eigen::MatrixXd along(reduced_.n, qp_->activeCount());
    for (int k = 0; k < qp_->activeCount(); ++k)
      along.col(k) = reduced_.M.row(qp_->activeRows()[k]).transpose();
    direction -= along * PivotedQr(along).solve(direction);
    direction.normalize();
  }
  const bool open = reduced_.m == 0 || (reduced_.M * direction).maxCoeff() <= tolerance::kOpenDirection;
  if (!open || slope.dot(direction) >= -tolerance::kLevelCost) return std::nullopt;
  return direction;
}

std::optional<Eigen::VectorXd> UnboundedCost::start(const Eigen::VectorXd& t) {
  ParametricProgram bounded = program_;
  std::optional<Eigen::VectorXd> inner = t;
  for (int k = 0; inner && k < kMostCuts; ++k) {
    const std::optional<Eigen::VectorXd> falling = direction(*inner);
    if (!falling) return inner;
    if (!first_) {
      first_ = deepest(*falling);
      if (!first_) first_ = inner;
    }
    restrictParameters(bounded, reduced_, falling->transpose() * reduced_.cost / size_, 1.0);
    inner = inside(bounded);
  }
  return inner;
}

// The parameter with solutions at which the cost falls most along the direction, and its rows have slack.
std::optional<Eigen::VectorXd> UnboundedCost::deepest(const Eigen::VectorXd& direction) const {
  ParametricProgram falling = program_;
  restrictParameters(falling, reduced_, direction.transpose() * reduced_.cost / size_, -1.0);
  return inside(std::move(falling));
}

// What falls at no corner of a box falls nowhere in it.
bool UnboundedCost::testCorners(std::optional<Eigen::VectorXd>& found) {
  if (reduced_.p > kMostCorners) return true;
  bool falls = false;
  const std::uint64_t corners = std::uint64_t{1} << reduced_.p;
  for (std::uint64_t corner = 0; !found && corner < corners; ++corner)
    falls = testCorner(corner, found) || falls;
  return falls;
}

// Whether the cost falls at a corner; each parameter has a bit of its number.
bool UnboundedCost::testCorner(std::uint64_t corner, std::optional<Eigen::VectorXd>& found) {
  constexpr int kBits = 64;
  Eigen::VectorXd t(reduced_.p);
  for (int j = 0; j < reduced_.p; ++j) t(j) = (corner >> (j % kBits) & 1u) != 0 ? 1.0 : -1.0;
  if (!direction(t)) return false;
  found = test(t);
  return true;
}

// Whether the cost falls at t along a direction that some feasible parameter shares.
std::optional<Eigen::VectorXd> UnboundedCost::test(const Eigen::VectorXd& t) {
  Eigen::VectorXd t1(reduced_.p + 1);
  t1 << t, 1.0;
  const Eigen::VectorXd cost = reduced_.cost * t1 / size_;
  for (const Eigen::VectorXd& known : harmless_) {
    if (cost.dot(known) < -tolerance::kLevelCost) return std::nullopt;  // t itself has no solution
  }
  const std::optional<Eigen::VectorXd> falling = direction(t);
  if (!falling) return std::nullopt;
  std::optional<Eigen::VectorXd> found = deepest(*falling);
  if (!found) harmless_.push_back(*falling);
  return found;
}

std::optional<Eigen::VectorXd> UnboundedCost::behind(const CriticalRegion& region) {
  const int p = reduced_.p;
  std::vector<double> rows;
  const Eigen::VectorXd bound = region.g - region.G * reduced_.centre;
  for (Eigen::Index f = 0; f < region.G.rows(); ++f) {
    for (int j = 0; j < p; ++j) rows.push_back(region.G(f, j) * reduced_.half(j));
    rows.push_back(bound(f));
  }
  const Eigen::VectorXd centre = (region.centre - reduced_.centre).cwiseQuotient(reduced_.half);
  PolytopeSolver solver(p);
  MinimalRows minimal;
  if (!solver.minimal(rows.data(), static_cast<int>(region.G.rows()), centre.data(), tolerance::kDomainEdge,
                      minimal))
    return std::nullopt;
  for (std::size_t k = 0; k < minimal.facets.size(); ++k) {
    const double* row = rows.data() + static_cast<std::size_t>(minimal.facets[k]) * (p + 1);
    const Eigen::Map<const Eigen::VectorXd> normal(row, p);
    const Eigen::Map<const Eigen::VectorXd> beyond(minimal.beyond.data() + k * p, p);
    const double inner = row[p] - normal.dot(centre), outer = normal.dot(beyond) - row[p];
    const Eigen::VectorXd foot = centre + inner / (inner + outer) * (beyond - centre);
    for (const double step : tolerance::kStepsAcross) {
      const Eigen::VectorXd t = foot + step * normal;
      // Points beyond the box are left out: the facet lies on its edge.
      if (t.cwiseAbs().maxCoeff() > 1.0 + tolerance::kDomainEdge) continue;
      if (std::optional<Eigen::VectorXd> found = test(t)) return found;
    }
  }
  return std::nullopt;
}

std::optional<Eigen::VectorXd> UnboundedCost::witness(const std::vector<CriticalRegion>& regions,
                                                      const std::atomic<bool>* stop) {
  if (first_) return first_;
  std::optional<Eigen::VectorXd> found;
  if (!qp_ || !testCorners(found)) return std::nullopt;
  for (std::size_t k = 0; !found && !cut_short_ && k < regions.size(); ++k) {
    found = behind(regions[k]);
    cut_short_ = !found && stop != nullptr && stop->load();
  }
  return found;
}

std::optional<Eigen::VectorXd> UnboundedCost::quickWitness() {
  if (first_) return first_;
  std::optional<Eigen::VectorXd> found;
  const std::uint64_t corners = std::uint64_t{1} << std::min(reduced_.p, kQuickBits);
  for (std::uint64_t k = 0; qp_ && !found && k < corners && harmless_.size() < kQuickHarmless; ++k)
    testCorner(k * kSpread, found);
  return found;
}

}  // namespace polyfly
