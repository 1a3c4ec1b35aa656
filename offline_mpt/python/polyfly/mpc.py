"""A tracking problem stated in a few lines. What it builds is the text of a problem file."""
from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ._polyfly import Error, Problem, parse_problem
from .statement import (Statement, column, head, matrix, number, ranges, row, rows, signal_lines, signals, state_signals,
                        weight)

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from .statement import Names, Range, Softness


class MPC(Statement):
    """Tracking MPC (Eq. 3, 4 and 38) of x' = A x + B u + Bd d, y = C x.

    time      of A, B and Bd: "continuous", held for Ts seconds, or "discrete", x_{k+1} = A x_k + B u_k + Bd d_k
    Ts        sampling time [s]
    horizon   N
    C         tracked output, one row for each input
    Bd        effect of the disturbances
    states, inputs, disturbances
              names, or pairs (name, unit). States that are not named are called as their error parameters say.
    name      of the problem and its map

    `cost`, `bounds` and `parameters` return the object. `problem` checks it all, with the sentences of a problem file.
    """

    def __init__(self, A: ArrayLike, B: ArrayLike, Ts: float, horizon: int, C: ArrayLike, *, Bd: ArrayLike | None = None,
                 time: str = "continuous", states: Names = None, inputs: Names = None, disturbances: Names = None,
                 name: str = "mpc", description: str = "") -> None:
        self._A, self._B, self._C = matrix(A), column(B), matrix(C)
        self._Bd = None if Bd is None else column(Bd)
        self._time, self._period, self._horizon, self._name, self._description = time, Ts, horizon, name, description
        self._states, self._disturbances = states, disturbances
        self._inputs = signals(inputs, "u", self._B.shape[1])
        self._weights, self._bounds, self._constraints = None, (None, None, None, None), []

    def cost(self, Q: ArrayLike, R: ArrayLike, R_delta: ArrayLike | None = None, terminal: str | ArrayLike = "riccati") -> MPC:
        """Weights of x - x_ref, u - u_ref and of the change of u: diagonals or matrices.

        terminal    weight at the end of the horizon, as Q; "riccati": the solution of the Riccati equation
        """
        self._weights = (Q, R, R_delta, terminal)
        return self

    def bounds(self, x: Range | None = None, u: Range | None = None, e: Range | None = None, soft: Softness = None) -> MPC:
        """Pairs (lower, upper) of numbers or lists, or a list of such pairs, one for each signal; infinite where there is none.

        x       of x itself along the horizon. Where u_ref is a parameter, `STATE_ref` must be one too
        u       of u, required
        e       of x - x_ref along the horizon
        soft    the bounds of x may be exceeded by v, at the cost w v + 1e-3 w v^2 for a number w; or a dict with
                "linear", "quadratic" and "slack" (region_maps/problems/README.md)
        """
        self._bounds = (x, u, e, soft)
        return self

    def constraint(self, of: str | Mapping[str, float], lower: float = -np.inf, upper: float = np.inf, *, name: str | None = None,
                   unit: str | None = None, soft: Softness = None, measured_from: str = "zero") -> MPC:
        """Adds a bound on one state or input, or on a sum {name: coefficient}, which needs a name and a unit.

        soft             as for `bounds`
        measured_from    "zero", or "reference": bounds on x - x_ref and u - u_ref
        """
        subject = of if isinstance(of, str) else "{" + ", ".join(f"{key}: {number(c)}" for key, c in of.items()) + "}"
        parts = [f"of: {subject}"] + [f"{key}: {value}" for key, value in (("name", name), ("unit", unit)) if value]
        parts += _ends(lower, upper)
        if soft is not None:
            parts.append(f"soft: {_softness(soft)}")
        self._constraints.append("  - {" + ", ".join(parts) + f", measured_from: {measured_from}}}")
        return self

    def parameters(self, ranges_by_name: Mapping[str, tuple[float, float] | float]) -> MPC:
        """The box of the law: {name: (lower, upper)}, in the order of theta.

        `e_STATE` is x - x_ref of a state (one for each), `INPUT_prev` the input one period ago, `INPUT_ref` the input
        that holds the reference, `STATE_ref` x_ref, for bounds on x itself. A number in place of a range fixes the
        parameter: it is no entry of theta.
        """
        return super().parameters(ranges_by_name)

    def text(self) -> str:
        """The problem file (YAML)."""
        if self._weights is None or self._bounds[1] is None or self._parameters is None:
            raise Error(f"{self._name}: cost, bounds of u and parameters must be given")
        states = state_signals(self._states, self._parameters, self._A.shape[0])
        lines = head(self._name, "tracking_mpc", self._description)
        lines += self._model_lines(states) + self._weight_lines() + self._constraint_lines(states)
        lines += self._parameter_lines(states)
        return "\n".join(lines) + "\n"

    def problem(self) -> Problem:
        """The Problem: checked, to be solved, saved or flown."""
        return parse_problem(self.text(), self._name)

    def _model_lines(self, states):
        lines = ["model:"] + ([] if self._time == "continuous" else [f"  time: {self._time}"])
        lines += signal_lines("states", states, ranges("e", self._bounds[2], len(states)))
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
        return lines + [f"  terminal: {terminal if isinstance(terminal, str) else weight(terminal)}"]

    def _constraint_lines(self, states):
        ends = ranges("x", self._bounds[0], len(states))
        soft = [] if self._bounds[3] is None else [f"soft: {_softness(self._bounds[3])}"]
        bounded = [(name, _ends(lower, upper)) for (name, _), (lower, upper) in zip(states, ends)]
        lines = ["  - {" + ", ".join([f"of: {name}", *sides, *soft]) + "}" for name, sides in bounded if sides]
        lines += self._constraints
        return ["constraints:"] + lines if lines else []

    def _parameter_lines(self, states):
        owners = {f"e_{name}": ("error", name, unit) for name, unit in states}
        owners.update({f"{name}_ref": ("state_reference", name, unit) for name, unit in states})
        for name, unit in self._inputs:
            owners[f"{name}_prev"] = ("previous_input", name, unit)
            owners[f"{name}_ref"] = ("input_reference", name, unit)
        lines = ["parameters:"]
        for name, bounds in self._parameters.items():
            if name not in owners:
                raise Error(f"{self._name}: parameters: {name} is none of {', '.join(owners)}")
            role, of, unit = owners[name]
            box = f"value: {number(bounds)}" if np.ndim(bounds) == 0 else f"range: {row(bounds)}"
            lines.append(f"  - {{name: {name}, role: {role}, of: {of}, unit: '{unit}', {box}}}")
        return lines


def _ends(lower, upper):
    """The keys of the finite ends of a bound."""
    sides = [f"{key}: {number(end)}" for key, end in (("lower", lower), ("upper", upper)) if not np.isinf(end)]
    return sides if len(sides) < 2 else [f"range: {row((lower, upper))}"]


def _softness(soft):
    if not isinstance(soft, dict):
        soft = {"linear": soft, "quadratic": 1e-3 * soft}
    return "{" + ", ".join(f"{key}: {value if key == 'slack' else number(value)}" for key, value in soft.items()) + "}"
