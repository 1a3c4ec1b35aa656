"""The model of a safety filter over one period, with bounds of all that is uncertain."""
from fractions import Fraction

from balls import Balls, blocks
from exact import require
from optimal_control import discretised

TERMS = 120
# Greatest row sum of |A| times the period.
MOST_EXPONENT = 4


class FilterModel:
    """xi+ = A xi + B u + c + w, |w_i| <= W_i. While xi is in the ranges at the samples, and in one convex set with all its
    successors, the state is in its ranges at all times (offline_mpt/checker/README.md, "Safety filters"). `slack` must be left
    of each row, so that answers may be off: the margin times half of upper - lower. Refuses where the period is too long for
    the series, or a range vanishes."""

    def __init__(self, problem):
        nx, nu = len(problem.states), len(problem.inputs)
        whole = discretised(problem.A, problem.B, problem.B_d, problem.sampling_time)
        late = discretised(problem.A, problem.B, problem.B_d, problem.sampling_time - problem.delay).B
        self.A, self.B, self.c = whole.A, late, whole.B_d @ middles(problem.disturbances)
        self.W = column_of(uncertainty_of(problem, whole.A))
        insets = map(Fraction.__add__, problem.state_errors, column_of(excursion_of(problem)))
        self.ranges = [(ends[0] + inset, ends[1] - inset) for ends, inset in zip(problem.states, insets)]
        if problem.delay:
            # The input before acts until the new one does.
            self.A = blocks([whole.A, whole.B - late], [Balls.zeros(nu, nx + nu)])
            self.B, self.c = blocks([late], [Balls.identity(nu)]), blocks([self.c], [Balls.zeros(nu, 1)])
            self.W += problem.input_errors
            self.ranges += problem.inputs
        require(all(lower < upper for lower, upper in self.ranges), "nothing is left of the range of a state")
        self.slack = [problem.margin * (upper - lower) / 2 for lower, upper in self.ranges]


def column_of(balls):
    """At least the absolute values of a column."""
    return [balls.greatest_of(i)[0] for i in range(len(balls.rows))]


def column(values):
    return Balls.of([[value] for value in values])


def halves(ranges):
    return column([(upper - lower) / 2 for lower, upper in ranges])


def middles(ranges):
    return column([(upper + lower) / 2 for lower, upper in ranges])


def absolute_integral(A, B, time):
    """A bound of the integral of |exp(A s) B| over s in [0, t], entry by entry: sum of |A^k B| t^(k+1) / (k+1)!."""
    exponent = A.norm() * time
    require(exponent <= MOST_EXPONENT, "problem: sampling_time: is too long for the model")
    power, result = B, Balls.zeros(*B.size)
    factor, rest = time, time * B.greatest()
    for k in range(TERMS):
        result = result + abs(power).scaled(factor)
        power = A @ power
        factor *= time / (k + 2)
        rest *= exponent / (k + 1)
    # The terms that are left out fall by half at least.
    return result.widened(2 * rest)


def uncertainty_of(problem, A):
    """Disturbances, errors of both measurements, and of the input, each at its worst."""
    measured, period = column(problem.state_errors), problem.sampling_time
    return (measured + abs(A) @ measured +
            absolute_integral(problem.A, problem.B, period) @ column(problem.input_errors) +
            absolute_integral(problem.A, problem.B_d, period) @ halves(problem.disturbances))


def excursion_of(problem):
    """How far the state bends out of the line from sample to sample: h^2/8 times a bound of x'', and what a change of the
    input within the period adds."""
    period, delay = problem.sampling_time, problem.delay
    growth = discretised(abs(problem.A), problem.B, problem.B_d, period).A
    change = halves(problem.inputs).scaled(Fraction(2 if 0 < delay < period else 0))
    result = (growth @ second_derivative(problem, change)).scaled(period * period / 8)
    return result + (abs(problem.B) @ change).scaled(delay * (period - delay) / period)


def second_derivative(problem, change):
    """The greatest |A (A x + B u + B_d d)|, d in the middle of its range; the input may change so much within the period."""
    on_state, on_input = problem.A @ problem.A, problem.A @ problem.B
    middle = (on_state @ middles(problem.states) + on_input @ middles(problem.inputs) +
              problem.A @ problem.B_d @ middles(problem.disturbances))
    on_halves = abs(on_state) @ halves(problem.states) + abs(on_input) @ (halves(problem.inputs) + change)
    return abs(middle) + on_halves
