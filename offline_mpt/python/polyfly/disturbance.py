"""Ranges of disturbances out of recorded flights."""
from __future__ import annotations

from math import exp, lgamma, log, log1p
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ._polyfly import Error, RobustProblem

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike


class DisturbanceRange(NamedTuple):
    """A range of one disturbance, in its unit."""

    lower: float
    upper: float
    #: That the range holds the share asked for; less than asked where samples are too few.
    confidence: float
    #: Share of all samples within the range.
    covered: float


def _confidence(count, left_out, coverage):
    """That what is between `left_out` of `count` samples holds the share (Wilks, 1941): whatever their distribution."""
    return 1.0 - sum(exp(lgamma(count + 1) - lgamma(k + 1) - lgamma(count - k + 1) + k * log1p(-coverage) + (count - k) * log(coverage))
                     for k in range(min(left_out + 1, count) + 1))


def disturbance_ranges(problem: RobustProblem, flights: Sequence[ArrayLike], coverage: float = 0.99, confidence: float = 0.95,
                       every: int = 1) -> tuple[dict[str, DisturbanceRange], float]:
    """A range of each disturbance, and the share of the prediction error that none explains, which is near 1 for a wrong model.

    flights      arrays with a row for each sampling time: states, then inputs. A row with a NaN splits a flight
    coverage     share of the disturbances that a range holds, with `confidence`
    every        steps between samples that count as independent
    """
    if not (0 < coverage < 1 and 0 < confidence < 1 and every >= 1):
        raise Error("disturbance_ranges: coverage and confidence must lie between 0 and 1, every must be at least 1")
    model = problem.discretise()
    matrix, names = np.hstack([model.A, model.B]), [signal.name for signal in problem.disturbances]
    errors = [problem.parameters[place] for place in problem.error_parameters]
    weight = np.array([2.0 / (signal.upper - signal.lower) for signal in errors])
    if np.linalg.matrix_rank(model.Bd) < len(names):
        raise Error(f"{problem.name}: model.G: columns must not depend on each other")
    steps = []
    for flight in flights:
        flight = np.asarray(flight, dtype=float)
        if flight.ndim != 2 or flight.shape[1] != matrix.shape[1]:
            raise Error(f"{problem.name}: flights: a row must have {matrix.shape[1]} numbers, states and inputs")
        steps.append(flight[1:, :len(weight)] - flight[:-1] @ matrix.T)
    rest = np.vstack([np.empty((0, len(weight))), *steps])
    rest = weight * rest[np.isfinite(rest).all(axis=1)]
    if len(rest) == 0:
        raise Error(f"{problem.name}: flights: no two rows follow each other")
    effect = weight[:, None] * model.Bd
    samples = np.linalg.lstsq(effect, rest.T, rcond=None)[0].T
    unexplained = np.linalg.norm(rest - samples @ effect.T) / (np.linalg.norm(rest) or 1.0)
    counted = np.sort(samples[::every], axis=0)
    cut = 0
    while 2 * cut + 3 < len(counted) and _confidence(len(counted), 2 * cut + 2, coverage) >= confidence:
        cut += 1
    lower, upper = counted[cut], counted[-1 - cut]
    covered = np.mean((samples >= lower) & (samples <= upper), axis=0)
    reached = _confidence(len(counted), 2 * cut, coverage)
    return {name: DisturbanceRange(lower[k], upper[k], reached, covered[k]) for k, name in enumerate(names)}, unexplained
