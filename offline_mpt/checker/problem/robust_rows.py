"""The rows of a robust MPC, from the model of its certificate in fractions. The plan is the inputs u~_1 .., then the
disturbance feedback L_ki by k, i and channel."""
from collections import defaultdict
from fractions import Fraction

from certificate import PlanRow
from exact import Matrix, Refused, product, require, times_matrix
from polyhedron import half_space


def tidy(entries):
    """Sorted, without zeros; equal places are added."""
    sums = defaultdict(Fraction)
    for place, value in entries:
        sums[place] += value
    return [(place, value) for place, value in sorted(sums.items()) if value]


def parts_of(row):
    """The bound without the terms that no plan changes, and a text of all else. The text is the same for rows that say the
    same: terms in order, with the sign that makes their first number positive."""
    bound, terms = row.bound, []
    for constant, entries in row.terms:
        z = tidy(entries)
        if not z:
            bound -= abs(constant)
            continue
        sign = -1 if z[0][1] < 0 else 1
        terms.append(" ".join([str(sign * constant), *(f"{place}:{sign * value}" for place, value in z)]))
    z = [f"{place}:{value}" for place, value in tidy(row.z)]
    return bound, "|".join([" ".join(map(str, row.y)), " ".join(z), *sorted(terms)])


def solved_from_left(A, target):
    """a with a A = target, one of several where A is singular; refuses where there is none."""
    count, size = len(A.rows), A.columns
    # One equation for each entry of the target.
    system = [[*column, entry] for column, entry in zip(zip(*A.rows), target)]
    result, used = [Fraction(0)] * count, []
    for column in range(count):
        pivot = next((i for i in range(len(used), size) if system[i][column]), None)
        if pivot is None:
            continue
        own = len(used)
        system[own], system[pivot] = system[pivot], system[own]
        system[own] = [entry / system[own][column] for entry in system[own]]
        for i in range(size):
            if i != own and system[i][column]:
                factor = system[i][column]
                system[i] = [entry - factor * other for entry, other in zip(system[i], system[own])]
        used.append(column)
    require(not any(row[-1] for row in system[len(used):]), "a row of the certificate is none of the problem")
    for column, row in zip(used, system):
        result[column] = row[-1]
    return result


class ExpectedRows:
    """By the closed form of the prediction:
      e_k = A^k e_0 + sum_{j<k} A^(k-1-j) (B u~_j + drift) + sum_i (A^(k-1-i) G + sum_{i<j<k} A^(k-1-j) B L_ji) s_i"""

    def __init__(self, models, problem):
        self._models, self._problem = models, problem
        self._nx, self._p, self._channels = len(models["A"].rows), len(problem.ranges.rows), models["G"].columns
        self._last_stage = problem.horizon if problem.is_shifted else problem.horizon - 1
        self._last_input = self._last_stage - 1
        self._fixed = self._fixed_feedback() if problem.feedback == "fixed" else []

    def predictions(self):
        inputs = self._last_input
        return inputs + (self._channels * inputs * (inputs + 1) // 2 if self._problem.feedback == "free" else 0)

    def rows(self):
        problem = self._problem
        rows = self._of_parameters()
        for k in range(self._last_stage + 1 - problem.horizon, self._last_stage + 1):
            rows += [self._peak([sign * entry for entry in row], k) for row in problem.C.rows for sign in (1, -1)]
            for state, range_ in problem.state_ranges.items():
                shift = [row[state] for row in problem.state_shift.rows]
                for sign in (1, -1):
                    direction = [Fraction(sign if i == state else 0) for i in range(self._nx)]
                    rows.append(self._bounded(self._worst_state(direction, k), shift, sign, range_))
        shift = [entry for entry, in problem.input_shift.rows]
        for k in range(self._last_input + 1):
            rows += [self._bounded(self._input(k, sign), shift, sign, problem.input_range) for sign in (1, -1)]
        return rows

    def invariant_row(self, row):
        """h . e + g . r <= b, of which the row is the worst case at the stage that must lie in the invariant set."""
        stage = 1 if self._problem.invariance == "first_step" else self._last_stage
        direction = [row.y[error] for error in self._problem.errors]
        for _ in range(stage):
            direction = solved_from_left(self._models["A"], direction)
        expected = self._worst_state(direction, stage)
        expected.y[:self._p] = row.y[:self._p]
        (bound, rest), (worst, expected_rest) = parts_of(row), parts_of(expected)
        require(rest == expected_rest, "a row of the certificate is none of the problem")
        normal = row.y[:self._p]
        for error, entry in zip(self._problem.errors, direction):
            normal[error] = entry
        return half_space(normal, bound - worst)

    def _empty(self):
        return PlanRow(Fraction(0), [Fraction(0)] * (self._p + 2), [], [])

    def _fixed_feedback(self):
        """K (A + B K)^j G for each j."""
        gain, reaction = self._models["feedback_gain"], self._models["G"]
        added = product(self._models["B"], gain)
        closed_loop = Matrix([[a + b for a, b in zip(*rows)] for rows in zip(self._models["A"].rows, added.rows)], self._nx)
        effects = []
        for _ in range(self._problem.horizon):
            effects.append(product(gain, reaction).rows[0])
            reaction = product(closed_loop, reaction)
        return effects

    def _term(self, direct, weights, i, channel):
        """A direct effect of s_i, and weights, by j, of L_ji of the channel."""
        constant, z = direct, []
        for j, weight in weights:
            if self._problem.feedback == "fixed":
                constant += weight * self._fixed[j - 1 - i][channel]
            if self._problem.feedback == "free":
                z.append((self._last_input + (j * (j - 1) // 2 + i) * self._channels + channel, weight))
        return constant, z

    def _add_planned(self, weight, j, row):
        """Adds weight times u~_j."""
        if j == 0:
            row.y[self._p] += weight
        else:
            row.z.append((j - 1, weight))

    def _worst_state(self, direction, k):
        """The worst case of direction e_k."""
        powers = [direction]
        for _ in range(k):
            powers.append(times_matrix(powers[-1], self._models["A"]))
        row = self._empty()
        for error, entry in zip(self._problem.errors, powers[k]):
            row.y[error] += entry
        # direction A^(k-1-j) times B, drift and G
        before = [powers[k - 1 - j] for j in range(k)]
        on_input, drift, effects = ([times_matrix(power, self._models[name]) for power in before]
                                    for name in ("B", "drift", "G"))
        for j in range(k):
            self._add_planned(on_input[j][0], j, row)
            row.bound -= drift[j][0]
            weights = [(later, on_input[later][0]) for later in range(j + 1, k)]
            row.terms += [self._term(direct, weights, j, channel) for channel, direct in enumerate(effects[j])]
        return row

    def _of_parameters(self):
        rows = []
        for j, (lower, upper) in enumerate(self._problem.ranges.rows):
            for sign, bound in ((1, upper), (-1, -lower)):
                rows.append(self._empty())
                rows[-1].y[j] += sign
                rows[-1].bound = bound
        floor = self._empty()
        floor.y[-1] -= 1
        floor.bound = -self._problem.floor
        return rows + [floor]

    def _peak(self, direction, k):
        row = self._worst_state(direction, k)
        row.y[-1] -= 1
        return row

    def _bounded(self, row, shift, sign, ends):
        for j, entry in enumerate(shift):
            row.y[j] += sign * entry
        row.bound += ends[1] if sign > 0 else -ends[0]
        return row

    def _input(self, k, sign):
        row = self._empty()
        self._add_planned(Fraction(sign), k, row)
        row.terms = [self._term(Fraction(0), [(k, Fraction(sign))], i, channel)
                     for i in range(k) for channel in range(self._channels)]
        return row


def match_rows(certificate, problem):
    """Finds each row of the problem in the certificate as often as it occurs. Other rows are refused, but for those of
    `invariance`. Returns the number of rows of the problem, and the half-spaces of the invariant set."""
    expected = ExpectedRows(certificate.models, problem)
    require(certificate.predictions == expected.predictions(), "the plan has another size than that of the problem")
    open_rows = defaultdict(list)
    for row in certificate.rows:
        open_rows[parts_of(row)].append(row)
    rows = expected.rows()
    for k, row in enumerate(rows):
        found = open_rows[parts_of(row)]
        if not found:
            raise Refused(f"row {k} of the problem is none of the certificate")
        found.pop()
    left = [row for found in open_rows.values() for row in found]
    has_set = problem.invariance != "none"
    require(has_set or not left, "a row of the certificate is none of the problem")
    require(left or not has_set, "rows of the invariant set are missing")
    return len(rows), [expected.invariant_row(row) for row in left]
