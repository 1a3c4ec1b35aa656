#include "lp/float_lp.hpp"

#include <numeric>

namespace polyfly {

void FloatLp::add(const std::vector<double>& a_b) { rows_.insert(rows_.end(), a_b.begin(), a_b.end()); }

FloatLp::Status FloatLp::maximise(const std::vector<double>& c) {
  optimum_ = {};
  if (!kernel_) return Status::kFailed;
  const Status status = kernel_->maximiseInBox(rows_.data(), count(), c.data(), optimum_);
  if (status == Status::kFailed) optimum_ = {};
  if (status == Status::kOptimal)
    objective_ = std::inner_product(c.begin(), c.end(), optimum_.t.begin(), 0.0);
  return status;
}

}  // namespace polyfly
