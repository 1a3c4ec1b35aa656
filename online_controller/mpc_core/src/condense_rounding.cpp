// What rounding the condensed program can change in the law.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>

#include "condense_parts.hpp"
#include "mpc_core/identity_form.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// Greatest error of the law, in shares of the input's range.
constexpr double kGreatestError = 1e-6;
// Relative error of the condensed numbers before they are rounded: a few hundred operations, each entry in units of the
// diagonal entries of its row and column.
constexpr double kWideError = 1024.0 * kDoubleDoubleUnit;

WideMatrix beside(const WideMatrix& M, const WideMatrix& v) {
  WideMatrix result(M.rows(), M.cols() + 1);
  result << M, v;
  return result;
}

/// The program before it is rounded.
AffineProgram unrounded(const WideProgram& numbers, const ParametricProgram& program) {
  return {numbers.H,       beside(numbers.F, numbers.f), numbers.A, beside(numbers.S, numbers.b),
          wide(program.E), beside(numbers.C, numbers.c)};
}

/// value - rounded value
Eigen::MatrixXd rest(const WideMatrix& numbers) { return rounded(numbers - wide(rounded(numbers))); }

Eigen::VectorXd greatestParameters(const ParametricProgram& program) {
  Eigen::VectorXd greatest(program.parameterCount());
  for (Eigen::Index j = 0; j < greatest.size(); ++j) {
    const Signal& signal = program.parameters[static_cast<std::size_t>(j)];
    greatest(j) = std::max(std::abs(signal.lower), std::abs(signal.upper));
  }
  return greatest;
}

/// Greatest |z_j|: as far as bounds of z_j alone tell in the box, else that of the unconstrained minimiser. Beside a feedback,
/// an input is also counted with its whole range.
Eigen::VectorXd greatestVariables(const ParametricProgram& program, const Eigen::VectorXd& free,
                                  const Eigen::VectorXd& theta) {
  const Eigen::Index n = program.variableCount();
  Eigen::VectorXd upper = Eigen::VectorXd::Constant(n, HUGE_VAL), lower = upper;
  for (Eigen::Index i = 0; i < program.A.rows(); ++i) {
    Eigen::Index j = 0;
    const double entry = program.A.row(i).cwiseAbs().maxCoeff(&j);
    if (program.A.row(i).cwiseAbs().sum() != entry) continue;
    Eigen::VectorXd& side = program.A(i, j) > 0.0 ? upper : lower;
    side(j) = std::min(side(j), (std::abs(program.b(i)) + program.S.row(i).cwiseAbs() * theta) / entry);
  }
  const Eigen::VectorXd bound = upper.cwiseMax(lower);
  Eigen::VectorXd other = free;
  for (Eigen::Index j = 0; j < n - static_cast<Eigen::Index>(program.slacks.size()); ++j) {
    const Signal& input = program.inputs[static_cast<std::size_t>(j) % program.inputs.size()];
    other(j) = std::max(other(j), input.upper - input.lower);
  }
  return (bound.array() < HUGE_VAL).select(bound, other);
}

/// Rounding of numbers moves the optimum by at most `shift` in the norm of H, and an input by `shift` times the length of
/// its row of E in the norm of H^-1: the solution of a quadratic program moves by no more than the unconstrained one.
class RoundingError {
 public:
  RoundingError(const WideProgram& numbers, const ParametricProgram& program, const IdentityForm& form)
      : numbers_(numbers), program_(program), form_(form), theta_(greatestParameters(program)) {
    const Eigen::Index n = program.variableCount();
    inverse_root_ = rounded(form.root.triangularView<Eigen::Lower>().solve(WideMatrix::Identity(n, n)));
    const WideMatrix cost = beside(numbers.F, numbers.f);
    const WideMatrix half_way = form.root.triangularView<Eigen::Lower>().solve(cost);
    const Eigen::MatrixXd free =
        rounded(form.root.transpose().triangularView<Eigen::Upper>().solve(half_way));
    z_ = greatestVariables(program, free.cwiseAbs() * withOne(theta_), theta_);
  }

  /// Greatest error of an input, in shares of its range, or of its greatest value where it has none.
  double ofInputs() const {
    const double shift = ofCost() + ofRows();
    double greatest = 0.0;
    for (Eigen::Index i = 0; i < program_.inputCount(); ++i) {
      const Signal& input = program_.inputs[static_cast<std::size_t>(i)];
      const Eigen::VectorXd law = rounded(form_.law.row(i)).cwiseAbs().transpose();
      const double range = input.upper - input.lower;
      const double scale = std::isfinite(range) ? range : law.dot(withOne(theta_));
      const double own = rest(numbers_.C).row(i).cwiseAbs() * theta_ + std::abs(rest(numbers_.c)(i));
      const double error = rounded(form_.output.row(i)).norm() * shift + own;
      if (error > 0.0) greatest = std::max(greatest, error / scale);
    }
    return greatest;
  }

  double condition() const { return program_.H.norm() * inverse_root_.squaredNorm(); }

 private:
  static Eigen::VectorXd withOne(const Eigen::VectorXd& theta) {
    Eigen::VectorXd result(theta.size() + 1);
    result << theta, 1.0;
    return result;
  }

  /// |dH z + dF theta + df| in the norm of H^-1.
  double ofCost() const {
    const auto lengths = [this](const WideMatrix& matrix) -> Eigen::VectorXd {
      return (inverse_root_ * rest(matrix)).colwise().norm().transpose();
    };
    const Eigen::VectorXd diagonal = program_.H.diagonal().cwiseSqrt();
    const Eigen::VectorXd slopes =
        diagonal.cwiseInverse().asDiagonal() * (program_.F.cwiseAbs() * theta_ + program_.f.cwiseAbs());
    const double wide_error =
        kWideError * (inverse_root_.cwiseAbs() * diagonal).norm() * (diagonal.dot(z_) + slopes.maxCoeff());
    return lengths(numbers_.H).dot(z_) + lengths(numbers_.F).dot(theta_) + lengths(numbers_.f)(0) +
           wide_error;
  }

  /// The furthest that a single row moves, in the norm of H.
  double ofRows() const {
    const Eigen::VectorXd moved =
        rest(numbers_.A).cwiseAbs() * z_ + rest(numbers_.S).cwiseAbs() * theta_ + rest(numbers_.b).cwiseAbs();
    return moved.size() == 0 ? 0.0 : moved.cwiseQuotient(form_.length).maxCoeff();
  }

  const WideProgram& numbers_;
  const ParametricProgram& program_;
  const IdentityForm& form_;
  Eigen::VectorXd theta_;
  Eigen::VectorXd z_;
  Eigen::MatrixXd inverse_root_;
};

double greatestOf(const Eigen::MatrixXd& matrix) { return matrix.cwiseAbs().maxCoeff(); }

/// What makes the condition of H great.
std::string cause(const MpcProblem& problem, const Prediction& prediction) {
  const double weights = std::max(greatestOf(problem.Q), greatestOf(problem.R));
  const double terminal = problem.P.size() > 0 ? greatestOf(problem.P) / weights : 1.0;
  double greatest = 0.0;
  for (const Affine& error : prediction.errors)
    greatest = std::max(greatest, greatestOf(rounded(error.on_z)));
  const double growth = std::pow(greatest / greatestOf(rounded(prediction.errors[1].on_z)), 2);
  const double ratio = greatestOf(problem.Q) / problem.R.diagonal().minCoeff();
  if (terminal >= std::max(growth, ratio)) return "the terminal weight is too great beside the others";
  if (growth >= ratio)
    return "the predictions over a horizon of " + std::to_string(problem.horizon) + " grow too much";
  return "the weights of the errors are too great beside those of the inputs";
}

std::string shortText(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1e", value);
  return text;
}

}  // namespace

void requireSmallRounding(const MpcProblem& problem, const Prediction& prediction, const WideProgram& numbers,
                          const ParametricProgram& program) {
  std::string condition = "more than 1e28";
  std::string effect = "may change";
  if (const std::optional<IdentityForm> form = identityForm(unrounded(numbers, program))) {
    const RoundingError rounding(numbers, program, *form);
    const double error = rounding.ofInputs();
    if (error <= kGreatestError) return;
    condition = shortText(rounding.condition());
    effect = "may change by " + shortText(error) + " of its range";
  }
  const char* const way_out =
      problem.moves.empty() ? "" : "; without blocked moves it is predicted beside a feedback";
  throw Error(placeOf(problem) + ": the condensed cost has the condition " + condition +
              ", so by rounding an input " + effect + ", more than 1e-6: " + cause(problem, prediction) +
              way_out);
}

}  // namespace polyfly
