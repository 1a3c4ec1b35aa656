"""The rows of a robust MPC, from the model of its certificate in fractions. The plan is the inputs u~_1 .., then the
disturbance feedback L_ki by k, i and channel."""
from collections import defaultdict
from fractions import Fraction
from operator import mul, truediv

from exact import Refused, eliminated, require
from polyhedron import half_space

# A value is a sum of factors times disturbances times variables, by pairs of these. Without a disturbance, or as a
# constant, the one or the other is 1. Variables are entries of (theta, u~_0, tau) and, behind those, of the plan.
NONE = -1


def summed(*weighted):
    """The sum of values, each times a weight."""
    sums = defaultdict(Fraction)
    for weight, value in weighted:
        for place, factor in value.items():
            sums[place] += weight * factor
    return {place: factor for place, factor in sums.items() if factor}


def said_by(value, bound):
    """What value <= bound says for the worst disturbances, as text: the same for rows that say the same. Then the bound,
    without the disturbances that no plan changes. Of a disturbance's variables, the first one has a positive factor."""
    by_disturbance = defaultdict(dict)
    for (disturbance, variable), factor in value.items():
        by_disturbance[disturbance][variable] = factor
    nominal = by_disturbance.pop(NONE, {})
    bound -= nominal.pop(NONE, 0)
    terms = []
    for factors in by_disturbance.values():
        variables = sorted(factors.items())
        if variables[-1][0] == NONE:
            bound -= abs(variables[-1][1])
        else:
            sign = 1 if variables[-1][1] > 0 else -1
            terms.append([(variable, sign * factor) for variable, factor in variables])
    return str((sorted(nominal.items()), sorted(terms))), bound


class ExpectedRows:
    """The rows of a problem, by simulation of its stages."""

    def __init__(self, models, problem):
        self._models, self._problem = models, problem
        self._p, self._channels = len(problem.ranges), len(models["G"][0])
        self._last_stage = problem.horizon if problem.is_shifted else problem.horizon - 1
        # e_k and u_k
        self._errors, self._inputs = [[one(error) for error in problem.errors]], []
        for k in range(self._last_stage):
            self._inputs.append(summed((1, one(self._plan(k - 1) if k else self._p)), (1, self._feedback(k))))
            self._errors.append(self._following(k))

    def _plan(self, place):
        return self._p + 2 + place

    def _feedback_place(self, k, i, channel):
        return self._last_stage - 1 + (k * (k - 1) // 2 + i) * self._channels + channel

    def predictions(self):
        is_free = self._problem.feedback == "free"
        return self._feedback_place(self._last_stage, 0, 0) if is_free else self._last_stage - 1

    def _feedback(self, k):
        """What disturbances before stage k add to its input."""
        if self._problem.feedback == "fixed":
            value = summed(*zip(self._models["feedback_gain"][0], self._errors[k]))
            return {place: factor for place, factor in value.items() if place[0] != NONE}
        channels = range(self._channels if self._problem.feedback == "free" else 0)
        return {(i * self._channels + channel, self._plan(self._feedback_place(k, i, channel))): Fraction(1)
                for i in range(k) for channel in channels}

    def _following(self, k):
        """e_{k+1}"""
        models = [self._models[name] for name in ("A", "B", "drift", "G")]
        return [summed(*zip(A, self._errors[k]), (B, self._inputs[k]), (drift, one(NONE)),
                       *((effect, {(place, NONE): 1}) for place, effect in enumerate(G, k * self._channels)))
                for A, (B,), (drift,), G in zip(*models)]

    def rows(self):
        """Values and their bounds."""
        problem, tau = self._problem, one(self._p + 1)
        rows = [(summed((-1, tau)), -problem.floor)]
        for j, ends in enumerate(problem.ranges):
            rows += both_sides(one(j), ends)
        for errors in self._errors[-problem.horizon:]:
            for outputs in problem.C:
                peak = summed(*zip(outputs, errors))
                rows += [(summed((sign, peak), (-1, tau)), Fraction(0)) for sign in (1, -1)]
            for state, ends in problem.state_ranges.items():
                rows += both_sides(shifted(errors[state], (row[state] for row in problem.state_shift)), ends)
        for value in self._inputs:
            rows += both_sides(shifted(value, (entry for entry, in problem.input_shift)), problem.input_range)
        return rows

    def value_of(self, row):
        """That of a row of a certificate, and its bound. Each term has a disturbance of its own."""
        value = {(NONE, variable): factor for variable, factor in enumerate(row.y)}
        for disturbance, (constant, z) in enumerate([(Fraction(0), row.z), *row.terms], NONE):
            value.update({(disturbance, self._plan(place)): factor for place, factor in z.items()})
            value[disturbance, NONE] = constant
        return summed((1, value)), row.bound

    def invariant_row(self, value, bound):
        """h . e + g . r <= b, of which the row is the worst case at the stage that must lie in the invariant set."""
        normal = [value.get((NONE, j), Fraction(0)) for j in range(self._p)]
        direction = [normal[error] for error in self._problem.errors]
        stage = 1 if self._problem.invariance == "first_step" else self._last_stage
        for _ in range(stage):
            rows = [[*column, entry] for column, entry in zip(zip(*self._models["A"]), direction)]
            direction = [entry for entry, in eliminated(rows, mul, truediv)]
        for error in self._problem.errors:
            normal[error] = Fraction(0)
        expected = shifted(summed(*zip(direction, self._errors[stage])), normal)
        (said, own), (wanted, worst) = said_by(value, bound), said_by(expected, 0)
        require(said == wanted, "a row of the certificate is none of the problem")
        for error, entry in zip(self._problem.errors, direction):
            normal[error] = entry
        return half_space(normal, own - worst)


def one(variable):
    return {(NONE, variable): Fraction(1)}


def shifted(value, on_theta):
    return summed((1, value), *((factor, one(j)) for j, factor in enumerate(on_theta)))


def both_sides(value, ends):
    return [(value, ends[1]), (summed((-1, value)), -ends[0])]


def match_rows(certificate, problem):
    """Finds each row of the problem in the certificate as often as it occurs. Other rows are refused, but for those of
    `invariance`. Returns the number of rows of the problem, and the half-spaces of the invariant set."""
    expected = ExpectedRows(certificate.models, problem)
    require(certificate.predictions == expected.predictions(), "the plan has another size")
    left = defaultdict(list)
    for row in map(expected.value_of, certificate.rows):
        left[said_by(*row)].append(row)
    rows = expected.rows()
    for k, row in enumerate(rows):
        if not left[said_by(*row)]:
            raise Refused(f"row {k} of the problem is none of the certificate")
        left[said_by(*row)].pop()
    others = [row for same in left.values() for row in same]
    has_set = problem.invariance != "none"
    require(has_set or not others, "a row of the certificate is none of the problem")
    require(others or not has_set, "rows of the invariant set are missing")
    return len(rows), [expected.invariant_row(*row) for row in others]
