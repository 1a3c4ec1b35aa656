"""The program of a tracking problem, Eq. 4 and 38, in z = (u~ of each block, slacks) and theta."""
from collections import namedtuple
from fractions import Fraction
from itertools import accumulate

from balls import UNIT, Balls, blocks, solved
from exact import require
from optimal_control import DiscreteSystem, discretised, terminal_weight

# F and C have the constant part, f and c, as their last column; u = z_0 + C (theta, 1). The residual of the Riccati
# equation is 0 where P is given.
ExpectedProgram = namedtuple("ExpectedProgram", "H F C rows riccati_residual beside_feedback")
# Parts on_z, on_theta and bound of on_z z <= bound + on_theta theta, in units of 2^-BITS, each number within the radius.
# Without z a row bounds theta.
ExpectedRow = namedtuple("ExpectedRow", "parts radius is_equality")


def expected_program(problem, beside_feedback=False):
    """In the inputs; or in v_k = u~_k + K_k (e_k, u~_{k-1}), with the gains of the problem's own Riccati recursion. Any
    gains give the same problem."""
    require(not beside_feedback or set(problem.blocks) == {1}, "the inputs of a block follow no feedback")
    return Condensing(problem).run(beside_feedback)


class Condensing:
    """Values are matrices on (z, theta, 1)."""

    def __init__(self, problem):
        self._problem = problem
        model = problem.A, problem.B, problem.B_d
        self._system = DiscreteSystem(*model) if problem.is_discrete else discretised(*model, problem.sampling_time)
        self._nx, self._nu = problem.size
        self._inputs = self._next_slack = len(problem.blocks) * self._nu
        stages = sum(problem.blocks)
        soft = [constraint.soft for constraint in problem.constraints if constraint.soft]
        self._n = self._inputs + sum(1 if slack.shares_slack else stages for slack in soft)
        self._width = self._n + len(problem.free) + 1
        # The cost is z'(this, without its columns of theta) z / 2 + z'(those) (theta, 1).
        self._cost = self._zeros(self._n)
        self._rows = []
        self._set_given()

    def _zeros(self, height):
        return Balls.zeros(height, self._width)

    def _columns_of(self, role, height):
        """The parameters of a role; fixed ones count in the last column."""
        rows = [[Fraction(0)] * self._width for _ in range(height)]
        column = self._n
        for parameter in self._problem.parameters:
            is_free = parameter.value is None
            if parameter.role == role:
                rows[parameter.index][column if is_free else -1] += 1 if is_free else parameter.value
            column += is_free
        return Balls.of(rows)

    def _has(self, role, index):
        return (role, index) in [(parameter.role, parameter.index) for parameter in self._problem.parameters]

    def _set_given(self):
        """What theta says: e_0, references, the drift of the errors, and u_{-1} - u_ref, which the first input is compared
        with."""
        nx, nu = self._nx, self._nu
        drift = self._system.B_d @ self._columns_of("disturbance", self._problem.B_d.size[1])
        if self._has("state", 0):
            # Eq. 6: (A - I) x_ref + B u_ref = -B_d d, C x_ref = r.
            steady = solved(blocks([self._system.A - Balls.identity(nx), self._system.B],
                                   [self._problem.C, Balls.zeros(nu, nu)]),
                            blocks([-drift], [self._columns_of("reference", nu)]))
            self._x_ref, self._u_ref = steady.part(0, 0, nx, self._width), steady.part(nx, 0, nu, self._width)
            error, self._drift = self._columns_of("state", nx) - self._x_ref, self._zeros(nx)
        else:
            self._x_ref = self._columns_of("state_reference", nx)
            self._u_ref = self._columns_of("input_reference", nu)
            error, self._drift = self._columns_of("error", nx), drift
        before = self._columns_of("previous_input", nu) - self._u_ref
        for i in range(nu):
            if not self._has("previous_input", i):
                before.rows[i] = [0] * self._width
        self._before = before
        # e_0 .. e_N and u~_0 .. u~_{N-1}
        self._errors, self._values = [error], []

    def run(self, beside_feedback):
        problem, residual, P = self._problem, Fraction(0), self._problem.P
        if P is None:
            P, residual = terminal_weight(self._system, problem.Q, problem.R)
        self._predict(feedback_gains(problem, self._system, P) if beside_feedback else None)
        for k, value in enumerate(self._values):
            self._add_cost(self._errors[k], problem.Q)
            self._add_cost(value, problem.R)
            self._add_cost(value - self._value_before(k), problem.R_delta)
            self._add_ranges(self._errors[k + 1], problem.states)
        self._add_cost(self._errors[-1], P)
        # Bounds on u and on its change, once for each block.
        for k in accumulate([0, *problem.blocks[:-1]]):
            self._add_ranges(self._values[k] + self._u_ref, problem.inputs)
            self._add_ranges(self._values[k] - self._value_before(k), problem.changes)
        for row, bound in problem.terminal_set:
            self._add_row(row @ self._errors[-1], 0, 1, bound)
        for i in range(self._nx if problem.ends_at_reference else 0):
            self._add_row(self._errors[-1], i, 1, Fraction(0), is_equality=True)
        for constraint in problem.constraints:
            self._add_constraint(constraint)
        n, p = self._n, self._width - self._n
        C = (self._u_ref + self._values[0]).part(0, n, self._nu, p)
        return ExpectedProgram(self._cost.part(0, 0, n, n), self._cost.part(0, n, n, p), C, self._rows,
                               float(residual), beside_feedback)

    def _value_before(self, k):
        return self._values[k - 1] if k else self._before

    def _predict(self, gains):
        for block, length in enumerate(self._problem.blocks):
            value = self._zeros(self._nu)
            for i, row in enumerate(value.rows):
                row[block * self._nu + i] = UNIT
            for _ in range(length):
                error = self._errors[-1]
                if gains:
                    value = value - gains[block] @ blocks([error], [self._value_before(len(self._values))])
                self._values.append(value)
                self._errors.append(self._system.A @ error + self._system.B @ value + self._drift)

    def _add_cost(self, value, weight):
        """v'W v, without what does not depend on z."""
        on_z = value.part(0, 0, len(value.rows), self._n)
        self._cost = self._cost + (on_z + on_z).transposed() @ weight @ value

    def _add_row(self, value, i, sign, bound, slack=None, is_equality=False):
        """Row i of sign v <= sign bound, less a slack; none for an infinite bound."""
        if bound is not None:
            row = [sign * entry for entry in value.rows[i]]
            on_z, on_theta = row[:self._n], row[self._n:]
            if slack is not None:
                on_z[slack] = -UNIT
            exact = Balls.of([[sign * bound]])
            bound = exact.rows[0][0] - on_theta.pop()
            parts = on_z, [-entry for entry in on_theta], [bound]
            self._rows.append(ExpectedRow(parts, value.radius + exact.radius, is_equality))

    def _add_ranges(self, value, ranges, slack=None):
        for i, (lower, upper) in enumerate(ranges):
            self._add_row(value, i, 1, upper, slack)
            self._add_row(value, i, -1, lower, slack)

    def _add_constraint(self, constraint):
        """Both sides of a soft bound share a slack."""
        first, slack = 0 if constraint.has_input else 1, None
        for k in range(first, first + len(self._values)):
            if constraint.soft and (k == first or not constraint.soft.shares_slack):
                slack = self._add_slack(constraint.soft)
            value = constraint.on_x @ self._errors[k]
            if constraint.has_input:
                value = value + constraint.on_u @ self._values[k]
            if constraint.is_absolute:
                value = value + constraint.on_x @ self._x_ref + constraint.on_u @ self._u_ref
            self._add_ranges(value, [constraint.range], slack)

    def _add_slack(self, soft):
        """Its place in z. Without a linear weight it is at least 0 by itself."""
        place = self._next_slack
        self._next_slack += 1
        cost = [[Fraction(0)] * self._width for _ in range(self._n)]
        cost[place][place], cost[place][-1] = 2 * soft.quadratic, soft.linear
        self._cost = self._cost + Balls.of(cost)
        if soft.linear:
            slack = self._zeros(1)
            slack.rows[0][place] = UNIT
            self._add_row(slack, 0, -1, Fraction(0))
        return place


def feedback_gains(problem, system, P):
    """K_k of each stage, to about 100 digits; they have no errors of their own."""
    nx, nu = problem.size
    side, below = Balls.zeros(nx, nu), Balls.zeros(nu, nx)
    none, unit = Balls.zeros(nu, nu), Balls.identity(nu)
    A, B = blocks([system.A, side], [below, none]), blocks([system.B], [unit])
    # The cost of a change, (u~_k - u~_{k-1})'R_delta (u~_k - u~_{k-1}).
    Q, cross = blocks([problem.Q, side], [below, problem.R_delta]), blocks([below, -problem.R_delta])
    P = blocks([P, side], [below, none])
    gains = []
    for _ in problem.blocks:
        B_P = B.transposed() @ P
        right = B_P @ A + cross
        gains.append(solved(problem.R + problem.R_delta + B_P @ B, right).middle())
        P = (Q + A.transposed() @ P @ A - right.transposed() @ gains[-1]).middle()
    return gains[::-1]
