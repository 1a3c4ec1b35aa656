"""Matrices of real numbers in fixed point, with a bound of their error."""
from fractions import Fraction

from exact import dot, require

BITS = 512
UNIT = 1 << BITS


def scaled_down(value):
    """At least the number in units of 2^-BITS, which is not negative."""
    return -(-value >> BITS)


class Balls:
    """Each entry differs from that of `rows` by at most `radius`; both are whole numbers in units of 2^-BITS. Every result
    holds all numbers that entries of its operands may give."""

    def __init__(self, rows, columns, radius=0):
        self.rows, self.columns, self.radius = rows, columns, radius

    @classmethod
    def of(cls, matrix):
        """A matrix of fractions."""
        rows = [[entry.numerator * UNIT // entry.denominator for entry in row] for row in matrix.rows]
        is_exact = all(UNIT % entry.denominator == 0 for entry in matrix.entries())
        return cls(rows, matrix.columns, 0 if is_exact else 1)

    @classmethod
    def zeros(cls, height, columns):
        return cls([[0] * columns for _ in range(height)], columns)

    @classmethod
    def identity(cls, size):
        return cls([[UNIT if i == j else 0 for j in range(size)] for i in range(size)], size)

    @property
    def height(self):
        return len(self.rows)

    def __add__(self, other):
        return self._sum(other, 1)

    def __sub__(self, other):
        return self._sum(other, -1)

    def _sum(self, other, sign):
        rows = [[a + sign * b for a, b in zip(mine, theirs)] for mine, theirs in zip(self.rows, other.rows)]
        return Balls(rows, self.columns, self.radius + other.radius)

    def __matmul__(self, other):
        columns = list(zip(*other.rows)) if other.rows else [()] * other.columns
        rows = [[dot(row, column) >> BITS for column in columns] for row in self.rows]
        # |A B - A' B'| <= |A'| dB + dA |B'| + dA dB; one more for the values that are rounded down.
        error = (_row_sum(self.rows) * other.radius + self.radius * _row_sum(columns) +
                 self.columns * self.radius * other.radius)
        return Balls(rows, other.columns, scaled_down(error) + 1)

    def transposed(self):
        return Balls([list(column) for column in zip(*self.rows)] or [[] for _ in range(self.columns)], self.height, self.radius)

    def part(self, top, left, height, columns):
        return Balls([row[left:left + columns] for row in self.rows[top:top + height]], columns, self.radius)

    def scaled(self, factor):
        """Times a fraction."""
        rows = [[entry * factor.numerator // factor.denominator for entry in row] for row in self.rows]
        return Balls(rows, self.columns, -(-self.radius * abs(factor.numerator) // factor.denominator) + 1)

    def negated(self):
        return Balls([[-entry for entry in row] for row in self.rows], self.columns, self.radius)

    def widened(self, by):
        """With errors that are greater by a fraction."""
        return Balls(self.rows, self.columns, self.radius + -(-by.numerator * UNIT // by.denominator))

    def middle(self):
        """Without errors, to go on with as an approximation."""
        return Balls(self.rows, self.columns)

    def magnitudes(self):
        return Balls([[abs(entry) for entry in row] for row in self.rows], self.columns, self.radius)

    def upper(self, i, j):
        """At least the entry."""
        return Fraction(self.rows[i][j] + self.radius, UNIT)

    def greatest_at(self, i, j):
        """At least the absolute value of the entry."""
        return Fraction(abs(self.rows[i][j]) + self.radius, UNIT)

    def greatest(self):
        """At least the greatest absolute value."""
        values = [abs(entry) for row in self.rows for entry in row]
        return Fraction(max(values) + self.radius, UNIT) if values else Fraction(0)

    def norm(self):
        """At least the greatest sum of absolute values of a row."""
        return Fraction(_row_sum(self.rows) + self.columns * self.radius, UNIT)


def _row_sum(rows):
    return max((sum(map(abs, row)) for row in rows), default=0)


def beside(*parts):
    """Matrices side by side."""
    rows = [[entry for row in rows for entry in row] for rows in zip(*(part.rows for part in parts))]
    return Balls(rows, sum(part.columns for part in parts), max(part.radius for part in parts))


def above(*parts):
    """Matrices of the same width one upon the other."""
    return Balls([row for part in parts for row in part.rows], parts[0].columns, max(part.radius for part in parts))


def _approximate_inverse(matrix):
    size = matrix.height
    rows = [row + unit for row, unit in zip(matrix.rows, Balls.identity(size).rows)]
    for k in range(size):
        pivot = max(range(k, size), key=lambda i, column=k: abs(rows[i][column]))
        require(rows[pivot][k] != 0, "a division by what may be zero")
        rows[k], rows[pivot] = rows[pivot], rows[k]
        rows[k] = [entry * UNIT // rows[k][k] for entry in rows[k]]
        for i in range(size):
            if i != k and rows[i][k]:
                factor = rows[i][k]
                rows[i] = [entry - (factor * own >> BITS) for entry, own in zip(rows[i], rows[k])]
    return Balls([row[size:] for row in rows], size)


def solved(A, B):
    """A^-1 B. Refuses where A may be singular."""
    inverse = _approximate_inverse(A)
    # With Y about A^-1 and E = 1 - Y A, A^-1 B = (1 - E)^-1 Y B, which differs from Y B by at most |E| / (1 - |E|) |Y B|.
    error = (Balls.identity(A.height) - inverse @ A).norm()
    require(error < 1, "a division by what may be zero")
    result = inverse @ B
    return result.widened(error / (1 - error) * result.greatest())
