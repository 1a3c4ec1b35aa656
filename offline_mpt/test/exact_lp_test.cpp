// Exact linear programs against GLPK, and every answer against the proof that comes with it. Those in the box are proven
// by substitution alone.
#include "offline_mpt/exact_lp.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "glpk_lp.hpp"
#include "lp/box_maximum.hpp"
#include "lp/float_lp.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

using Bound = ExactLp::Bound;
using Status = ExactLp::Status;

/// The data of one program, to be given to both solvers.
struct Data {
  struct Line {
    Bound type = Bound::kFree;
    Rational lower, upper;
  };
  std::vector<Line> rows, columns;
  std::vector<std::vector<Rational>> A;
  std::vector<Rational> c;
  bool maximise = false;
};

ExactLp make(const Data& data) {
  ExactLp lp;
  lp.addRows(static_cast<int>(data.rows.size()));
  lp.addColumns(static_cast<int>(data.columns.size()));
  lp.setSense(data.maximise ? ExactLp::Sense::kMaximise : ExactLp::Sense::kMinimise);
  for (std::size_t i = 0; i < data.rows.size(); ++i)
    lp.setRowBounds(static_cast<int>(i), data.rows[i].type, data.rows[i].lower, data.rows[i].upper);
  for (std::size_t j = 0; j < data.columns.size(); ++j) {
    const int column = static_cast<int>(j);
    lp.setColumnBounds(column, data.columns[j].type, data.columns[j].lower, data.columns[j].upper);
    lp.setObjective(column, data.c[j]);
    for (std::size_t i = 0; i < data.rows.size(); ++i) {
      if (data.A[i][j] != 0) lp.setCoefficient(static_cast<int>(i), column, data.A[i][j]);
    }
  }
  return lp;
}

/// Status and objective by GLPK's simplex in rational arithmetic.
std::pair<Status, double> solveByGlpk(const Data& data) {
  const auto rangeOf = [](const Data::Line& line) {
    LpRange range;
    if (line.type != Bound::kFree && line.type != Bound::kUpper) range.lower = line.lower.get_d();
    if (line.type == Bound::kUpper || line.type == Bound::kDouble) range.upper = line.upper.get_d();
    if (line.type == Bound::kFixed) range.upper = range.lower;
    return range;
  };
  RangedLp lp;
  lp.maximise = data.maximise;
  lp.c.resize(static_cast<Eigen::Index>(data.columns.size()));
  lp.A.resize(static_cast<Eigen::Index>(data.rows.size()), lp.c.size());
  for (const Data::Line& row : data.rows) lp.rows.push_back(rangeOf(row));
  for (std::size_t j = 0; j < data.columns.size(); ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    lp.columns.push_back(rangeOf(data.columns[j]));
    lp.c(column) = data.c[j].get_d();
    for (std::size_t i = 0; i < data.rows.size(); ++i)
      lp.A(static_cast<Eigen::Index>(i), column) = data.A[i][j].get_d();
  }
  const LpAnswer answer = polyfly::solveByGlpk(lp, true);
  EXPECT_NE(answer.status, GLP_UNDEF);
  if (answer.status == GLP_OPT) return {Status::kOptimal, answer.objective};
  return {answer.status == GLP_UNBND ? Status::kUnbounded : Status::kInfeasible, 0.0};
}

bool within(const Data::Line& line, const Rational& value) {
  switch (line.type) {
    case Bound::kFree:
      return true;
    case Bound::kLower:
      return value >= line.lower;
    case Bound::kUpper:
      return value <= line.upper;
    case Bound::kDouble:
      return value >= line.lower && value <= line.upper;
    case Bound::kFixed:
      return value == line.lower;
  }
  return false;
}

/// Adds dual * bound for one line; fails where the dual's sign needs a bound that is not there.
void addBound(const Data::Line& line, const Rational& dual, Rational& sum) {
  if (dual == 0) return;
  const bool lower = dual > 0;
  const bool has_lower =
      line.type == Bound::kLower || line.type == Bound::kDouble || line.type == Bound::kFixed;
  const bool has_upper =
      line.type == Bound::kUpper || line.type == Bound::kDouble || line.type == Bound::kFixed;
  EXPECT_TRUE(lower ? has_lower : has_upper);
  sum += dual * (lower || line.type == Bound::kFixed ? line.lower : line.upper);
}

void checkFeasible(const Data& data, const ExactLp& lp) {
  for (std::size_t j = 0; j < data.columns.size(); ++j)
    EXPECT_TRUE(within(data.columns[j], lp.primal(static_cast<int>(j))));
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    Rational value;
    for (std::size_t j = 0; j < data.columns.size(); ++j)
      value += data.A[i][j] * lp.primal(static_cast<int>(j));
    EXPECT_EQ(value, lp.rowPrimal(static_cast<int>(i)));
    EXPECT_TRUE(within(data.rows[i], value));
  }
}

/// Substitutes the multipliers: their combination of rows and columns is c (optimal) or 0 (infeasible), and
/// the bounds then say that no objective is better, or that none exists.
void checkMultipliers(const Data& data, const ExactLp& lp) {
  const bool optimal = lp.status() == Status::kOptimal;
  const int sign = optimal && data.maximise ? -1 : 1;
  Rational sum;
  for (std::size_t j = 0; j < data.columns.size(); ++j) {
    const int column = static_cast<int>(j);
    const Rational own = optimal ? lp.columnDual(column) : lp.columnRay(column);
    Rational combination = own;
    for (std::size_t i = 0; i < data.rows.size(); ++i) {
      const int row = static_cast<int>(i);
      combination += data.A[i][j] * (optimal ? lp.rowDual(row) : lp.rowRay(row));
    }
    EXPECT_EQ(combination, optimal ? data.c[j] : Rational(0));
    addBound(data.columns[j], sign * own, sum);
  }
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    const int row = static_cast<int>(i);
    addBound(data.rows[i], sign * (optimal ? lp.rowDual(row) : lp.rowRay(row)), sum);
  }
  if (optimal) {
    EXPECT_EQ(sum, sign * lp.objective());
  } else {
    EXPECT_GT(sum, 0);
  }
}

void checkRay(const Data& data, const ExactLp& lp) {
  Rational gain;
  for (std::size_t j = 0; j < data.columns.size(); ++j) gain += data.c[j] * lp.primalRay(static_cast<int>(j));
  EXPECT_TRUE(data.maximise ? gain > 0 : gain < 0);
  const auto allowed = [](const Data::Line& line, const Rational& step) {
    const bool down = line.type == Bound::kFree || line.type == Bound::kUpper;
    const bool up = line.type == Bound::kFree || line.type == Bound::kLower;
    return step == 0 || (step > 0 ? up : down);
  };
  for (std::size_t j = 0; j < data.columns.size(); ++j)
    EXPECT_TRUE(allowed(data.columns[j], lp.primalRay(static_cast<int>(j))));
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    Rational step;
    for (std::size_t j = 0; j < data.columns.size(); ++j)
      step += data.A[i][j] * lp.primalRay(static_cast<int>(j));
    EXPECT_TRUE(allowed(data.rows[i], step));
  }
}

Status solveAndCheck(const Data& data) {
  ExactLp lp = make(data);
  const Status status = lp.solve();
  EXPECT_EQ(status, lp.status());
  if (status == Status::kInfeasible) {
    checkMultipliers(data, lp);
    return status;
  }
  checkFeasible(data, lp);
  if (status == Status::kOptimal) {
    checkMultipliers(data, lp);
  } else {
    checkRay(data, lp);
  }
  const auto [expected, objective] = solveByGlpk(data);
  EXPECT_EQ(status, expected);
  if (status == Status::kOptimal) {
    EXPECT_NEAR(lp.objective().get_d(), objective, 1e-8 * (1.0 + std::abs(objective)));
  }
  return status;
}

/// Small whole numbers make ties: degenerate vertices, parallel rows, several optima.
Data randomData(std::mt19937_64& random, bool degenerate) {
  const auto whole = [&](int low, int high) {
    return low + static_cast<int>(random() % static_cast<unsigned>(high - low + 1));
  };
  const auto number = [&] {
    return degenerate ? Rational(whole(-2, 2)) : Rational(whole(-1000, 1000), whole(1, 64));
  };
  const auto line = [&] {
    Data::Line result;
    result.type = static_cast<Bound>(whole(0, 4));
    result.lower = number();
    result.lower.canonicalize();
    result.upper = result.lower + whole(0, 5);
    return result;
  };
  Data data;
  data.maximise = random() % 2 == 0;
  data.columns.resize(static_cast<std::size_t>(whole(1, 6)));
  data.rows.resize(static_cast<std::size_t>(whole(1, 8)));
  for (Data::Line& column : data.columns) {
    column = line();
    data.c.push_back(number());
    data.c.back().canonicalize();
  }
  for (Data::Line& row : data.rows) {
    row = line();
    std::vector<Rational> entries;
    for (std::size_t j = 0; j < data.columns.size(); ++j) {
      entries.push_back(random() % 3 == 0 ? Rational(0) : number());
      entries.back().canonicalize();
    }
    data.A.push_back(std::move(entries));
  }
  return data;
}

TEST(ExactLp, RandomProgramsAgreeWithGlpkAndProveThemselves) {
  std::mt19937_64 random(7);
  int seen[4] = {};
  for (int k = 0; k < 600; ++k) {
    SCOPED_TRACE(k);
    ++seen[static_cast<int>(solveAndCheck(randomData(random, k % 2 == 0)))];
    if (::testing::Test::HasFailure()) break;
  }
  for (const Status status : {Status::kOptimal, Status::kInfeasible, Status::kUnbounded})
    EXPECT_GT(seen[static_cast<int>(status)], 50);
}

TEST(ExactLp, KeepsWhatDoublesLose) {
  // x <= 1 + 2^-200 and x >= 1 + 2^-201: feasible by a hair.
  ExactLp lp;
  lp.addColumns(1);
  lp.addRows(2);
  const Rational hair(mpz_class(1), mpz_class(1) << 200);
  lp.setColumnBounds(0, Bound::kFree, 0, 0);
  lp.setObjective(0, 1);
  lp.setCoefficient(0, 0, 1);
  lp.setCoefficient(1, 0, 1);
  lp.setRowBounds(0, Bound::kUpper, 0, 1 + hair);
  lp.setRowBounds(1, Bound::kLower, 1 + hair / 2, 0);
  ASSERT_EQ(lp.solve(), Status::kOptimal);
  EXPECT_EQ(lp.primal(0), 1 + hair / 2);
  lp.setRowBounds(1, Bound::kLower, 1 + 2 * hair, 0);
  EXPECT_EQ(lp.status(), Status::kUndefined);
  EXPECT_EQ(lp.solve(), Status::kInfeasible);
}

TEST(ExactLp, RowsBetweenTwoBoundsAndChangesOfCoefficients) {
  Data data;
  data.columns.assign(2, {Bound::kFree, 0, 0});
  data.rows = {{Bound::kDouble, -1, 3}, {Bound::kFixed, 2, 0}};
  data.A = {{1, 1}, {1, -1}};
  data.c = {1, 2};
  EXPECT_EQ(solveAndCheck(data), Status::kOptimal);
  ExactLp lp = make(data);
  lp.setCoefficient(1, 1, -3);
  lp.setCoefficient(1, 1, -1);  // overwritten, not added
  ASSERT_EQ(lp.solve(), Status::kOptimal);
  EXPECT_EQ(lp.primal(0), Rational(1, 2));
  EXPECT_EQ(lp.primal(1), Rational(-3, 2));
}

TEST(ExactLp, NothingToDo) {
  ExactLp lp;
  EXPECT_EQ(lp.solve(), Status::kOptimal);
  EXPECT_EQ(lp.objective(), 0);
  lp.addRows(1);
  lp.setRowBounds(0, Bound::kLower, 1, 0);
  EXPECT_EQ(lp.solve(), Status::kInfeasible);
  EXPECT_GT(lp.rowRay(0), 0);
}

using IntegerRows = std::vector<std::vector<Integer>>;

/// The point fits and has the objective. The weights prove that none is greater, or that no point fits.
void checkMaximum(const IntegerRows& rows, const std::vector<Integer>& c, const BoxMaximum& maximum) {
  const std::size_t dimension = c.size();
  const auto product = [&](const std::vector<Integer>& row) {
    Rational sum;
    for (std::size_t j = 0; j < dimension; ++j) sum += row[j] * maximum.x[j];
    return sum;
  };
  Rational bound;
  std::vector<Rational> rest(dimension);
  for (std::size_t j = 0; j < dimension && maximum.exists; ++j) rest[j] = c[j];
  for (const auto& [row, weight] : maximum.weights) {
    EXPECT_GT(weight, 0);
    const std::vector<Integer>& combined = rows.at(static_cast<std::size_t>(row));
    bound += weight * combined.back();
    for (std::size_t j = 0; j < dimension; ++j) rest[j] -= weight * combined[j];
  }
  for (const Rational& entry : rest) bound += abs(entry);  // by a side of the box
  if (!maximum.exists) {
    EXPECT_LT(bound, 0);
    return;
  }
  ASSERT_EQ(maximum.x.size(), dimension);
  EXPECT_EQ(bound, maximum.objective);
  EXPECT_EQ(product(c), maximum.objective);
  for (const std::vector<Integer>& row : rows) EXPECT_LE(product(row), row.back());
  for (const Rational& value : maximum.x) EXPECT_LE(abs(value), 1);
}

std::vector<double> rounded(const std::vector<Integer>& row) {
  std::vector<double> result;
  for (const Integer& value : row) result.push_back(value.get_d());
  return result;
}

FloatLp floatLp(const IntegerRows& rows, std::size_t dimension) {
  FloatLp solver(static_cast<int>(dimension));
  for (const std::vector<Integer>& row : rows) solver.add(rounded(row));
  return solver;
}

std::vector<int> proposedBasis(const IntegerRows& rows, const std::vector<Integer>& c) {
  FloatLp solver = floatLp(rows, c.size());
  solver.maximise(rounded(c));
  return solver.basis();
}

/// What solves in doubles has kernels for the dimensions of maps that are explored. Others may have more.
TEST(ExactLp, MaximaInManyDimensions) {
  std::mt19937_64 random(3);
  for (const std::size_t dimension : {12u, 14u, 20u}) {
    SCOPED_TRACE(dimension);
    const auto whole = [&](int most) {
      return Integer(static_cast<int>(random() % static_cast<unsigned>(2 * most + 1)) - most);
    };
    std::vector<Integer> c(dimension);
    for (Integer& value : c) value = whole(1000);
    IntegerRows rows(2 * dimension, std::vector<Integer>(dimension + 1));
    for (std::vector<Integer>& row : rows) {
      for (Integer& value : row) value = whole(1000);
      row.back() = 500 + abs(row.back());
    }
    rows.push_back(rows.front());  // one that nearly repeats another
    rows.back().front() += 1;
    const BoxMaximum maximum = maximiseInBox(rows, c, proposedBasis(rows, c));
    checkMaximum(rows, c, maximum);
    FloatLp solver = floatLp(rows, dimension);
    const FloatLp::Status status = solver.maximise(rounded(c));
    if (dimension > PolytopeSolver::kMaxDimension + 1) {
      EXPECT_EQ(status, FloatLp::Status::kFailed);
      continue;
    }
    ASSERT_EQ(status, FloatLp::Status::kOptimal);
    EXPECT_NEAR(solver.objective(), maximum.objective.get_d(), 1e-9 * std::abs(maximum.objective.get_d()));
  }
}

/// Ties as above. The basis of FloatLp mostly proves the maximum; others leave it to the exact simplex.
TEST(ExactLp, MaximaInTheBoxProveThemselvesFromAnyBasis) {
  std::mt19937_64 random(11);
  int seen[2] = {};
  for (int k = 0; k < 400 && !::testing::Test::HasFailure(); ++k) {
    SCOPED_TRACE(k);
    const int most = k % 2 == 0 ? 2 : 1000;
    const auto whole = [&] {
      return Integer(static_cast<int>(random() % static_cast<unsigned>(2 * most + 1)) - most);
    };
    const std::size_t dimension = 1 + random() % 4, count = random() % 8;
    std::vector<Integer> c(dimension);
    std::generate(c.begin(), c.end(), whole);
    IntegerRows rows(count, std::vector<Integer>(dimension + 1));
    for (std::vector<Integer>& row : rows) std::generate(row.begin(), row.end(), whole);
    std::vector<int> any(dimension);
    for (int& index : any) index = static_cast<int>(random() % (count + 2 * dimension));
    const BoxMaximum maximum = maximiseInBox(rows, c, proposedBasis(rows, c));
    checkMaximum(rows, c, maximum);
    ++seen[maximum.exists ? 1 : 0];
    for (const std::vector<int>& basis : {std::vector<int>(), any}) {
      const BoxMaximum other = maximiseInBox(rows, c, basis);
      checkMaximum(rows, c, other);
      EXPECT_EQ(other.exists, maximum.exists);
      EXPECT_EQ(other.objective, maximum.objective);
    }
  }
  EXPECT_GT(seen[0], 50);
  EXPECT_GT(seen[1], 50);
}

TEST(ExactLp, RefusesCrossedBounds) {
  ExactLp lp;
  lp.addRows(1);
  lp.addColumns(1);
  EXPECT_THROW(lp.setRowBounds(0, Bound::kDouble, 1, 0), Error);
  EXPECT_THROW(lp.setColumnBounds(0, Bound::kDouble, 1, 0), Error);
}

}  // namespace
}  // namespace polyfly
