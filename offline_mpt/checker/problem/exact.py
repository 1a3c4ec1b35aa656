"""Refusals, and matrices of fractions."""
from fractions import Fraction
from math import gcd, lcm
from operator import mul


class Refused(Exception):
    """The rule that a file breaks."""


def require(condition, rule):
    if not condition:
        raise Refused(rule)


class Matrix:
    """Rows of numbers, all with the same number of columns."""

    def __init__(self, rows, columns):
        self.rows, self.columns = rows, columns

    @property
    def size(self):
        return len(self.rows), self.columns

    def __eq__(self, other):
        return self.size == other.size and self.rows == other.rows

    def entries(self):
        return [entry for row in self.rows for entry in row]


def dot(a, b):
    return sum(map(mul, a, b))


def times_matrix(vector, matrix):
    """vector . matrix"""
    if not matrix.rows:
        return [Fraction(0)] * matrix.columns
    return [dot(vector, column) for column in zip(*matrix.rows)]


def product(a, b):
    return Matrix([times_matrix(row, b) for row in a.rows], b.columns)


def whole(values):
    """Positive multiples of fractions: whole numbers without a common factor."""
    denominator = lcm(*(value.denominator for value in values))
    row = [value.numerator * (denominator // value.denominator) for value in values]
    divisor = gcd(*row)
    return [value // divisor for value in row] if divisor > 1 else row


def finite(value):
    """The exact value of a double; None where it is infinite."""
    return None if value in (float("inf"), float("-inf")) else Fraction(value)
