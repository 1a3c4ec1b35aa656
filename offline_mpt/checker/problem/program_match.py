"""Whether the program of a certificate is the expected one."""
from collections import namedtuple
from fractions import Fraction

from balls import UNIT, Balls, beside
from certificate import require_sizes
from exact import Matrix, Refused, require
from expected_program import expected_program
from rounding_effect import RoundingEffect

# Of a difference: the share of the greatest entry of its row.
TOLERANCE = Fraction(1, 10**12)
# What all differences may change in an input, as a share of its range.
GREATEST_EFFECT = Fraction(1, 1000000)

ProgramMatch = namedtuple("ProgramMatch", "difference effect riccati_residual beside_feedback")


def distances(wanted, found, radius):
    return [abs(a - b) + radius for a, b in zip(wanted, found)]


def difference_of(wanted, found, radius, most):
    """The greatest difference of parts of a row, relative to the greatest entry of the part and of those before it: parts
    further behind are sums in which more cancels. Ends at one that is greater than `most`."""
    greatest, size = Fraction(0), 0
    for expected, actual in zip(wanted, found):
        distance = max(distances(expected, actual, radius), default=0)
        size = max(size, *map(abs, actual), 0)
        greatest = max(greatest, Fraction(distance, size or UNIT))
        if greatest > most:
            break
    return greatest


class Match:
    """Shows that the program of a certificate is the expected one, and that its parameters have these ranges: each number
    within `tolerance` of the greatest entry of its row."""

    def __init__(self, certificate, ranges, expected, tolerance, effect=None):
        self._program, self._equalities = certificate.program, certificate.equalities
        self._tolerance, self._effect = tolerance, effect
        self.greatest = Fraction(0)
        n, q = expected.H.height, expected.C.height
        require_sizes(self._program, n, len(self._program["A"].rows), len(ranges), q)
        for j, (box, wanted) in enumerate(zip(self._program["box"].rows, ranges)):
            require(box == list(wanted), f"the range of parameter {j} is not that of the problem")
        self._matrix(["H"], expected.H)
        self._matrix(["F", "f"], expected.F)
        self._match_rows(expected.rows)
        self._matrix(["E"], beside(Balls.identity(q), Balls.zeros(q, n - q)))
        # Of a steady state, what cancels in C may be far greater in c.
        self._matrix(["C", "c"], expected.C, together=True)

    def _balls(self, *names):
        return Balls.of(beside_each_other(*(self._program[name] for name in names)))

    def _matrix(self, names, expected, together=False):
        """`names` are matrices side by side: parts of each row, or `together` one part."""
        name, actual = " ".join(names), self._balls(*names)
        require((actual.height, actual.columns) == (expected.height, expected.columns),
                f"{name}: has another size than the problem")
        split = actual.columns if together else self._program[names[0]].columns
        radius = expected.radius + actual.radius
        for i, rows in enumerate(zip(expected.rows, actual.rows)):
            wanted, found = [(row[:split], row[split:]) for row in rows]
            share = difference_of(wanted, found, radius, self._tolerance)
            require(share <= self._tolerance,
                    f"{name}: row {i} differs from the problem by {float(share):.3g} of its greatest entry")
            self.greatest = max(self.greatest, share)

    def _actual_rows(self):
        """A z <= S theta + b, and those without z as A_theta theta <= b_theta."""
        n, p = self._program["A"].columns, self._program["S"].columns
        rows, without_z = self._balls("A", "S", "b"), self._balls("A_theta", "b_theta")
        parts = [(row[:n], row[n:n + p], row[n + p:], i in self._equalities) for i, row in enumerate(rows.rows)]
        parts += [([0] * n, [-entry for entry in row[:p]], row[p:], False) for row in without_z.rows]
        return parts, max(rows.radius, without_z.radius)

    def _match_rows(self, expected):
        """Each expected row is exactly one row of the program, and the other way round."""
        rows, own_radius = self._actual_rows()
        require(len(rows) == len(expected), f"the program has {len(rows)} rows, the problem {len(expected)}")
        for k, row in enumerate(expected):
            radius = row.radius + own_radius
            for place, (*parts, is_equality) in enumerate(rows):
                share = difference_of(row.parts, parts, radius, self._tolerance)
                if is_equality == row.is_equality and share <= self._tolerance:
                    break
            else:
                raise Refused(f"row {k} of the problem is none of the program")
            del rows[place]
            self.greatest = max(self.greatest, share)
            if self._effect:
                self._effect.add_row(parts[0], *(distances(*part, radius) for part in zip(row.parts, parts)))


def beside_each_other(*matrices):
    """Matrices of fractions side by side."""
    rows = [[entry for row in rows for entry in row] for rows in zip(*(matrix.rows for matrix in matrices))]
    return Matrix(rows, sum(matrix.columns for matrix in matrices))


def match_expected(certificate, problem, beside_feedback=False):
    """The program is that of a tracking problem, and the differences change no input by more than a millionth of its range."""
    expected = expected_program(problem, beside_feedback)
    ranges = [parameter.range for parameter in problem.free]
    require_sizes(certificate.program, expected.H.height, len(certificate.program["A"].rows), len(ranges), expected.C.height)
    effect = RoundingEffect(certificate.program, ranges, problem.inputs, len(problem.blocks) * len(problem.inputs))
    match = Match(certificate, ranges, expected, TOLERANCE, effect)
    effect.add_cost(expected)
    share = effect.of_inputs(expected.C)
    require(share <= GREATEST_EFFECT, f"rounding of the program may change an input by {float(share):.3g} of its range")
    return ProgramMatch(match.greatest, share, expected.riccati_residual, beside_feedback)


def is_block_diagonal(H, inputs, size):
    """Whether no two stages share a term of the cost: only then may the variables be those beside a feedback."""
    return not any(entry for i, row in enumerate(H.rows[:inputs]) for j, entry in enumerate(row[:inputs])
                   if i // size != j // size)


def match_tracking(certificate, problem):
    """The same in the inputs, or else beside a feedback."""
    nu = len(problem.inputs)
    try:
        return match_expected(certificate, problem)
    except Refused:
        if not is_block_diagonal(certificate.program["H"], len(problem.blocks) * nu, nu):
            raise
    return match_expected(certificate, problem, beside_feedback=True)
