#include "lp/float_lp.hpp"

#include <numeric>

namespace polyfly {

FloatLp::FloatLp(int dimension) : dimension_(dimension) {
  if (dimension <= PolytopeSolver::kMaxDimension) solver_.emplace(dimension);
}

void FloatLp::add(const std::vector<double>& a_b) { rows_.insert(rows_.end(), a_b.begin(), a_b.end()); }

FloatLp::Status FloatLp::maximise(const std::vector<double>& c) {
  if (!solver_) return Status::kFailed;
  const Status status = solver_->maximiseInBox(rows_.data(), count(), c.data(), optimum_);
  objective_ = std::inner_product(c.begin(), c.end(), optimum_.t.begin(), 0.0);
  return status;
}

}  // namespace polyfly
