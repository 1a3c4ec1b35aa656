"""Discretisation by the matrix exponential, and the Riccati equation."""
from collections import namedtuple
from fractions import Fraction

from balls import Balls, blocks, solved
from exact import Refused, require

MOST_SQUARINGS = 64
TERMS = 120
MOST_DOUBLINGS = 60
# Of the doubling: a change that is this small for P ends it.
ENOUGH = Fraction(1, 1 << 330)
# A closed loop whose powers have a greater norm counts as unstable.
MOST_NORM = 1 << 64

# x_{k+1} = A x_k + B u_k + B_d d_k
DiscreteSystem = namedtuple("DiscreteSystem", "A B B_d")


def exponential(M):
    """exp(M), by a Taylor series of M / 2^k whose rest is bounded, and k squarings."""
    squarings, size = 0, len(M.rows)
    while M.norm() > Fraction(1, 2):
        require(squarings < MOST_SQUARINGS, "the model is too fast for the sampling time")
        squarings, M = squarings + 1, M.scaled(Fraction(1, 2))
    result = power = Balls.identity(size)
    # The next term's norm is at most 2^-k / k!; all that follow add up to less than as much again.
    rest = Fraction(1)
    for k in range(1, TERMS + 1):
        power = (power @ M).scaled(Fraction(1, k))
        result = result + power
        rest /= 2 * k
    result = result.widened(rest)
    for _ in range(squarings):
        result = result @ result
    return result


def discretised(A, B, B_d, time):
    """x' = A x + B u + B_d d over a time, with u and d constant."""
    (nx, nu), (_, nd) = B.size, B_d.size
    map_ = exponential(blocks([A, B, B_d], [Balls.zeros(nu + nd, nx + nu + nd)]).scaled(time))
    return DiscreteSystem(map_.part(0, 0, nx, nx), map_.part(0, nx, nx, nu), map_.part(0, nx + nu, nx, nd))


def is_stable(closed_loop):
    """Whether a power has a norm below 1."""
    for _ in range(MOST_DOUBLINGS):
        norm = closed_loop.norm()
        if norm < 1 or norm >= MOST_NORM:
            return norm < 1
        closed_loop = closed_loop @ closed_loop
    return False


def gain_of(system, R, P):
    """K of u = -K x, of the cost-to-go x'P x."""
    B_P = system.B.transposed() @ P
    return solved(R + B_P @ system.B, B_P @ system.A)


def doubled(system, Q, R):
    """P of the Riccati equation, about: P_k is the cost of 2^k periods."""
    A, P = system.A.middle(), Q
    G = (system.B @ solved(R, system.B.transposed())).middle()
    for _ in range(MOST_DOUBLINGS):
        W = Balls.identity(len(A.rows)) + G @ P
        by_A, by_G = solved(W, A).middle(), solved(W, G).middle()
        change = (A.transposed() @ P @ by_A).middle()
        G = (G + A @ by_G @ A.transposed()).middle()
        A, P = (A @ by_A).middle(), (P + change).middle()
        if change.greatest() <= ENOUGH * P.greatest():
            return P
    raise Refused("the Riccati equation has no solution that is found")


def terminal_weight(system, Q, R):
    """P of the Riccati equation to about 100 digits, without an error of its own, and a bound of the greatest entry of
    A'PA - A'PB (R + B'PB)^-1 B'PA + Q - P. Refuses where no P is found whose closed loop is stable."""
    P = doubled(system, Q, R)
    closed_loop = system.A - system.B @ gain_of(system, R, P)
    require(is_stable(closed_loop), "the solution of the Riccati equation does not stabilise")
    return P, (system.A.transposed() @ P @ closed_loop + Q - P).greatest()
