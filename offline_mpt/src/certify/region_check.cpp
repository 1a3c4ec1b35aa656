#include "certify/region_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "arithmetic/exact_numbers.hpp"
#include "certify/facet_cover.hpp"
#include "certify/slivers.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

// Keys of lines of the certificate.
constexpr char kFollows[] = "follows";
constexpr char kLeftOut[] = "left_out";
constexpr std::size_t kMostKept = 30000;  // regions up to which exact rows are kept: some kB for each

/// Greatest difference in the box between the map's row and a multiple of the exact one, and between the
/// length of the map's row and one.
Rational rowDifference(const std::vector<Rational>& mapped, const ExactRow& row) {
  const std::size_t p = mapped.size() - 1;
  std::size_t k = 0;
  Rational squared;
  for (std::size_t j = 0; j < p; ++j) {
    if (abs(mapped[j]) > abs(mapped[k])) k = j;
    squared += mapped[j] * mapped[j];
  }
  Rational difference = abs(squared - 1) / 2;
  const Rational factor = mapped[k] / row.value[k];
  for (std::size_t j = 0; j <= p; ++j) difference += abs(mapped[j] - factor * row.value[j]);
  return difference;
}

double roundedDistance(const std::vector<double>& unit, const ExactRow& row) {
  if (row.length == 0.0) return std::numeric_limits<double>::infinity();
  double distance = 0.0;
  for (std::size_t j = 0; j < unit.size(); ++j)
    distance = std::max(distance, std::abs(unit[j] - row.unit[j]));
  return distance;
}

std::string shortText(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

std::string describeOrigin(const ExactOrigin& origin) {
  switch (origin.kind) {
    case ExactOrigin::Kind::kMultiplier:
      return "the multiplier of row " + std::to_string(origin.index);
    case ExactOrigin::Kind::kCostMultiplier:
      return "the cost multiplier of row " + std::to_string(origin.index);
    case ExactOrigin::Kind::kSlack:
      return "the slack of row " + std::to_string(origin.index);
    case ExactOrigin::Kind::kDomain:
      return "row " + std::to_string(origin.index) + " of A_theta";
    case ExactOrigin::Kind::kBox:
      return "side " + std::to_string(origin.index) + " of the box";
    case ExactOrigin::Kind::kExcess:
      return "minus the slack of equality " + std::to_string(origin.index);
  }
  return "";
}

void compareLaw(const CheckContext& context, const RegionView& view, const ExactRegion& exact,
                std::uint32_t index, RegionCheck& check) {
  const ExactProgram& program = context.program;
  const double* law = context.map.law(view.law);
  Rational worst;
  for (int i = 0; i < program.q; ++i) {
    const double* row = law + static_cast<std::ptrdiff_t>(i) * (program.p + 1);
    const Rational* wanted = exact.law.data() + static_cast<std::ptrdiff_t>(i) * (program.p + 1);
    const std::vector<Rational> written = program.inBox(row, row[program.p]);
    Rational difference = program.roundingOf(row, 1);
    for (int j = 0; j <= program.p; ++j) difference += abs(written[static_cast<std::size_t>(j)] - wanted[j]);
    difference /= context.lawScale(static_cast<std::size_t>(i), row);
    worst = std::max(worst, difference);
  }
  check.law_error = above(worst);
  if (worst <= Rational(context.options.law_tolerance)) return;
  Defect defect = regionDefect(Defect::Kind::kLaw, index, -1,
                               "u differs from the exact law by up to " + shortText(check.law_error));
  defect.size = check.law_error;
  check.defects.push_back(std::move(defect));
}

/// Slack of a row at t where `active` is, in units of the row.
double slackAt(const ExactProgram& program, const std::vector<int>& active, int row,
               const std::vector<Rational>& t) {
  ExactSolution solution;
  if (solution.solve(program, active) != ExactStatus::kRegion) return 0.0;
  const std::vector<Integer> slack = solution.slack(program, row);
  Rational value(slack.back());
  for (std::size_t j = 0; j < t.size(); ++j) value += slack[j] * t[j];
  value /= solution.denominator();
  const long exponent = program.shift + program.row_exponent[static_cast<std::size_t>(row)];
  return std::ldexp(value.get_d(), static_cast<int>(-exponent));
}

/// What a region that holds the witness, `outside` of the half-space, gets wrong. Of a slack its value counts: its
/// half-space may be far away where the slack is next to nothing.
std::string describeUnlisted(const ExactProgram& program, const RegionCheck& check, const ExactOrigin& origin,
                             const std::vector<Rational>& witness, double outside) {
  const std::string text = "holds parameters where " + describeOrigin(origin) + " is negative";
  if (origin.kind == ExactOrigin::Kind::kSlack && !witness.empty())
    return text + ", down to " + shortText(slackAt(program, check.active, origin.index, witness));
  return text + ", up to a distance of " + shortText(outside) + " (scaled) from its half-space";
}

/// Whether the listed rows imply `row`, with the line of the certificate that says so; `key` starts it.
/// A row that holds in the whole box needs no line, but one that is left out is named.
Implication proveRow(const std::vector<ExactRow>& listed, std::size_t count, const ExactRow& row,
                     const std::string& key, FloatLp& solver, std::string& text) {
  std::vector<const ExactRow*> known;
  for (std::size_t k = 0; k < count; ++k) known.push_back(&listed[k]);
  Implication result = implies(known, row, solver);
  if (!result.holds || (result.proof.weights.empty() && key != kLeftOut)) return result;
  text += key + " " + originText(row.origin) + " " + result.proof.scale.get_str(16);
  appendWeights(result.proof, text);
  text += "\n";
  return result;
}

/// Proves that the listed rows imply all others. Conditions that they imply but for the plane tolerance join
/// the list; those that they do not imply at all are defects.
void proveRows(const CheckContext& context, std::uint32_t index, const ExactRegion& exact,
               RegionCheck& check) {
  const std::size_t own = check.listed.size();
  FloatLp solver(context.program.p);
  const auto prove = [&](const ExactRow& row, const std::string& key) {
    const auto is_row = [&](const ExactRow& other) { return other.origin == row.origin; };
    if (std::any_of(check.listed.begin(), check.listed.end(), is_row)) return;
    const Implication result = proveRow(check.listed, check.listed.size(), row, key, solver, check.text);
    if (result.holds) {
      ++check.implied;
      return;
    }
    const ExactRow relaxed = relaxedRow(row, Rational(context.options.plane_tolerance));
    if (key == kFollows && !check.is_sliver &&
        proveRow(check.listed, own, relaxed, kLeftOut, solver, check.text).holds) {
      check.listed.push_back(row);
      ++check.left_out;
      return;
    }
    for (const ExactRow& forgiven : exact.forgiven) {
      if (!(forgiven.origin == row.origin) || key != kFollows) continue;
      const std::string marked = "tolerated " + originText(row.origin) + "\n";
      if (!proveRow(check.listed, own, forgiven, "tolerated_follows", solver, check.text).holds) break;
      check.text += marked;
      ++check.forgiven;
      return;
    }
    double outside = -row.unit.back();
    for (std::size_t j = 0; j < result.witness.size(); ++j)
      outside += row.unit[j] * result.witness[j].get_d();
    Defect defect =
        regionDefect(Defect::Kind::kUnlisted, index, -1,
                     describeUnlisted(context.program, check, row.origin, result.witness, outside));
    defect.size = outside;
    defect.witness = context.program.theta(result.witness);
    check.defects.push_back(std::move(defect));
  };
  for (const ExactRow& row : exact.rows) prove(row, kFollows);
  for (const ExactRow& row : exact.dropped) prove(row, "dropped_follows");
}

void findFacets(const ExactRegion& exact, RegionCheck& check) {
  for (const ExactRow& row : check.listed) {
    CheckedFacet facet{row.origin, {}};
    for (const ExactRow& other : exact.rows) {
      if (other.origin == row.origin || roundedDistance(other.unit, row) > 1e-6) continue;
      if (sameHalfSpace(other, row)) facet.same.push_back(other.origin);
    }
    check.facets.push_back(std::move(facet));
  }
  for (const ExactRow& row : exact.rows) {
    const bool idle =
        std::all_of(row.value.begin(), row.value.end(), [](const Integer& value) { return value == 0; });
    if (idle && row.origin.kind == ExactOrigin::Kind::kSlack) check.idle.push_back(row.origin.index);
  }
}

void findPoint(const CheckContext& context, std::uint32_t index, RegionCheck& check) {
  std::vector<const ExactRow*> rows;
  for (const ExactRow& row : check.listed) rows.push_back(&row);
  Interior interior = findInterior(rows, nullptr, context.program.p);
  if (!interior.exists) {
    Defect defect = regionDefect(Defect::Kind::kLowerDimensional, index, -1,
                                 "has no interior (radius " + shortText(interior.radius) + ", scaled)");
    defect.size = interior.radius;
    check.defects.push_back(std::move(defect));
    return;
  }
  check.point = std::move(interior.point);
  check.text += "inside";
  for (const Rational& value : check.point) check.text += " " + value.get_str(16);
  check.text += "\n";
}

/// check_certificate takes each half-space once.
void refuseRepeatedRows(std::uint32_t index, RegionCheck& check) {
  for (std::size_t row = 1; row < check.listed.size(); ++row) {
    const auto here = check.listed.begin() + static_cast<std::ptrdiff_t>(row);
    const auto is_same = [&](const ExactRow& other) { return other.value == here->value; };
    if (std::none_of(check.listed.begin(), here, is_same)) continue;
    check.defects.push_back(regionDefect(Defect::Kind::kPlane, index, static_cast<int>(row),
                                         "is the same half-space as an earlier row"));
  }
}

}  // namespace

Defect regionDefect(Defect::Kind kind, std::uint32_t region, int row, const std::string& text) {
  Defect defect;
  defect.kind = kind;
  defect.region = region;
  defect.row = row;
  defect.text =
      "region " + std::to_string(region) + (row >= 0 ? ", row " + std::to_string(row) : "") + ": " + text;
  return defect;
}

std::string originText(const ExactOrigin& origin) {
  constexpr char kLetters[] = {'m', 'p', 's', 'd', 'b', 'x'};
  return kLetters[static_cast<std::size_t>(origin.kind)] + std::to_string(origin.index);
}

std::vector<Rational> toScaled(const ExactProgram& program, const Eigen::VectorXd& theta) {
  std::vector<Rational> t;
  for (std::size_t j = 0; j < program.half.size(); ++j)
    t.push_back((Rational(theta(static_cast<Eigen::Index>(j))) - program.centre[j]) / program.half[j]);
  return t;
}

std::vector<Rational> mapRow(const CheckContext& context, const RegionView& region, std::uint32_t row) {
  const std::int32_t reference = region.rows[row];
  const double* plane = context.map.plane(static_cast<std::size_t>(std::abs(reference)) - 1);
  return context.program.inside(plane, reference > 0 ? 1 : -1);
}

std::vector<ExactRow> matchRows(const CheckContext& context, const RegionView& region,
                                const ExactRegion& exact, double& error, int& worst) {
  const int p = context.program.p;
  std::vector<ExactRow> sides;
  for (int k = 0; k < 2 * p; ++k) sides.push_back(boxRow(p, k));
  std::vector<ExactRow> matched;
  error = 0.0;
  worst = -1;
  for (std::uint32_t f = 0; f < region.row_count; ++f) {
    const std::vector<Rational> mapped = mapRow(context, region, f);
    std::vector<double> unit;
    for (int j = 0; j <= p; ++j) unit.push_back(j < p ? -mapped[j].get_d() : mapped[j].get_d());
    const ExactRow* best = &sides.front();
    double least = std::numeric_limits<double>::infinity();
    for (const std::vector<ExactRow>* group : {&std::as_const(sides), &exact.rows}) {
      for (const ExactRow& row : *group) {
        const double distance = roundedDistance(unit, row);
        if (distance >= least) continue;
        least = distance;
        best = &row;
      }
    }
    const auto largest =
        std::max_element(mapped.begin(), mapped.end() - 1,
                         [](const Rational& a, const Rational& b) { return abs(a) < abs(b); });
    const Integer& partner = best->value[static_cast<std::size_t>(largest - mapped.begin())];
    const double difference = sgn(*largest) * sgn(partner) > 0 ? above(rowDifference(mapped, *best))
                                                               : std::numeric_limits<double>::infinity();
    if (difference > error) {
      error = difference;
      worst = static_cast<int>(f);
    }
    matched.push_back(*best);
  }
  return matched;
}

std::vector<int> mapActiveSet(const CheckContext& context, const RegionView& region, bool& valid) {
  std::vector<int> active;
  valid = true;
  for (std::uint32_t k = 0; k < region.active_count; ++k) {
    const std::int32_t row = region.active[k];
    const bool is_there = row >= 0 && row < context.program.m;
    if (is_there && (context.program.in_basis[row] != 0 || context.program.is_equality[row] != 0)) continue;
    if (!is_there || context.program.is_dropped[row] != 0) {
      valid = false;
      return {};
    }
    active.push_back(row);
  }
  std::sort(active.begin(), active.end());
  valid = std::adjacent_find(active.begin(), active.end()) == active.end();
  return active;
}

std::vector<ExactRow> mapRows(const CheckContext& context, const std::vector<RegionCheck>& checks,
                              std::uint32_t region) {
  const RegionCheck& check = checks[region];
  if (check.listed.empty()) {
    ExactRegion exact;
    describeExactly(context.program, check.active, exact);
    double error = 0.0;
    int worst = -1;
    return matchRows(context, context.map.region(region), exact, error, worst);
  }
  return {check.listed.begin(), check.listed.end() - static_cast<std::ptrdiff_t>(check.left_out)};
}

std::vector<ExactRow> listedRows(const CheckContext& context, const std::vector<RegionCheck>& checks,
                                 std::uint32_t region) {
  const RegionCheck& check = checks[region];
  if (!check.listed.empty()) return check.listed;
  std::vector<ExactRow> rows = mapRows(context, checks, region);
  ExactRegion exact;
  if (check.left_out > 0) describeExactly(context.program, check.active, exact);
  for (std::size_t k = check.facets.size() - check.left_out; k < check.facets.size(); ++k) {
    for (const ExactRow& row : exact.rows) {
      if (row.origin == check.facets[k].origin) rows.push_back(row);
    }
  }
  return rows;
}

void finishCheck(const CheckContext& context, std::uint32_t index, const ExactRegion& exact,
                 RegionCheck& check) {
  proveRows(context, index, exact, check);
  findFacets(exact, check);
  findPoint(context, index, check);
}

RegionCheck checkRegion(const CheckContext& context, std::uint32_t index) {
  RegionCheck check;
  const RegionView view = context.map.region(index);
  bool valid = false;
  check.active = mapActiveSet(context, view, valid);
  ExactRegion exact;
  const ExactStatus status =
      valid ? describeExactly(context.program, check.active, exact) : ExactStatus::kDependent;
  if (status != ExactStatus::kRegion) {
    const char* reason = !valid ? "its active set names rows that the program has not"
                         : status == ExactStatus::kDependent ? "its active rows are linearly dependent"
                         : status == ExactStatus::kCostNotSpanned
                             ? "the cost is not in the span of its active rows"
                             : "an equality does not hold in it";
    check.defects.push_back(regionDefect(Defect::Kind::kActiveSet, index, -1, reason));
    return check;
  }
  check.described = true;
  check.rows = exact.rows.size();
  compareLaw(context, view, exact, index, check);
  int worst = -1;
  check.listed = matchRows(context, view, exact, check.plane_error, worst);
  if (!(check.plane_error <= context.options.plane_tolerance)) {
    Defect defect =
        regionDefect(Defect::Kind::kPlane, index, worst,
                     "no condition of optimality lies within the tolerance of its plane: the nearest "
                     "differs by " +
                         shortText(check.plane_error));
    defect.size = check.plane_error;
    check.defects.push_back(std::move(defect));
  }
  refuseRepeatedRows(index, check);
  finishCheck(context, index, exact, check);
  if (context.map.regionCount() > kMostKept) check.listed = {};
  return check;
}

}  // namespace polyfly
