#include "export_proven/online_code.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "map_export/online_solver.hpp"
#include "mpc_core/dense_qp.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/outputs.hpp"
#include "polyfly_base/write_file.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kMaxVertices = 16;
/// Vectors of the test, besides vertices and the parameter with the most iterations.
constexpr std::size_t kMaxVectors = 64;
/// What stays in u where there is no answer.
constexpr double kUntouched = 0.5;
/// Limits are moved by so many tolerances to tell what is feasible, or infeasible, beyond doubt: also beyond the
/// tolerance of the other solver.
constexpr double kDoubtDouble = 0x1p16;
constexpr double kDoubtFloat = 0x1p6;
/// What the compiled code may differ by, in errors that the solver made at all parameters that were tried.
constexpr double kAllowedErrors = 4.0;
/// Greatest error, as a share of the greatest input, that rounding explains. Beyond it the code is not written.
constexpr double kWrongDouble = 1e-6;
constexpr double kWrongFloat = 0.05;

enum class Answer { kFeasible, kInfeasible, kInDoubt };

/// The program itself, solved by DenseQp in double.
class Oracle {
 public:
  Oracle(const ParametricProgram& program, const OnlineTables& tables, const OnlineTolerances& tolerances,
         double doubt)
      : program_(program), qp_(program.H, program.A, program.equalities) {
    doubt_ = Eigen::VectorXd::Zero(program.rowCount());
    const Eigen::VectorXd length =
        program.H.llt().matrixL().solve(program.A.transpose()).colwise().norm().transpose();
    for (std::size_t s = 0; s < tables.origins.size(); ++s)
      doubt_(tables.origins[s]) = doubt * tolerances.feasible[s] * length(tables.origins[s]);
  }

  Answer solve(const std::vector<double>& theta, std::vector<double>& u) {
    const Eigen::Map<const Eigen::VectorXd> parameters(theta.data(), program_.parameterCount());
    const Eigen::VectorXd g = program_.f + program_.F * parameters;
    const Eigen::VectorXd b = program_.b + program_.S * parameters;
    Eigen::VectorXd moved = b + doubt_;
    if (qp_.solve(g.data(), moved.data()) == QpStatus::kInfeasible) return Answer::kInfeasible;
    // Equalities have no interior: they stay as they are.
    moved = b - doubt_;
    for (const int row : program_.equalities) moved(row) = b(row);
    if (qp_.solve(g.data(), moved.data()) != QpStatus::kOptimal) return Answer::kInDoubt;
    if (qp_.solve(g.data(), b.data()) != QpStatus::kOptimal) return Answer::kInDoubt;
    const Eigen::VectorXd answer = program_.E * qp_.z() + program_.C * parameters + program_.c;
    u.assign(answer.data(), answer.data() + answer.size());
    return Answer::kFeasible;
  }

 private:
  const ParametricProgram& program_;
  DenseQp qp_;
  // Of each row, the change of its bound within which rounding may decide.
  Eigen::VectorXd doubt_;
};

std::vector<std::vector<double>> withVertices(const ParametricProgram& program,
                                              const std::vector<std::vector<double>>& parameters) {
  std::vector<std::vector<double>> result;
  const std::size_t p = program.parameters.size();
  for (std::size_t i = 0; i < kMaxVertices; ++i) {
    std::vector<double> theta(p);
    for (std::size_t k = 0; k < p; ++k) {
      const Signal& signal = program.parameters[k];
      theta[k] = (i >> k % 4 & 1u) != 0 ? signal.upper : signal.lower;
    }
    result.push_back(std::move(theta));
  }
  result.insert(result.end(), parameters.begin(), parameters.end());
  return result;
}

std::string placeOf(const std::vector<double>& theta) {
  std::string text;
  for (const double value : theta) text += (text.empty() ? "" : ", ") + std::to_string(value);
  return "theta = (" + text + ")";
}

template <class Real>
class Trial {
 public:
  Trial(const ParametricProgram& program, OnlineCode& code)
      : program_(program),
        code_(code),
        tolerances_(onlineTolerances(code.tables, code.options.type)),
        solver_(code.tables, tolerances_, code.options.iteration_limit),
        oracle_(program, code.tables, tolerances_, kIsDouble ? kDoubtDouble : kDoubtFloat) {
    code_.record.error.assign(program.inputs.size(), 0.0);
    greatest_.assign(program.inputs.size(), 0.0);
  }

  void run(const std::vector<std::vector<double>>& parameters) {
    const std::size_t step = std::max<std::size_t>(1, parameters.size() / kMaxVectors);
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const bool is_vector = i < kMaxVertices || i % step == 0;
      add(parameters[i], is_vector);
    }
    if (code_.record.solved == 0) throw Error(program_.name + ": no parameter that was tried has a solution");
    if (!costliest_.empty()) addVector(costliest_, 0, costliest_u_);
    if (code_.vectors.status.empty()) {
      throw Error(program_.name +
                  ": another solver confirms none of the answers: the limits are as narrow as rounding. "
                  "State the inputs "
                  "in a smaller unit");
    }
    finish();
  }

 private:
  static constexpr bool kIsDouble = std::is_same_v<Real, double>;

  void add(const std::vector<double>& exact, bool is_vector) {
    const std::vector<Real> rounded(exact.begin(), exact.end());
    const std::vector<double> theta(rounded.begin(), rounded.end());
    std::vector<Real> found(program_.inputs.size(), 0);
    const OnlineStatus status = solver_.solve(rounded.data(), found.data());
    ++code_.record.parameters;
    code_.record.solved += status == OnlineStatus::kOk;
    code_.record.infeasible += status == OnlineStatus::kInfeasible;
    code_.record.stopped += status == OnlineStatus::kIterations;

    if (status != OnlineStatus::kIterations)
      code_.record.iterations = std::max(code_.record.iterations, solver_.iterations());

    std::vector<double> u(found.size(), kUntouched);
    const Answer answer = oracle_.solve(theta, u);
    if (answer == Answer::kInDoubt || status == OnlineStatus::kIterations) return;
    const bool is_feasible = answer == Answer::kFeasible;
    if (status != (is_feasible ? OnlineStatus::kOk : OnlineStatus::kInfeasible)) {
      throw Error(program_.name + ": the online solver finds " +
                  (is_feasible ? "no solution" : "a solution") + ", another solver " +
                  (is_feasible ? "one" : "none") + ", at " + placeOf(theta));
    }
    ++code_.record.confirmed;
    for (std::size_t j = 0; is_feasible && j < found.size(); ++j) {
      greatest_[j] = std::max(greatest_[j], std::abs(u[j]));
      code_.record.error[j] = std::max(code_.record.error[j], std::abs(found[j] - u[j]));
    }
    if (is_feasible && solver_.iterations() > most_iterations_) {
      most_iterations_ = solver_.iterations();
      costliest_ = theta;
      costliest_u_ = u;
    }
    if (is_vector) addVector(theta, is_feasible ? 0 : 1, u);
  }

  void addVector(const std::vector<double>& theta, std::uint32_t status, const std::vector<double>& u) {
    code_.vectors.theta.insert(code_.vectors.theta.end(), theta.begin(), theta.end());
    code_.vectors.status.push_back(status);
    code_.vectors.u.insert(code_.vectors.u.end(), u.begin(), u.end());
  }

  void finish() {
    for (std::size_t j = 0; j < greatest_.size(); ++j) {
      const double error = code_.record.error[j];
      if (error > (kIsDouble ? kWrongDouble : kWrongFloat) * greatest_[j]) {
        throw Error(program_.name + ": the online solver's input " + program_.inputs[j].name + " is off by " +
                    std::to_string(error) + (kIsDouble ? "" : "; use --type double"));
      }
      constexpr double kComparison = 16.0;
      const double rounding = kComparison * std::numeric_limits<Real>::epsilon() * greatest_[j];
      code_.vectors.tolerance.push_back(kAllowedErrors * error + rounding);
    }
  }

  const ParametricProgram& program_;
  OnlineCode& code_;
  const OnlineTolerances tolerances_;
  OnlineSolver<Real> solver_;
  Oracle oracle_;
  std::vector<double> greatest_;
  std::uint32_t most_iterations_ = 0;
  std::vector<double> costliest_, costliest_u_;
};

}  // namespace

OnlineCode tryOnline(const ParametricProgram& program, OnlineOptions options,
                     const std::vector<std::vector<double>>& parameters) {
  OnlineCode code;
  code.tables = onlineTables(program);
  if (options.iteration_limit == 0) options.iteration_limit = defaultIterationLimit(code.tables);
  code.options = std::move(options);
  // Checks what tables and options must hold before the work.
  onlineHeader(code.tables, code.options);
  const std::vector<std::vector<double>> tried = withVertices(program, parameters);
  if (code.options.type == ExportType::kDouble) {
    Trial<double>(program, code).run(tried);
  } else {
    Trial<float>(program, code).run(tried);
  }
  return code;
}

void writeOnline(const OnlineCode& code, const std::string& folder) {
  const std::string stem = folder + "/" + code.options.name;
  makeFolder(folder);
  writeFileAtomically(stem + ".c", onlineSource(code.tables, code.options));
  writeFileAtomically(stem + ".h", onlineHeader(code.tables, code.options));
  writeFileAtomically(stem + "_test.c", onlineTest(code.tables, code.options, code.vectors));
  writeFileAtomically(stem + ".json", onlineFacts(code.tables, code.options, code.record));
}

}  // namespace polyfly
