// The public class: all is done by its solver.
#include "mpc_core/bounded_qp.hpp"

#include "bounded_qp_solver.hpp"

namespace polyfly {

BoundedQp::BoundedQp(int variables, int rows) : solver_(std::make_unique<Solver>(variables, rows)) {}
BoundedQp::BoundedQp(BoundedQp&& other) noexcept = default;
BoundedQp& BoundedQp::operator=(BoundedQp&& other) noexcept = default;
BoundedQp::~BoundedQp() = default;

bool BoundedQp::setHessian(const double* H) noexcept { return solver_->setHessian(H); }
bool BoundedQp::setConstantHessian(const double* H) noexcept { return solver_->setConstantHessian(H); }
void BoundedQp::setRows(const double* A) noexcept { solver_->setRows(A); }
void BoundedQp::setPenalty(int row, double penalty) noexcept { solver_->setPenalty(row, penalty); }
void BoundedQp::setIterationLimit(int limit) noexcept { solver_->setIterationLimit(limit); }

QpStatus BoundedQp::solve(const QpVectors& vectors, const QpSide* start) noexcept {
  return solver_->solve(vectors, start);
}

int BoundedQp::variableCount() const noexcept { return solver_->variableCount(); }
int BoundedQp::rowCount() const noexcept { return solver_->rowCount(); }
const double* BoundedQp::x() const noexcept { return solver_->x(); }
const double* BoundedQp::multipliers() const noexcept { return solver_->multipliers(); }
const QpSide* BoundedQp::activeSet() const noexcept { return solver_->activeSet(); }
int BoundedQp::iterations() const noexcept { return solver_->iterations(); }
double BoundedQp::kktResidual() const noexcept { return solver_->kktResidual(); }
double BoundedQp::violation() const noexcept { return solver_->violation(); }

}  // namespace polyfly
