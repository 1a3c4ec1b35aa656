// The only file that includes CGAL: it takes long to compile.
#include "offline_mpt/exact_lp.hpp"

#include <CGAL/Gmpz.h>
#include <CGAL/QP_functions.h>
#include <CGAL/QP_models.h>

#include <cassert>

#include "polyfly_base/error.hpp"

namespace polyfly {

/// An ExactLp in CGAL's form: min c'x, each row with one relation, whole numbers. Rows are multiplied by a
/// common denominator, columns x' = scale x by that of their bounds; a row between two bounds is a column of
/// its own.
class CgalLp {
 public:
  explicit CgalLp(const ExactLp& lp) : lp_(lp) {
    scaleColumns();
    scaleRows();
    int next = 0;
    for (const ExactLp::Line& row : lp_.rows_)
      row_of_.push_back(row.type == ExactLp::Bound::kFree ? -1 : next++);
    addColumns();
    addRows();
    solution_ = CGAL::solve_linear_program(program_, Number());
  }

  void store(ExactLp& lp) const {
    const auto columns = static_cast<std::ptrdiff_t>(lp_.columns_.size());
    lp.primal_.assign(lp_.columns_.size(), Rational(0));
    lp.row_dual_.assign(lp_.rows_.size(), Rational(0));
    lp.primal_ray_.clear();
    lp.objective_ = 0;
    if (solution_.is_infeasible()) {
      lp.status_ = ExactLp::Status::kInfeasible;
      storeRows(lp, solution_.infeasibility_certificate_begin(), Rational(1));
      return;
    }
    for (std::ptrdiff_t j = 0; j < columns; ++j) {
      lp.primal_[j] = rational(*(solution_.variable_values_begin() + j)) / scale_[j];
      lp.objective_ += lp.primal_[j] * lp_.columns_[j].cost;
    }
    if (solution_.is_unbounded()) {
      lp.status_ = ExactLp::Status::kUnbounded;
      for (std::ptrdiff_t j = 0; j < columns; ++j)
        lp.primal_ray_.push_back(rational(*(solution_.unboundedness_certificate_begin() + j)) / scale_[j]);
      return;
    }
    lp.status_ = ExactLp::Status::kOptimal;
    const int sign = lp_.sense_ == ExactLp::Sense::kMinimise ? 1 : -1;
    storeRows(lp, solution_.optimality_certificate_begin(), Rational(sign) / cost_scale_);
  }

 private:
  using Number = CGAL::Gmpz;
  using Program = CGAL::Quadratic_program<Number>;
  using Solution = CGAL::Quadratic_program_solution<Number>;

  static Number whole(const Rational& value) {
    assert(value.get_den() == 1);
    return Number(value.get_num().get_mpz_t());
  }

  static Rational rational(const CGAL::Quotient<Number>& value) {
    Rational result(mpz_class(value.numerator().mpz()), mpz_class(value.denominator().mpz()));
    result.canonicalize();
    return result;
  }

  static Rational rational(const Number& value) { return Rational(mpz_class(value.mpz())); }

  static void include(mpz_class& denominator, const Rational& value) {
    mpz_lcm(denominator.get_mpz_t(), denominator.get_mpz_t(), value.get_den_mpz_t());
  }

  static bool hasLower(ExactLp::Bound type) {
    return type == ExactLp::Bound::kLower || type == ExactLp::Bound::kDouble ||
           type == ExactLp::Bound::kFixed;
  }

  static bool hasUpper(ExactLp::Bound type) {
    return type == ExactLp::Bound::kUpper || type == ExactLp::Bound::kDouble;
  }

  void scaleColumns() {
    for (const ExactLp::Line& column : lp_.columns_) {
      mpz_class denominator(1);
      if (hasLower(column.type)) include(denominator, column.lower);
      if (hasUpper(column.type)) include(denominator, column.upper);
      scale_.emplace_back(denominator);
    }
  }

  void scaleRows() {
    std::vector<mpz_class> denominators;
    for (const ExactLp::Line& row : lp_.rows_) {
      mpz_class denominator(1);
      if (hasLower(row.type)) include(denominator, row.lower);
      if (hasUpper(row.type)) include(denominator, row.upper);
      denominators.push_back(denominator);
    }
    for (std::size_t j = 0; j < lp_.columns_.size(); ++j) {
      for (const auto& [row, value] : lp_.columns_[j].entries) include(denominators[row], value / scale_[j]);
    }
    row_scale_.assign(denominators.begin(), denominators.end());
  }

  void setBounds(int column, const ExactLp::Line& line, const Rational& scale) {
    const bool upper = hasUpper(line.type) || line.type == ExactLp::Bound::kFixed;
    const Rational& top = line.type == ExactLp::Bound::kFixed ? line.lower : line.upper;
    program_.set_l(column, hasLower(line.type), hasLower(line.type) ? whole(line.lower * scale) : Number(0));
    program_.set_u(column, upper, upper ? whole(top * scale) : Number(0));
  }

  void addColumns() {
    mpz_class cost_denominator(1);
    for (std::size_t j = 0; j < lp_.columns_.size(); ++j)
      include(cost_denominator, lp_.columns_[j].cost / scale_[j]);
    cost_scale_ = Rational(cost_denominator);
    const int sign = lp_.sense_ == ExactLp::Sense::kMinimise ? 1 : -1;
    for (std::size_t j = 0; j < lp_.columns_.size(); ++j) {
      const ExactLp::Line& column = lp_.columns_[j];
      const int index = static_cast<int>(j);
      setBounds(index, column, scale_[j]);
      program_.set_c(index, whole(sign * column.cost * cost_scale_ / scale_[j]));
      for (const auto& [row, value] : column.entries) {
        if (row_of_[row] >= 0)
          program_.set_a(index, row_of_[row], whole(value / scale_[j] * row_scale_[row]));
      }
    }
  }

  void addRows() {
    int next = static_cast<int>(lp_.columns_.size());
    for (std::size_t i = 0; i < lp_.rows_.size(); ++i) {
      const ExactLp::Line& row = lp_.rows_[i];
      switch (row.type) {
        case ExactLp::Bound::kFree:
          break;
        case ExactLp::Bound::kLower:
          program_.set_r(row_of_[i], CGAL::LARGER);
          program_.set_b(row_of_[i], whole(row.lower * row_scale_[i]));
          break;
        case ExactLp::Bound::kUpper:
          program_.set_r(row_of_[i], CGAL::SMALLER);
          program_.set_b(row_of_[i], whole(row.upper * row_scale_[i]));
          break;
        case ExactLp::Bound::kFixed:
          program_.set_r(row_of_[i], CGAL::EQUAL);
          program_.set_b(row_of_[i], whole(row.lower * row_scale_[i]));
          break;
        case ExactLp::Bound::kDouble:
          program_.set_r(row_of_[i], CGAL::EQUAL);
          program_.set_b(row_of_[i], Number(0));
          program_.set_a(next, row_of_[i], Number(-1));
          setBounds(next, row, row_scale_[i]);
          ++next;
          break;
      }
    }
  }

  // CGAL's multipliers have the opposite sign of GLPK's.
  template <typename Iterator>
  void storeRows(ExactLp& lp, Iterator multiplier, const Rational& factor) const {
    for (std::size_t i = 0; i < lp_.rows_.size(); ++i) {
      if (row_of_[i] >= 0) lp.row_dual_[i] = -rational(*(multiplier + row_of_[i])) * row_scale_[i] * factor;
    }
  }

  const ExactLp& lp_;
  Program program_{CGAL::SMALLER, false, Number(0), false, Number(0)};
  Solution solution_;
  std::vector<int> row_of_;
  // Scale of each column.
  std::vector<Rational> scale_;
  std::vector<Rational> row_scale_;
  Rational cost_scale_ = 1;
};

namespace {

void requireOrder(ExactLp::Bound type, const Rational& lower, const Rational& upper) {
  if (type == ExactLp::Bound::kDouble && lower > upper)
    throw Error("exact linear program: bounds: lower must not exceed upper");
}

}  // namespace

int ExactLp::addRows(int count) {
  const int first = rowCount();
  rows_.resize(rows_.size() + static_cast<std::size_t>(count));
  status_ = Status::kUndefined;
  return first;
}

int ExactLp::addColumns(int count, Bound type) {
  const int first = columnCount();
  columns_.resize(columns_.size() + static_cast<std::size_t>(count));
  for (int j = first; j < columnCount(); ++j) columns_[static_cast<std::size_t>(j)].type = type;
  status_ = Status::kUndefined;
  return first;
}

void ExactLp::setRowBounds(int row, Bound type, const Rational& lower, const Rational& upper) {
  requireOrder(type, lower, upper);
  Line& line = rows_[static_cast<std::size_t>(row)];
  line.type = type;
  line.lower = lower;
  line.upper = upper;
  status_ = Status::kUndefined;
}

void ExactLp::setColumnBounds(int column, Bound type, const Rational& lower, const Rational& upper) {
  requireOrder(type, lower, upper);
  Line& line = columns_[static_cast<std::size_t>(column)];
  line.type = type;
  line.lower = lower;
  line.upper = upper;
  status_ = Status::kUndefined;
}

void ExactLp::setObjective(int column, const Rational& coefficient) {
  columns_[static_cast<std::size_t>(column)].cost = coefficient;
  status_ = Status::kUndefined;
}

void ExactLp::setSense(Sense sense) {
  sense_ = sense;
  status_ = Status::kUndefined;
}

void ExactLp::setCoefficient(int row, int column, const Rational& value) {
  status_ = Status::kUndefined;
  auto& entries = columns_[static_cast<std::size_t>(column)].entries;
  for (auto& [at, old] : entries) {
    if (at != row) continue;
    old = value;
    return;
  }
  entries.emplace_back(row, value);
}

ExactLp::Status ExactLp::solve() {
  const CgalLp solved(*this);
  solved.store(*this);
  return status_;
}

Rational ExactLp::rowPrimal(int row) const {
  Rational sum;
  for (std::size_t j = 0; j < columns_.size(); ++j) {
    for (const auto& [at, value] : columns_[j].entries) {
      if (at == row) sum += value * primal_[j];
    }
  }
  return sum;
}

Rational ExactLp::throughRows(int column) const {
  Rational sum;
  for (const auto& [row, value] : columns_[static_cast<std::size_t>(column)].entries)
    sum += value * row_dual_[static_cast<std::size_t>(row)];
  return sum;
}

Rational ExactLp::columnDual(int column) const {
  return columns_[static_cast<std::size_t>(column)].cost - throughRows(column);
}

Rational ExactLp::columnRay(int column) const { return -throughRows(column); }

}  // namespace polyfly
