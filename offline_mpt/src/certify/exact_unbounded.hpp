#pragma once

#include "certify/exact_survey.hpp"

namespace polyfly {

/// Proves, in rational arithmetic, that the program has solutions at theta and no best one: a z that
/// satisfies all rows, and a direction that keeps them and H z while the cost falls. False where there is no
/// such proof.
bool provesUnbounded(const SurveyContext& context, const Eigen::VectorXd& theta);

/// Gaps at whose witness the cost is unbounded below become defects of that kind; the first few are tried.
void nameUnboundedGaps(const SurveyContext& context, std::vector<Defect>& defects);

}  // namespace polyfly
