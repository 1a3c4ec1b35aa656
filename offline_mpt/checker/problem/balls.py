"""Matrices of real numbers in fixed point, with a bound of their error."""
from fractions import Fraction

from exact import diagonal, dot, eliminated, require

BITS = 512
UNIT = 1 << BITS


def divided_up(value, divisor):
    return -(-value // divisor)


class Balls:
    """Each entry differs from that of `rows` by at most `radius`; both are whole numbers in units of 2^-BITS. Each result
    holds all numbers that entries of its operands may give."""

    def __init__(self, rows, radius=0):
        self.rows, self.radius = rows, radius

    @classmethod
    def of(cls, matrix):
        """A matrix of fractions."""
        is_exact = all(UNIT % entry.denominator == 0 for row in matrix for entry in row)
        return cls([[one.numerator * UNIT // one.denominator for one in row] for row in matrix], 1 - is_exact)

    @classmethod
    def zeros(cls, height, width):
        return cls([[0] * width for _ in range(height)])

    @classmethod
    def identity(cls, size):
        return cls(diagonal([UNIT] * size))

    @property
    def size(self):
        return len(self.rows), len(self.rows[0]) if self.rows else 0

    def _changed(self, change):
        return Balls([list(map(change, row)) for row in self.rows], self.radius)

    def _joined(self, other, join):
        rows = [list(map(join, *pair)) for pair in zip(self.rows, other.rows)]
        return Balls(rows, self.radius + other.radius)

    def __add__(self, other):
        return self._joined(other, int.__add__)

    def __sub__(self, other):
        return self._joined(other, int.__sub__)

    def __neg__(self):
        return self._changed(int.__neg__)

    def __abs__(self):
        return self._changed(abs)

    def __matmul__(self, other):
        columns = list(zip(*other.rows))
        rows = [[dot(row, column) >> BITS for column in columns] for row in self.rows]
        # |A B - A' B'| <= |A'| dB + dA |B'| + dA dB; one more for the values that are rounded down.
        error = (_row_sum(self.rows) * other.radius + self.radius * _row_sum(columns) +
                 len(other.rows) * self.radius * other.radius)
        return Balls(rows, divided_up(error, UNIT) + 1)

    def scaled(self, factor):
        """Times a fraction."""
        above, below = factor.numerator, factor.denominator
        rows = self._changed(lambda entry: entry * above // below).rows
        return Balls(rows, divided_up(self.radius * abs(above), below) + 1)

    def transposed(self):
        return Balls([list(column) for column in zip(*self.rows)], self.radius)

    def part(self, top, left, height, width):
        return Balls([row[left:left + width] for row in self.rows[top:top + height]], self.radius)

    def widened(self, by):
        """With errors that are greater by a fraction."""
        return Balls(self.rows, self.radius + divided_up(by.numerator * UNIT, by.denominator))

    def middle(self):
        """Without errors, to go on with as an approximation."""
        return Balls(self.rows)

    def upper(self, i, j):
        """At least the entry."""
        return Fraction(self.rows[i][j] + self.radius, UNIT)

    def greatest_of(self, i):
        """At least the absolute values of a row."""
        return [Fraction(abs(entry) + self.radius, UNIT) for entry in self.rows[i]]

    def greatest(self):
        """At least the greatest absolute value."""
        return max(entry for i in range(len(self.rows)) for entry in self.greatest_of(i))

    def norm(self):
        """At least the greatest sum of absolute values of a row."""
        return Fraction(_row_sum(self.rows) + self.size[1] * self.radius, UNIT)


def _row_sum(rows):
    return max(sum(map(abs, row)) for row in rows)


def blocks(*lines):
    """One matrix of lines of matrices."""
    rows = [sum(rows, []) for line in lines for rows in zip(*(part.rows for part in line))]
    return Balls(rows, max(part.radius for line in lines for part in line))


def solved(A, B):
    """A^-1 B. Refuses where A may be singular."""
    unit = Balls.identity(len(A.rows))
    rows = blocks([A, unit]).rows
    inverse = Balls(eliminated(rows, lambda a, b: a * b >> BITS, lambda a, b: a * UNIT // b))
    # With Y about A^-1 and E = 1 - Y A, A^-1 B = (1 - E)^-1 Y B, at most |E| / (1 - |E|) |Y B| from Y B.
    error = (unit - inverse @ A).norm()
    require(error < 1, "a division by what may be zero")
    result = inverse @ B
    return result.widened(error / (1 - error) * result.greatest())
