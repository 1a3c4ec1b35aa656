#include "certify/unbounded.hpp"

#include "exact_kkt/exact_active_set.hpp"

namespace polyfly {
namespace {

constexpr int kMostTried = 20;  // gaps of a map: each takes two exact linear programs

}  // namespace

bool provesUnbounded(const CheckContext& context, const Eigen::VectorXd& theta) {
  const ExactProgram& program = context.program;
  if (!program.linear || theta.size() != program.p) return false;
  const std::vector<Rational> t = toScaled(program, theta);
  ExactLp solution = rowsAt(program, t);
  if (solution.solve() != ExactLp::Status::kOptimal) return false;
  ExactLp falling = rowsAt(program, t, true);
  for (int j = 0; j < program.n; ++j) falling.setColumnBounds(j, ExactLp::Bound::kDouble, -1, 1);
  setCostAt(program, t, falling);
  falling.setSense(ExactLp::Sense::kMinimise);
  return falling.solve() == ExactLp::Status::kOptimal && falling.objective() < 0;
}

void markUnboundedDefects(const CheckContext& context, std::vector<Defect>& defects) {
  int tried = 0;
  for (Defect& defect : defects) {
    if (defect.kind != Defect::Kind::kGap || defect.witness.size() == 0 || !defect.missing.empty()) continue;
    if (context.stopped() || ++tried > kMostTried) return;
    if (!provesUnbounded(context, defect.witness)) continue;
    const Eigen::VectorXd witness = defect.witness;
    defect = regionDefect(Defect::Kind::kUnbounded, defect.region, defect.row,
                          "behind this facet the program has solutions, but its cost is unbounded below");
    defect.witness = witness;
  }
}

}  // namespace polyfly
