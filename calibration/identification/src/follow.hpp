#pragma once

#include "identification/excitation.hpp"
#include "identification/fit_loop.hpp"

namespace polyfly {

/// Reason of the windows that keepWhatFollows leaves out.
constexpr const char* kDoesNotFollow = "the response does not follow the command as elsewhere";

/// Takes out of the chosen windows the stretches in which the response does not follow the command as it does
/// elsewhere, and tells them in `rejected`.
///
/// A first-order model with delay is fitted to all windows, by a loss that outliers hardly move. Its usual residual is that
/// of the stretches in which it explains half of the response's deviation. A stretch of 2 s goes where it explains less
/// than a quarter and misses by 2.5 times the usual, or less than half and by 5 times; the latter holds for a second, too.
/// So does what is beside it and misses by as much. The model is then fitted to what is left, until nothing changes. Nothing is taken out where no model explains
/// half of any stretch. Clean record.
void keepWhatFollows(const LoopRecord& record, const FitOptions& fit, ExcitationChoice* choice);

}  // namespace polyfly
