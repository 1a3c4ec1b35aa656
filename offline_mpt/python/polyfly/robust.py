"""A minimum-peak robust problem stated in a few lines. What it builds is the text of a problem file."""
from __future__ import annotations

from typing import TYPE_CHECKING

from ._polyfly import Error, RobustProblem, parse_robust_problem
from .statement import (Statement, column, head, matrix, number, ranges, row, rows, signal_lines, signals, state_signals,
                        weight)

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from .statement import Exact, Names, Range


class RobustMPC(Statement):
    """Minimum-peak robust MPC (Eq. 8 and 34) of x' = A x + B u + G w: the least guaranteed peak of C (x - x_ref).

    All bounds hold for every w in its range. There is one input. Numbers count as they print: 0.1 is one tenth.
    Fractions may be given as fractions.Fraction or as text, "1/3".

    Ts        sampling time [s]
    horizon   N
    C         outputs whose greatest peak is minimised, a row each
    time      of A, B and G: "continuous", held for Ts seconds, or "discrete"
    bits      discretised matrices and computed gains are rounded to 2^-bits
    stack, invariance, floor, peak_in_map
              keys of the problem file (offline_mpt/robust/README.md)
    states, inputs, disturbances
              names, or pairs (name, unit). States that are not named are called as their error parameters say.
    name      of the problem and its map

    `tie_break`, `bounds` and `parameters` must be called. They return the object, as `feedback` and `reference` do.
    `problem` checks it all, with the sentences of a problem file.
    """

    def __init__(self, A: ArrayLike, B: ArrayLike, G: ArrayLike, Ts: Exact, horizon: int, C: ArrayLike, *,
                 time: str = "continuous", bits: int | None = None, stack: str | None = None, invariance: str | None = None,
                 floor: Exact | None = None, peak_in_map: bool | None = None, states: Names = None, inputs: Names = None,
                 disturbances: Names = None, name: str = "robust_mpc", description: str = "") -> None:
        self._A, self._B, self._G, self._C = matrix(A), column(B), column(G), matrix(C)
        self._period, self._horizon, self._time, self._bits = Ts, horizon, time, bits
        self._options = {"stack": stack, "invariance": invariance, "floor": None if floor is None else number(floor),
                         "peak_in_map": None if peak_in_map is None else str(bool(peak_in_map)).lower()}
        self._states, self._name, self._description = states, name, description
        self._inputs = signals(inputs, "u", self._B.shape[1])
        self._disturbances = signals(disturbances, "w", self._G.shape[1])
        self._bounds, self._tie_break, self._references = None, None, {}

    def tie_break(self, Q: ArrayLike | None = None, R: ArrayLike | None = None, gain: ArrayLike | None = None) -> RobustMPC:
        """Of several optimal inputs, the nearest to K e: K = `gain`, or that of the LQR with weights Q and R."""
        self._tie_break = _gain_text(gain, Q, R)
        return self

    def feedback(self, predictions: str, Q: ArrayLike | None = None, R: ArrayLike | None = None,
                 gain: ArrayLike | None = None) -> RobustMPC:
        """Feedback in the predictions: "free", "zero", or "fixed" to that of a gain, by default that of `tie_break`."""
        self._options["feedback_predictions"] = predictions
        given = gain is not None or Q is not None or R is not None
        self._options["feedback_gain"] = _gain_text(gain, Q, R) if given else None
        return self

    def bounds(self, u: Range, w: Range, x: Range | None = None) -> RobustMPC:
        """Pairs (lower, upper) of u, of the disturbances w, and of x along the horizon, infinite where there is none."""
        self._bounds = (x, u, w)
        return self

    def reference(self, name: str, state: ArrayLike, input: ArrayLike, unit: str = "1") -> RobustMPC:
        """A parameter r that moves the reference: x = e + state * r, u = u~ + input * r."""
        self._references[name] = (state, input, unit)
        return self

    def parameters(self, ranges_by_name: Mapping[str, tuple[Exact, Exact]]) -> RobustMPC:
        """The box of the law: {name: (lower, upper)}, in the order of theta.

        `e_STATE` is x - x_ref of a state (one for each). Others are names given to `reference`.
        """
        return super().parameters(ranges_by_name)

    def text(self) -> str:
        """The problem file (YAML)."""
        if self._tie_break is None or self._bounds is None or self._parameters is None:
            raise Error(f"{self._name}: tie_break, bounds of u and w, and parameters must be given")
        states = state_signals(self._states, self._parameters, self._A.shape[0])
        lines = head(self._name, "robust_mpc", self._description) + self._model_lines(states)
        lines += [f"sampling_time: {number(self._period)}", f"horizon: {self._horizon}"]
        lines += [f"{key}: {value}" for key, value in self._options.items() if value is not None]
        lines += [f"tie_break: {self._tie_break}"] + self._parameter_lines(states)
        return "\n".join(lines) + "\n"

    def problem(self) -> RobustProblem:
        """The RobustProblem: checked, to be solved, saved or flown."""
        return parse_robust_problem(self.text(), self._name)

    def _model_lines(self, states):
        lines = ["model:"]
        for title, letter, pairs, bounds in zip(("states", "inputs", "disturbances"), "xuw",
                                                (states, self._inputs, self._disturbances), self._bounds):
            lines += signal_lines(title, pairs, ranges(letter, bounds, len(pairs)))
        lines += [f"  {key}: {rows(value)}" for key, value in
                  (("A", self._A), ("B", self._B), ("G", self._G), ("C", self._C))]
        return lines + [f"  time: {self._time}"] + ([] if self._bits is None else [f"  bits: {self._bits}"])

    def _parameter_lines(self, states):
        owners = {f"e_{name}": (name, unit) for name, unit in states}
        lines = ["parameters:"]
        for name, ends in self._parameters.items():
            if name in owners:
                of, unit = owners[name]
                lines.append(f"  - {{name: {name}, role: error, of: {of}, unit: '{unit}', range: {row(ends)}}}")
            elif name in self._references:
                state, held, unit = self._references[name]
                lines.append(f"  - {{name: {name}, role: reference, unit: '{unit}', range: {row(ends)}, "
                             f"state: {row(matrix(state)[0])}, input: {row(matrix(held)[0])}}}")
            else:
                known = ", ".join([*owners, *self._references])
                raise Error(f"{self._name}: parameters: {name} is none of {known}")
        return lines


def _gain_text(gain, Q, R):
    parts = [f"gain: {rows(matrix(gain))}"] if gain is not None else []
    parts += [f"{key}: {weight(value)}" for key, value in (("Q", Q), ("R", R)) if value is not None]
    return "{" + ", ".join(parts) + "}"
