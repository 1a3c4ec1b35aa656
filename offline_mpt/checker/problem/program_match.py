"""Whether the program of a certificate is that of a tracking problem."""
from collections import namedtuple
from fractions import Fraction

from balls import UNIT, Balls, blocks
from exact import Refused, require
from expected_program import expected_program
from rounding_effect import RoundingEffect

# Of a difference: the share of the greatest entry of its row.
TOLERANCE = Fraction(1, 10**12)
# What all differences may change in an input, as a share of its range.
GREATEST_EFFECT = Fraction(1, 10**6)

ProgramMatch = namedtuple("ProgramMatch", "difference effect expected")


def difference_of(wanted, found, radius):
    """The greatest difference of parts of a row, relative to the greatest entry of the part and of those before it: parts
    further behind are sums in which more cancels. Ends at one that is greater than the tolerance."""
    greatest, size = Fraction(0), 0
    for expected, actual in zip(wanted, found):
        distance = max(distances(expected, actual, radius), default=0)
        size = max(size, *map(abs, actual), 0)
        greatest = max(greatest, Fraction(distance, size or UNIT))
        if greatest > TOLERANCE:
            break
    return greatest


def distances(wanted, found, radius):
    return [abs(a - b) + radius for a, b in zip(wanted, found)]


class Match:
    """Shows that the program of a certificate is the expected one: each number within the tolerance of the greatest entry of
    its row. Refuses programs whose sizes differ."""

    def __init__(self, certificate, expected, effect):
        self._program, self._equalities, self._effect = certificate.program, certificate.equalities, effect
        self.greatest = Fraction(0)
        (q, width), n = expected.C.size, len(expected.H.rows)
        self._matrix("H", expected.H, n)
        self._matrix("F f", expected.F, width - 1)
        self._match_rows(expected.rows, n, width - 1)
        self._matrix("E", blocks([Balls.identity(q), Balls.zeros(q, n - q)]), n)
        # Of a steady state, what cancels in C may be far greater in c.
        self._matrix("C c", expected.C, width)

    def _balls(self, names):
        return blocks([Balls.of(self._program[name]) for name in names.split()])

    def _matrix(self, names, expected, split):
        """Matrices side by side, whose rows have two parts."""
        actual = self._balls(names)
        require(actual.size == expected.size, f"{names}: has another size than the problem")
        for i, rows in enumerate(zip(expected.rows, actual.rows)):
            wanted, found = ((row[:split], row[split:]) for row in rows)
            share = difference_of(wanted, found, expected.radius + actual.radius)
            require(share <= TOLERANCE,
                    f"{names}: row {i} differs from the problem by {float(share):.3g} of its greatest entry")
            self.greatest = max(self.greatest, share)

    def _match_rows(self, expected, n, p):
        """Each expected row is exactly one row of the program, A z <= S theta + b or A_theta theta <= b_theta, and the other
        way round."""
        rows, without_z = self._balls("A S b"), self._balls("A_theta b_theta")
        actual = [(row[:n], row[n:-1], row[-1:], i in self._equalities) for i, row in enumerate(rows.rows)]
        actual += [([0] * n, [-entry for entry in row[:-1]], row[-1:], False) for row in without_z.rows]
        require(all(len(on_theta) == p for _, on_theta, _, _ in actual), "the rows have another size")
        require(len(actual) == len(expected), f"there are {len(actual)} rows, of the problem {len(expected)}")
        for k, row in enumerate(expected):
            radius = row.radius + rows.radius + without_z.radius
            for place, (*parts, is_equality) in enumerate(actual):
                share = difference_of(row.parts, parts, radius)
                if is_equality == row.is_equality and share <= TOLERANCE:
                    break
            else:
                raise Refused(f"row {k} of the problem is none of the program")
            del actual[place]
            self.greatest = max(self.greatest, share)
            self._effect.add_row(parts[0], *(distances(*part, radius) for part in zip(row.parts, parts)))


def match_expected(certificate, problem, expected):
    """The program is the expected one, and the differences change no input by more than a millionth of its range."""
    ranges = [list(parameter.range) for parameter in problem.free]
    require(certificate.program["box"] == ranges, "the range of a parameter is not that of the problem")
    require(len(certificate.program["H"]) == len(expected.H.rows), "H: has another size than the problem")
    moves = len(problem.blocks) * len(problem.inputs)
    effect = RoundingEffect(certificate.program, ranges, problem.inputs, moves)
    match = Match(certificate, expected, effect)
    effect.add_cost(expected)
    share = effect.of_inputs(expected.C)
    require(share <= GREATEST_EFFECT,
            f"rounding of the program may change an input by {float(share):.3g} of its range")
    return ProgramMatch(float(match.greatest), float(share), expected)


def is_block_diagonal(H, inputs, size):
    """Whether no two stages share a term of the cost: only then may the variables be those beside a feedback."""
    return not any(entry for i, row in enumerate(H[:inputs]) for j, entry in enumerate(row[:inputs])
                   if i // size != j // size)


def match_tracking(certificate, problem):
    """In the inputs, or else beside a feedback."""
    try:
        return match_expected(certificate, problem, expected_program(problem))
    except Refused:
        nu = len(problem.inputs)
        if not is_block_diagonal(certificate.program["H"], len(problem.blocks) * nu, nu):
            raise
    return match_expected(certificate, problem, expected_program(problem, beside_feedback=True))
