"""Refusals, and arithmetic of fractions. Matrices are lists of rows."""
from math import gcd, lcm
from operator import mul


class Refused(Exception):
    """The rule that a file breaks."""


def require(condition, rule):
    if not condition:
        raise Refused(rule)


def dot(a, b):
    return sum(map(mul, a, b))


def times_matrix(vector, matrix):
    """vector . matrix"""
    return [dot(vector, column) for column in zip(*matrix)]


def diagonal(values, zero=0):
    return [[value if i == j else zero for j in range(len(values))] for i, value in enumerate(values)]


def whole(values):
    """The positive multiples of fractions that are whole numbers without a common factor."""
    denominator = lcm(*(value.denominator for value in values))
    row = [value.numerator * (denominator // value.denominator) for value in values]
    divisor = gcd(*row)
    return [value // divisor for value in row] if divisor > 1 else row


def eliminated(rows, times, over):
    """A^-1 B of the rows (A, B), by Gauss and Jordan with this arithmetic. Refuses where a pivot is zero."""
    rows, size = list(rows), len(rows)
    for k in range(size):
        pivot = max(range(k, size), key=lambda i, column=k: abs(rows[i][column]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        divisor = rows[k][k]
        require(divisor != 0, "a division by what may be zero")
        rows[k] = [over(entry, divisor) for entry in rows[k]]
        for i, row in enumerate(rows):
            if i != k and row[k]:
                rows[i] = [entry - times(row[k], own) for entry, own in zip(row, rows[k])]
    return [row[size:] for row in rows]
