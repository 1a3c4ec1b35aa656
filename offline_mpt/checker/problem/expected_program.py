"""The program of a tracking problem, Eq. 4 and 38, in z = (u~ of each block, slacks) and theta."""
from collections import namedtuple
from fractions import Fraction
from itertools import accumulate

from balls import UNIT, Balls, above, beside, solved
from exact import Matrix, require
from optimal_control import discretised, terminal_weight, DiscreteSystem

# F and C have the constant part, f and c, as their last column; u = z_0 + C (theta, 1). The residual of the Riccati equation is
# 0 where P is given.
ExpectedProgram = namedtuple("ExpectedProgram", "H F C rows riccati_residual")


class ExpectedRow:
    """on_z z <= bound + on_theta theta, in units of 2^-BITS, each number within the radius. Without z it bounds theta."""

    def __init__(self, on_z, on_theta, bound, radius=0, is_equality=False):
        self.parts, self.radius, self.is_equality = (on_z, on_theta, [bound]), radius, is_equality


def expected_program(problem, beside_feedback=False):
    """In the inputs; or in v_k = u~_k + K_k (e_k, u~_{k-1}), with the gains of the problem's own Riccati recursion. Any gains
    give the same problem."""
    require(not beside_feedback or set(problem.blocks) == {1}, "the inputs of a block follow no feedback")
    return Condensing(problem).run(beside_feedback)


class Condensing:
    """Values are matrices on (z, theta, 1)."""

    def __init__(self, problem):
        self._problem = problem
        self._system = DiscreteSystem(problem.A, problem.B, problem.B_d) if problem.is_discrete else discretised(
            problem.A, problem.B, problem.B_d, problem.sampling_time)
        self._nx, self._nu = problem.B.height, problem.B.columns
        stages = sum(problem.blocks)
        slacks = sum(1 if constraint.soft.shares_slack else stages for constraint in problem.constraints if constraint.soft)
        self._inputs = len(problem.blocks) * self._nu
        self._n, self._p = self._inputs + slacks, len(problem.free)
        self._columns = self._n + self._p + 1
        self._cost = Balls.zeros(self._n, self._columns)
        self._weights_of_slacks = self._zeros(self._n)
        self._next_slack = self._inputs
        self._rows = []
        self._set_given()

    def _set_given(self):
        """What theta says: e_0, references, the drift of the errors, and u_{-1} - u_ref, which the first input is compared with."""
        nu, nx = self._nu, self._nx
        disturbance = self._columns_of("disturbance", self._problem.B_d.columns)
        if self._has("state", 0):
            self._set_steady_state(disturbance)
            self._error = self._columns_of("state", nx) - self._state_reference
            self._drift = self._zeros(nx)
        else:
            self._error = self._columns_of("error", nx)
            self._input_reference = self._columns_of("input_reference", nu)
            self._state_reference = self._columns_of("state_reference", nx)
            self._drift = self._system.B_d @ disturbance
        before = self._columns_of("previous_input", nu) - self._input_reference
        self._before = above(*(before.part(i, 0, 1, self._columns) if self._has("previous_input", i) else self._zeros(1)
                               for i in range(nu)))

    def _set_steady_state(self, disturbance):
        """Eq. 6: (A - I) x_ref + B u_ref = -B_d d, C x_ref = r."""
        A, B, B_d = self._system
        left = above(beside(A - Balls.identity(self._nx), B), beside(self._problem.C, Balls.zeros(self._nu, self._nu)))
        right = above((B_d @ disturbance).negated(), self._columns_of("reference", self._nu))
        steady = solved(left, right)
        self._state_reference = steady.part(0, 0, self._nx, self._columns)
        self._input_reference = steady.part(self._nx, 0, self._nu, self._columns)

    def _zeros(self, height):
        return Balls.zeros(height, self._columns)

    def _columns_of(self, role, height):
        """The parameters of a role; fixed ones count in the last column."""
        rows = [[Fraction(0)] * self._columns for _ in range(height)]
        column = self._n
        for parameter in self._problem.parameters:
            is_free = parameter.value is None
            if parameter.role == role:
                rows[parameter.index][column if is_free else -1] += 1 if is_free else parameter.value
            column += is_free
        return Balls.of(Matrix(rows, self._columns))

    def _has(self, role, index):
        return any((parameter.role, parameter.index) == (role, index) for parameter in self._problem.parameters)

    def run(self, beside_feedback):
        problem, residual, P = self._problem, Fraction(0), self._problem.P
        if P is None:
            P, residual = terminal_weight(self._system, problem.Q, problem.R)
        self._predict(feedback_gains(problem, self._system, P) if beside_feedback else None)
        for error, following, value, last in zip(self._errors, self._errors[1:], self._values, [self._before, *self._values]):
            self._add_cost(error, problem.Q)
            self._add_cost(value, problem.R)
            self._add_cost(value - last, problem.R_delta)
            self._add_ranges(following, problem.states)
        self._add_cost(self._errors[-1], P)
        for stage in accumulate([0, *problem.blocks[:-1]]):
            self._add_input(stage)
        self._add_terminal_set()
        for constraint in problem.constraints:
            self._add_constraint(constraint)
        program = self._cost + self._cost + self._weights_of_slacks
        first = self._input_reference + self._values[0]
        return ExpectedProgram(program.part(0, 0, self._n, self._n), program.part(0, self._n, self._n, self._p + 1),
                               first.part(0, self._n, self._nu, self._p + 1), self._rows, residual)

    def _predict(self, gains):
        """e_0 .. e_N and u~_0 .. u~_{N-1}"""
        self._errors, self._values = [self._error], []
        for block, length in enumerate(self._problem.blocks):
            own = self._zeros(self._nu)
            for i in range(self._nu):
                own.rows[i][block * self._nu + i] = UNIT
            for _ in range(length):
                error = self._errors[-1]
                if gains:
                    last = self._values[-1] if self._values else self._before
                    own = own - gains[block] @ above(error, last)
                self._values.append(own)
                self._errors.append(self._system.A @ error + self._system.B @ own + self._drift)

    def _add_cost(self, value, weight):
        """v'W v, without what does not depend on z."""
        on_z = value.part(0, 0, value.height, self._n)
        self._cost = self._cost + on_z.transposed() @ weight @ value

    def _add_row(self, value, i, sign, bound, slack=None, is_equality=False):
        """Row i of sign v <= sign bound, less a slack; none for an infinite bound."""
        if bound is None:
            return
        n, row = self._n, [sign * entry for entry in value.rows[i]]
        on_z = row[:n]
        if slack is not None:
            on_z[slack] = -UNIT
        exact = Balls.of(Matrix([[sign * bound]], 1))
        self._rows.append(ExpectedRow(on_z, [-entry for entry in row[n:-1]], exact.rows[0][0] - row[-1],
                                      value.radius + exact.radius, is_equality))

    def _add_ranges(self, value, ranges, slack=None):
        for i, (lower, upper) in enumerate(ranges):
            self._add_row(value, i, 1, upper, slack)
            self._add_row(value, i, -1, lower, slack)

    def _add_input(self, stage):
        """Bounds on u and on its change, once for each block."""
        value = self._values[stage]
        self._add_ranges(value + self._input_reference, self._problem.inputs)
        self._add_ranges(value - (self._values[stage - 1] if stage else self._before), self._problem.changes)

    def _add_terminal_set(self):
        last = self._errors[-1]
        for i, bound in enumerate(self._problem.t):
            self._add_row(self._problem.T @ last, i, 1, bound)
        for i in range(self._nx if self._problem.ends_at_reference else 0):
            self._add_row(last, i, 1, Fraction(0), is_equality=True)

    def _add_constraint(self, constraint):
        """Both sides of a soft bound share a slack, which is at least 0."""
        first, slack = 0 if constraint.has_input else 1, None
        for k in range(first, first + len(self._values)):
            if constraint.soft and (k == first or not constraint.soft.shares_slack):
                slack = self._add_slack(constraint.soft)
            value = constraint.on_x @ self._errors[k]
            if constraint.has_input:
                value = value + constraint.on_u @ self._values[k]
            if constraint.is_absolute:
                value = value + constraint.on_x @ self._state_reference + constraint.on_u @ self._input_reference
            self._add_ranges(value, [constraint.range], slack)

    def _add_slack(self, soft):
        """Its place in z. Without a linear weight it is at least 0 by itself."""
        place = self._next_slack
        self._next_slack += 1
        weights, added = Balls.of(Matrix([[2 * soft.quadratic, soft.linear]], 2)), self._zeros(self._n)
        added.rows[place][place], added.rows[place][-1] = weights.rows[0]
        added.radius = weights.radius
        self._weights_of_slacks = self._weights_of_slacks + added
        if soft.linear:
            on_z = [-UNIT if j == place else 0 for j in range(self._n)]
            self._rows.append(ExpectedRow(on_z, [0] * self._p, 0))
        return place


def feedback_gains(problem, system, P):
    """K_k of each stage, to about 100 digits; they have no errors of their own."""
    nx, nu = problem.B.height, problem.B.columns
    A = above(beside(system.A, Balls.zeros(nx, nu)), Balls.zeros(nu, nx + nu))
    B = above(system.B, Balls.identity(nu))
    # The cost of a change, (u~_k - u~_{k-1})'R_delta (u~_k - u~_{k-1}).
    Q = above(beside(problem.Q, Balls.zeros(nx, nu)), beside(Balls.zeros(nu, nx), problem.R_delta))
    cross = beside(Balls.zeros(nu, nx), problem.R_delta.negated())
    P = above(beside(P, Balls.zeros(nx, nu)), Balls.zeros(nu, nx + nu))
    gains = []
    for _ in problem.blocks:
        B_P = B.transposed() @ P
        right = B_P @ A + cross
        gains.append(solved(problem.R + problem.R_delta + B_P @ B, right).middle())
        P = (Q + A.transposed() @ P @ A - right.transposed() @ gains[-1]).middle()
    return gains[::-1]
