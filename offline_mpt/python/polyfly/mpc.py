"""A tracking problem stated in a few lines. What it builds is the text of a problem file."""
from ._polyfly import Error, parse_problem
from .statement import (Statement, column, head, matrix, number, ranges, row, rows, signal_lines, signals, state_signals,
                        weight)


class MPC(Statement):
    """Tracking MPC (Eq. 3, 4 and 38) of x' = A x + B u + Bd d, y = C x: continuous time, held for Ts seconds.

    Ts        sampling time [s]
    horizon   N
    C         tracked output, one row for each input
    Bd        effect of the disturbances
    states, inputs, disturbances
              names, or pairs (name, unit). States that are not named are called as their error parameters say.
    name      of the problem and its map

    `cost`, `bounds` and `parameters` return the object. `problem` checks it all, with the sentences of a problem file.
    """

    def __init__(self, A, B, Ts, horizon, C, *, Bd=None, states=None, inputs=None, disturbances=None, name="mpc",
                 description=""):
        self._A, self._B, self._C = matrix(A), column(B), matrix(C)
        self._Bd = None if Bd is None else column(Bd)
        self._period, self._horizon, self._name, self._description = Ts, horizon, name, description
        self._states, self._disturbances = states, disturbances
        self._inputs = signals(inputs, "u", self._B.shape[1])
        self._weights, self._bounds = None, (None, None)

    def cost(self, Q, R, R_delta=None, terminal="riccati"):
        """Weights of x - x_ref, u - u_ref and of the change of u: diagonals or matrices."""
        self._weights = (Q, R, R_delta, terminal)
        return self

    def bounds(self, x=None, u=None):
        """Pairs (lower, upper): of x - x_ref along the horizon, infinite where there is none; of u, required."""
        self._bounds = (x, u)
        return self

    def parameters(self, ranges_by_name):
        """The box of the law: {name: (lower, upper)}, in the order of theta.

        `e_STATE` is x - x_ref of a state (one for each), `INPUT_prev` the input one period ago, `INPUT_ref` the input
        that holds the reference.
        """
        return super().parameters(ranges_by_name)

    def text(self):
        """The problem file (YAML)."""
        if self._weights is None or self._bounds[1] is None or self._parameters is None:
            raise Error(f"{self._name}: cost, bounds of u and parameters must be given")
        states = state_signals(self._states, self._parameters, self._A.shape[0])
        lines = head(self._name, "tracking_mpc", self._description)
        lines += self._model_lines(states) + self._weight_lines() + self._parameter_lines(states)
        return "\n".join(lines) + "\n"

    def problem(self):
        """The Problem: checked, to be solved, saved or flown."""
        return parse_problem(self.text(), self._name)

    def _model_lines(self, states):
        lines = ["model:"]
        lines += signal_lines("states", states, ranges("x", self._bounds[0], len(states)))
        lines += signal_lines("inputs", self._inputs, ranges("u", self._bounds[1], len(self._inputs)))
        if self._Bd is not None:
            names = signals(self._disturbances, "d", self._Bd.shape[1])
            lines += signal_lines("disturbances", names, ranges("d", None, len(names))) + [f"  B_d: {rows(self._Bd)}"]
        return lines + [f"  A: {rows(self._A)}", f"  B: {rows(self._B)}", f"  C: {rows(self._C)}"]

    def _weight_lines(self):
        Q, R, R_delta, terminal = self._weights
        lines = [f"sampling_time: {number(self._period)}", f"horizon: {self._horizon}", "weights:",
                 f"  Q: {weight(Q)}", f"  R: {weight(R)}"]
        if R_delta is not None:
            lines.append(f"  R_delta: {weight(R_delta)}")
        return lines + [f"  terminal: {terminal}"]

    def _parameter_lines(self, states):
        owners = {f"e_{name}": ("error", name, unit) for name, unit in states}
        for name, unit in self._inputs:
            owners[f"{name}_prev"] = ("previous_input", name, unit)
            owners[f"{name}_ref"] = ("input_reference", name, unit)
        lines = ["parameters:"]
        for name, bounds in self._parameters.items():
            if name not in owners:
                raise Error(f"{self._name}: parameters: {name} is none of {', '.join(owners)}")
            role, of, unit = owners[name]
            lines.append(f"  - {{name: {name}, role: {role}, of: {of}, unit: '{unit}', range: {row(bounds)}}}")
        return lines
