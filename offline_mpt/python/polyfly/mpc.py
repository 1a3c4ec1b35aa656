"""A tracking problem stated in a few lines. What it builds is the text of a problem file."""
import numpy as np

from ._polyfly import Error, parse_problem


def _number(value):
    return repr(float(value))


def _row(values):
    return "[" + ", ".join(_number(value) for value in values) + "]"


def _matrix(value):
    return "[" + ", ".join(_row(row) for row in np.atleast_2d(np.asarray(value, dtype=float))) + "]"


def _weight(value):
    """The diagonal, or a symmetric matrix as rows."""
    value = np.atleast_1d(np.asarray(value, dtype=float))
    return _row(value) if value.ndim == 1 else _matrix(value)


def _column(value):
    """A matrix; a list is one column."""
    value = np.asarray(value, dtype=float)
    return value.reshape(-1, 1) if value.ndim == 1 else value


def _ranges(name, bounds, count):
    """`count` pairs (lower, upper) out of a pair of numbers or lists; infinite where there is none."""
    if bounds is None:
        return [(-np.inf, np.inf)] * count
    try:
        lower, upper = (np.broadcast_to(np.asarray(side, dtype=float), count) for side in bounds)
    except (TypeError, ValueError) as error:
        raise Error(f"MPC: bounds: {name} must be a pair (lower, upper) of numbers, or of lists of {count}") from error
    return list(zip(lower, upper))


def _signals(named, prefix, count):
    """Pairs (name, unit) out of names or such pairs."""
    if named is None:
        named = [prefix] if count == 1 else [f"{prefix}_{index}" for index in range(count)]
    pairs = [(entry, "1") if isinstance(entry, str) else tuple(entry) for entry in named]
    if len(pairs) != count:
        raise Error(f"MPC: {prefix}: must name {count}, got {len(pairs)}")
    return pairs


class MPC:
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
        self._A, self._B = np.atleast_2d(np.asarray(A, dtype=float)), _column(B)
        self._C = np.atleast_2d(np.asarray(C, dtype=float))
        self._Bd = None if Bd is None else _column(Bd)
        self._period, self._horizon, self._name, self._description = Ts, horizon, name, description
        self._states, self._disturbances = states, disturbances
        self._inputs = _signals(inputs, "u", self._B.shape[1])
        self._weights, self._bounds, self._parameters = None, (None, None), None

    def cost(self, Q, R, R_delta=None, terminal="riccati"):
        """Weights of x - x_ref, u - u_ref and of the change of u: diagonals or matrices."""
        self._weights = (Q, R, R_delta, terminal)
        return self

    def bounds(self, x=None, u=None):
        """Pairs (lower, upper): of x - x_ref along the horizon, infinite where there is none; of u, required."""
        self._bounds = (x, u)
        return self

    def parameters(self, ranges):
        """The box of the law: {name: (lower, upper)}, in the order of theta.

        `e_STATE` is x - x_ref of a state (one for each), `INPUT_prev` the input one period ago, `INPUT_ref` the input
        that holds the reference.
        """
        self._parameters = dict(ranges)
        return self

    def text(self):
        """The problem file (YAML)."""
        if self._weights is None or self._bounds[1] is None or self._parameters is None:
            raise Error(f"{self._name}: cost, bounds of u and parameters must be given")
        states = self._state_signals()
        lines = ["polyfly_problem: 1", f"name: {self._name}", "type: tracking_mpc"]
        if self._description:
            lines.append("description: '" + self._description.replace("'", "''") + "'")
        lines += self._model_lines(states) + self._weight_lines() + self._parameter_lines(states)
        return "\n".join(lines) + "\n"

    def problem(self):
        """The Problem: checked, to be solved, saved or flown."""
        return parse_problem(self.text(), self._name)

    def explicit(self, parameters=None, **options):
        """The Map of the problem; options are those of Problem.solve."""
        if parameters is not None:
            self.parameters(parameters)
        return self.problem().solve(**options)

    def online(self, parameters=None):
        """The problem for solutions at single parameters."""
        if parameters is not None:
            self.parameters(parameters)
        return self.problem().online()

    def save(self, path):
        """Writes the problem file, for `offline_mpt solve`."""
        self.problem().save(path)

    def _state_signals(self):
        count = self._A.shape[0]
        errors = [name[2:] for name in self._parameters if name.startswith("e_")]
        return _signals(errors if self._states is None and len(errors) == count else self._states, "x", count)

    def _model_lines(self, states):
        lines = ["model:", "  states:"]
        for (name, unit), (lower, upper) in zip(states, _ranges("x", self._bounds[0], len(states))):
            bounded = np.isfinite(lower) or np.isfinite(upper)
            range_text = f", range: {_row((lower, upper))}" if bounded else ""
            lines.append(f"    - {{name: {name}, unit: '{unit}'{range_text}}}")
        lines.append("  inputs:")
        for (name, unit), bounds in zip(self._inputs, _ranges("u", self._bounds[1], len(self._inputs))):
            lines.append(f"    - {{name: {name}, unit: '{unit}', range: {_row(bounds)}}}")
        if self._Bd is not None:
            lines.append("  disturbances:")
            for name, unit in _signals(self._disturbances, "d", self._Bd.shape[1]):
                lines.append(f"    - {{name: {name}, unit: '{unit}'}}")
            lines.append(f"  B_d: {_matrix(self._Bd)}")
        return lines + [f"  A: {_matrix(self._A)}", f"  B: {_matrix(self._B)}", f"  C: {_matrix(self._C)}"]

    def _weight_lines(self):
        Q, R, R_delta, terminal = self._weights
        lines = [f"sampling_time: {_number(self._period)}", f"horizon: {self._horizon}", "weights:",
                 f"  Q: {_weight(Q)}", f"  R: {_weight(R)}"]
        if R_delta is not None:
            lines.append(f"  R_delta: {_weight(R_delta)}")
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
            lines.append(f"  - {{name: {name}, role: {role}, of: {of}, unit: '{unit}', range: {_row(bounds)}}}")
        return lines
