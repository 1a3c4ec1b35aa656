#include "lp/float_lp.hpp"

#include <numeric>
#include <utility>

namespace polyfly {

void FloatLp::add(const std::vector<double>& a_b) { rows_.insert(rows_.end(), a_b.begin(), a_b.end()); }

FloatLp::Status FloatLp::maximise(const std::vector<double>& c) {
  optimum_ = {};
  if (!kernel_) return Status::kFailed;
  BoxOptimum optimum;
  const Status status = kernel_->maximiseInBox(rows_.data(), count(), c.data(), optimum);
  if (status != Status::kFailed) optimum_ = std::move(optimum);
  if (status == Status::kOptimal)
    objective_ = std::inner_product(c.begin(), c.end(), optimum_.t.begin(), 0.0);
  return status;
}

}  // namespace polyfly
