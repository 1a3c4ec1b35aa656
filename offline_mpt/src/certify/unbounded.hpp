#pragma once

#include "certify/region_check.hpp"

namespace polyfly {

/// Proves, in rational arithmetic, that the program has solutions at theta and no best one: a z that
/// satisfies all rows, and a direction that keeps them and H z while the cost falls. False where there is no
/// such proof.
bool provesUnbounded(const CheckContext& context, const Eigen::VectorXd& theta);

/// Gaps at whose witness the cost is unbounded below become defects of that kind; the first few are tried.
void markUnboundedDefects(const CheckContext& context, std::vector<Defect>& defects);

}  // namespace polyfly
