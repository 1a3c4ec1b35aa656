"""What a certificate of a robust map has to do with its problem file."""
from collections import namedtuple
from fractions import Fraction
from operator import truediv

from balls import Balls
from exact import dot, require
from invariance import Invariance
from optimal_control import DiscreteSystem, discretised, gain_of, terminal_weight
from robust_rows import match_rows

# Of a difference: the share of the greatest entry of its row.
TOLERANCE = Fraction(1, 10**12)

# The greatest difference of a discretised matrix or computed gain, relative to the greatest entry of its row; rows that
# follow from the model; rows that bound the first step or the last one, to a set that is robustly invariant; and whether it
# is shown that no greater set is so.
RobustMatch = namedtuple("RobustMatch", "difference rows invariance_rows is_greatest")


class ModelMatch:
    """Shows that the model of a certificate is that of the problem: what is discretised or computed within 2^-bits and the
    tolerance, all else exactly."""

    def __init__(self, models, problem):
        self._models, self._problem = models, problem
        self.greatest = Fraction(0)
        self._require_equal(C=problem.C, state_shift=problem.state_shift, input_shift=problem.input_shift,
                            range=problem.ranges, input_range=[list(problem.input_range)])
        self._match_dynamics()
        self._match_gain("tie_gain", problem.tie_gain)
        is_fixed = problem.feedback == "fixed"
        require(("feedback_gain" in models) == is_fixed, "model feedback_gain is not that of the problem")
        if is_fixed:
            self._match_gain("feedback_gain", problem.feedback_gain)

    def _require_equal(self, **expected):
        for name, matrix in expected.items():
            require(self._models[name] == matrix, f"model {name} is not that of the problem")

    def _require_near(self, name, actual, expected):
        require(Balls.of(actual).size == expected.size, f"model {name}: has another size than the problem")
        errors, unit = Balls.of(actual) - expected, Fraction(1, 1 << self._problem.bits)
        for i, row in enumerate(actual):
            size, difference = max(map(abs, row), default=0), max(errors.greatest_of(i), default=Fraction(0))
            require(difference <= unit + TOLERANCE * size, f"model {name}: row {i} is another one")
            if size > 0:
                self.greatest = max(self.greatest, difference / size)

    def _match_dynamics(self):
        problem, models = self._problem, self._models
        ranges = problem.disturbances
        require(len(models["G"][0]) == len(ranges), "model G: has another size than the problem")
        # The effect of the disturbances themselves, from that of their half widths.
        halves, middles = ([(upper + sign * lower) / 2 for lower, upper in ranges] for sign in (-1, 1))
        G = [list(map(truediv, row, halves)) for row in models["G"]]
        self._require_equal(drift=[[dot(row, middles)] for row in G])
        if problem.is_discrete:
            self._require_equal(A=problem.A, B=problem.B)
            require(G == problem.G, "model G is not that of the problem")
            return
        system = discretised(*map(Balls.of, (problem.A, problem.B, problem.G)), problem.sampling_time)
        self._require_near("A", models["A"], system.A)
        self._require_near("B", models["B"], system.B)
        self._require_near("G", G, system.B_d)

    def _match_gain(self, name, gain):
        if gain.value:
            self._require_equal(**{name: gain.value})
            return
        system = DiscreteSystem(Balls.of(self._models["A"]), Balls.of(self._models["B"]), None)
        R = Balls.of(gain.R)
        P, _ = terminal_weight(system, Balls.of(gain.Q), R)
        self._require_near(name, self._models[name], -gain_of(system, R, P))


def match_robust(certificate, problem, region_map):
    """Shows that the model of a certificate is that of the problem, and its rows those of this model."""
    model = ModelMatch(certificate.models, problem)
    require(certificate.errors == problem.errors, "errors are not those of the problem")
    require(certificate.state_ranges == problem.state_ranges, "state_range: not that of the problem")
    require(region_map.q == 1 + problem.has_peak, "the outputs of the map are not those of the problem")
    # The map's box is the range, rounded to doubles.
    for j, (ends, wanted) in enumerate(zip(region_map.box, problem.ranges)):
        require(all(abs(end - exact) <= TOLERANCE * abs(exact) for end, exact in zip(ends, wanted)),
                f"the range of parameter {j} is not that of the problem")
    count, invariant_set = match_rows(certificate, problem)
    if not invariant_set:
        return RobustMatch(float(model.greatest), count, 0, False)
    invariance = Invariance(certificate.models, problem)
    invariance.confirm(invariant_set)
    is_greatest = invariance.is_greatest(invariant_set)
    return RobustMatch(float(model.greatest), count, len(invariant_set), is_greatest)
