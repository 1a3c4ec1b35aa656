"""By how much the inputs of a program may differ from those of the expected one."""
from fractions import Fraction
from math import isqrt

from balls import UNIT, Balls, blocks, solved
from exact import dot

ROOT_BITS = 300


def root_above(square):
    """At least the root, of a fraction."""
    whole = (max(square.numerator, 0) << 2 * ROOT_BITS) // square.denominator
    return Fraction(isqrt(whole) + 1, 1 << ROOT_BITS)


class RoundingEffect:
    """With fixed rows, the optimum of a strictly convex program moves, in the norm of H, by at most |dH z + dF (theta, 1)| in
    the norm of H^-1. A row that moves takes it along by at most its own distance in that norm; of several rows, the furthest
    counts."""

    def __init__(self, program, parameters, inputs, moves):
        """`parameters` and `inputs` are ranges. The first `moves` entries of z are inputs, stage by stage, or what they add to
        a feedback. Refuses where H may be singular."""
        self._program, self._inputs = program, inputs
        self._inverse = solved(Balls.of(program["H"]), Balls.identity(len(program["H"])))
        self._theta = [max(map(abs, ends)) for ends in parameters] + [Fraction(1)]
        # The greatest |z_j| of the unconstrained minimiser.
        self._free = self._greatest(self._inverse @ self._besides("F", "f"))
        self._z = self._bounds_of_variables(moves)
        self._cost = self._row = Fraction(0)

    def _besides(self, matrix, vector):
        return blocks([Balls.of(self._program[matrix]), Balls.of(self._program[vector])])

    def _greatest(self, matrix):
        """Of each row, the greatest absolute value over (theta, 1)."""
        return [dot(matrix.greatest_of(i), self._theta) for i in range(len(matrix.rows))]

    def _bounds_of_variables(self, moves):
        """The greatest |z_j|, by bounds of z_j alone, else of the unconstrained minimiser; what an input adds to a feedback is
        also counted with the input's whole range."""
        above, below = {}, {}
        for row, S, b in zip(*(self._program[name] for name in ("A", "S", "b"))):
            used = [j for j, entry in enumerate(row) if entry]
            if len(used) == 1:
                bound = dot(map(abs, [*S, *b]), self._theta) / abs(row[used[0]])
                side = above if row[used[0]] > 0 else below
                side[used[0]] = min(side.get(used[0], bound), bound)
        ranges = [upper - lower for lower, upper in self._inputs]
        return [max(above[j], below[j]) if j in above and j in below else
                max(free, ranges[j % len(ranges)] if j < moves else 0) for j, free in enumerate(self._free)]

    def _moved(self, columns, greatest):
        """The sum of the columns' norms of H^-1, each times the greatest of its variable."""
        squares = columns.transposed() @ (self._inverse @ columns)
        return dot([root_above(squares.upper(j, j)) for j in range(len(greatest))], greatest)

    def add_cost(self, expected):
        """Differences of H and F, which has f as its last column."""
        self._cost += self._moved(expected.H - Balls.of(self._program["H"]), self._z)
        self._cost += self._moved(expected.F - self._besides("F", "f"), self._theta)

    def add_row(self, row, on_z, on_theta, bound):
        """Differences of one row, whose numbers are at most so far apart; all in units of 2^-BITS."""
        moved = (dot(on_z, self._z) + dot([*on_theta, *bound], self._theta)) / UNIT
        normal = Balls([row], 1)
        # At most the squared length. A row without z bounds theta alone.
        square = -(-normal @ self._inverse @ normal.transposed()).upper(0, 0)
        if square > 0:
            self._row = max(self._row, moved * root_above(1 / square))

    def of_inputs(self, C):
        """Differences of C and c, then the greatest of an input as a share of its range."""
        changes = self._greatest(C - self._besides("C", "c"))
        changes = [change + root_above(self._inverse.upper(i, i)) * (self._cost + self._row)
                   for i, change in enumerate(changes)]
        return max(change / (upper - lower) for change, (lower, upper) in zip(changes, self._inputs))
