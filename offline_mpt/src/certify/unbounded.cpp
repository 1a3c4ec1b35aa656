#include "certify/unbounded.hpp"

#include "offline_mpt/exact_lp.hpp"

namespace polyfly {
namespace {

constexpr int kMostTried = 20;  // gaps of a map: each takes two exact linear programs

/// Rows A x <= bound over free columns, rows of the basis with "=".
ExactLp rowsOf(const ExactProgram& program, const std::vector<Rational>& bound) {
  ExactLp lp;
  lp.addColumns(program.n);
  lp.addRows(program.m);
  for (int j = 0; j < program.n; ++j) lp.setColumnBounds(j, ExactLp::Bound::kFree, 0, 0);
  for (int i = 0; i < program.m; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const bool equality = program.in_basis[at] != 0 || program.is_equality[at] != 0;
    // With "=" the bound is the lower one, see ExactLp.
    lp.setRowBounds(i, equality ? ExactLp::Bound::kFixed : ExactLp::Bound::kUpper, bound[at], bound[at]);
    for (int j = 0; j < program.n; ++j) {
      if (program.A(i, j) != 0) lp.setCoefficient(i, j, Rational(program.A(i, j)));
    }
  }
  return lp;
}

Rational atParameter(const IntegerMatrix& affine, int row, const std::vector<Rational>& t) {
  const int p = static_cast<int>(t.size());
  Rational value(affine(row, p));
  for (int j = 0; j < p; ++j) value += Rational(affine(row, j)) * t[static_cast<std::size_t>(j)];
  return value;
}

}  // namespace

bool provesUnbounded(const CheckContext& context, const Eigen::VectorXd& theta) {
  const ExactProgram& program = context.program;
  if (!program.linear || theta.size() != program.p) return false;
  const std::vector<Rational> t = toScaled(program, theta);
  std::vector<Rational> bound;
  for (int i = 0; i < program.m; ++i) bound.push_back(atParameter(program.bound, i, t));
  ExactLp solution = rowsOf(program, bound);
  if (solution.solve() != ExactLp::Status::kOptimal) return false;
  ExactLp falling = rowsOf(program, std::vector<Rational>(bound.size()));
  for (int j = 0; j < program.n; ++j) {
    falling.setColumnBounds(j, ExactLp::Bound::kDouble, -1, 1);
    falling.setObjective(j, atParameter(program.cost, j, t));
  }
  falling.setSense(ExactLp::Sense::kMinimise);
  return falling.solve() == ExactLp::Status::kOptimal && falling.objective() < 0;
}

void markUnboundedDefects(const CheckContext& context, std::vector<Defect>& defects) {
  int tried = 0;
  for (Defect& defect : defects) {
    if (defect.kind != Defect::Kind::kGap || defect.witness.size() == 0 || !defect.missing.empty()) continue;
    if (context.stopped() || ++tried > kMostTried) return;
    if (!provesUnbounded(context, defect.witness)) continue;
    defect.kind = Defect::Kind::kUnbounded;
    defect.text = "region " + std::to_string(defect.region) + ", row " + std::to_string(defect.row) +
                  ": behind this facet the program has solutions, but its cost is unbounded below";
  }
}

}  // namespace polyfly
