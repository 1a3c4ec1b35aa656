#include <cmath>
#include <string>
#include <utility>

#include "mpc_core/decompositions.hpp"
#include "mpc_core/parametric_program.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr double kSymmetryTolerance = 1e-10;      // relative to the greatest entry of H
constexpr double kSemidefiniteTolerance = 1e-10;  // least eigenvalue of H relative to the greatest entry

constexpr double kNarrowestRange = 1e-100;  // planes are scaled by what it is the inverse of

class Checker {
 public:
  Checker(const ParametricProgram& program, std::string source)
      : program_(program), source_(std::move(source)) {}

  [[noreturn]] void fail(const std::string& field, const std::string& rule) const {
    throw Error(source_ + ": " + field + ": " + rule);
  }

  /// Size and finiteness of one matrix or vector.
  template <typename Derived>
  void matrix(const std::string& field, const Eigen::MatrixBase<Derived>& value, Eigen::Index rows,
              Eigen::Index cols) const {
    if (value.rows() != rows || value.cols() != cols) {
      fail(field, "must be " + std::to_string(rows) + " x " + std::to_string(cols) + ", got " +
                      std::to_string(value.rows()) + " x " + std::to_string(value.cols()));
    }
    if (!value.allFinite()) fail(field, "must be finite");
  }

  void hessian() const {
    const Eigen::MatrixXd& H = program_.H;
    const double scale = H.cwiseAbs().maxCoeff();
    if ((H - H.transpose()).cwiseAbs().maxCoeff() > kSymmetryTolerance * scale)
      fail("H", "must be symmetric");
    if (symmetricEigenvalues(H)(0) < -kSemidefiniteTolerance * scale)
      fail("H", "must be positive semidefinite");
  }

  void equalities() const {
    std::vector<bool> seen(static_cast<std::size_t>(program_.rowCount()), false);
    for (const int row : program_.equalities) {
      if (row < 0 || row >= program_.rowCount()) {
        fail("equalities", "must name rows of A, got " + std::to_string(row));
      }
      if (seen[static_cast<std::size_t>(row)])
        fail("equalities", "must not repeat row " + std::to_string(row));
      seen[static_cast<std::size_t>(row)] = true;
    }
  }

  void slacks() const {
    const auto within = [](int index, int count) { return index >= 0 && index < count; };
    for (const SlackVariable& slack : program_.slacks) {
      const std::string field = "slacks." + slack.name;
      if (!within(slack.variable, program_.variableCount())) fail(field, "must name a variable of z");
      for (const int row : slack.rows)
        if (!within(row, program_.rowCount())) fail(field, "must name rows of A, got " + std::to_string(row));
      if (slack.floor != -1 && !within(slack.floor, program_.rowCount())) fail(field, "must name a row of A");
    }
  }

  void parameters() const {
    for (const Signal& signal : program_.parameters) {
      const std::string field = "parameters." + signal.name;
      if (!std::isfinite(signal.lower) || !std::isfinite(signal.upper)) fail(field, "range must be bounded");
      if (!(signal.lower < signal.upper)) fail(field, "lower end of the range must be below the upper end");
      if (signal.upper - signal.lower < kNarrowestRange) fail(field, "range must be at least 1e-100 wide");
    }
  }

  void inputs() const {
    for (const Signal& signal : program_.inputs) {
      if (!(signal.lower < signal.upper))
        fail("inputs." + signal.name, "lower bound must be below the upper one");
    }
  }

 private:
  const ParametricProgram& program_;
  std::string source_;
};

}  // namespace

void checkProgram(const ParametricProgram& program) { checkProgram(program, program.name); }

void checkProgram(const ParametricProgram& program, const std::string& source) {
  const Checker check(program, source);
  const Eigen::Index n = program.variableCount();
  const Eigen::Index p = program.parameterCount();
  const Eigen::Index m = program.rowCount();
  const Eigen::Index q = program.inputCount();
  if (n == 0) check.fail("H", "must not be empty");
  if (p == 0) check.fail("parameters", "must not be empty");
  if (q == 0) check.fail("inputs", "must not be empty");
  if (!std::isfinite(program.period) || program.period < 0.0) check.fail("period", "must be 0 or more");
  check.matrix("H", program.H, n, n);
  check.matrix("f", program.f, n, 1);
  check.matrix("F", program.F, n, p);
  check.matrix("A", program.A, m, n);
  check.matrix("b", program.b, m, 1);
  check.matrix("S", program.S, m, p);
  check.matrix("A_theta", program.A_theta, program.A_theta.rows(), p);
  check.matrix("b_theta", program.b_theta, program.A_theta.rows(), 1);
  check.matrix("E", program.E, q, n);
  check.matrix("C", program.C, q, p);
  check.matrix("c", program.c, q, 1);
  check.hessian();
  check.equalities();
  check.slacks();
  check.parameters();
  check.inputs();
}

}  // namespace polyfly
