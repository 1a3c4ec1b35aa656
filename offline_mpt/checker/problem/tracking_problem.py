"""A problem file of type tracking_mpc (region_maps/problems/README.md)."""
from collections import namedtuple
from fractions import Fraction

from balls import Balls
from exact import require
from fields import (Scalar, choice_of, count_of, document_of, items_of, list_of, matrix_of, number_of, number_or,
                    range_of, require_head, require_keys, weight_of)

MOST_STEPS = 200
# The kind of signal that a parameter of a role belongs to.
ROLES = {"error": "states", "previous_input": "inputs", "input_reference": "inputs", "state": "states",
         "state_reference": "states", "reference": "outputs", "disturbance": "disturbances"}
UNBOUNDED = (None, None)

# `index` is that of the state, input, output or disturbance. `value` is None for an entry of theta.
Parameter = namedtuple("Parameter", "role index range value")
# The range, whose ends are None without a bound, holds on_x x_k + on_u u_k, or the same of the errors.
Constraint = namedtuple("Constraint", "on_x on_u has_input is_absolute range soft")
# One slack for all stages, or one for each.
Soft = namedtuple("Soft", "linear quadratic shares_slack")


class TrackingProblem:
    """x' or x_{k+1} = A x + B u + B_d d, y = C x. Refuses keys that are not known."""

    def __init__(self, text):
        root = document_of(text)
        require("H" not in root, "problem: is a program in JSON, which is no problem of type tracking_mpc")
        require_head(root, "tracking_mpc", "provenance model sampling_time horizon moves control_horizon "
                                           "weights terminal_set constraints parameters")
        self._read_model(root["model"])
        self.sampling_time = number_of(root["sampling_time"])
        require(self.sampling_time > 0, "problem: sampling_time is out of range")
        self.blocks = blocks_of(root)
        self._read_weights(root["weights"])
        self.terminal_set = terminal_set_of(root.get("terminal_set"), self.size[0])
        known = "of name unit range lower upper measured_from soft"
        self.constraints = [self._constraint(node) for node in items_of(root, "constraints", known)]
        known = "name role of unit range value"
        self.parameters = [self._parameter(node) for node in items_of(root, "parameters", known)]
        # Those that are entries of theta.
        self.free = [parameter for parameter in self.parameters if parameter.value is None]

    @property
    def size(self):
        """Numbers of states and inputs."""
        return len(self.states), len(self.inputs)

    def _read_model(self, model):
        require_keys(model, "time states inputs disturbances outputs A B B_d C delay")
        states = items_of(model, "states", "name unit range")
        inputs = items_of(model, "inputs", "name unit range change")
        require(states and inputs, "problem: there are no states or inputs")
        self.states = [ends_of(state, "range") for state in states]
        self.inputs = [range_of(entry["range"]) for entry in inputs]
        self.changes = [ends_of(entry, "change") for entry in inputs]
        self.is_discrete = choice_of(model, "time", "continuous", "discrete") == "discrete"
        nx, nu = self.size
        C = matrix_of(model["C"], nu, nx)
        disturbances = items_of(model, "disturbances", "name unit range")
        lists = {"states": states, "inputs": inputs, "disturbances": disturbances,
                 # An output without a name of its own has that of the state which it is.
                 "outputs": items_of(model, "outputs", "name unit range") or named_by_states(C, states)}
        self._names = {kind: [item["name"] for item in items] for kind, items in lists.items()}
        self.A, self.B, self.C = (Balls.of(matrix) for matrix in (
            matrix_of(model["A"], nx, nx), matrix_of(model["B"], nx, nu), C))
        # A model without disturbances has one without effect.
        nd = len(disturbances)
        self.B_d = Balls.of(matrix_of(model["B_d"], nx, nd)) if nd else Balls.zeros(nx, 1)

    def _read_weights(self, weights):
        require_keys(weights, "Q R R_delta terminal")
        nx, nu = self.size
        self.Q, self.R = Balls.of(weight_of(weights["Q"], nx)), Balls.of(weight_of(weights["R"], nu))
        zeros = [Scalar("0")] * nu
        self.R_delta = Balls.of(weight_of(weights.get("R_delta", zeros), nu))
        # None: that of the Riccati equation.
        is_given = isinstance(weights.get("terminal"), list)
        self.P = Balls.of(weight_of(weights["terminal"], nx)) if is_given else None
        choices = "riccati", "equality"
        self.ends_at_reference = not is_given and choice_of(weights, "terminal", *choices) == "equality"

    def _place(self, kind, name):
        require(name in self._names[kind], f"problem: {name} is not known to this checker")
        return self._names[kind].index(name)

    def _constraint(self, node):
        of = node["of"]
        terms = of if isinstance(of, dict) else {of: Scalar("1")}
        on = {"states": [Fraction(0)] * self.size[0], "inputs": [Fraction(0)] * self.size[1]}
        for name, factor in terms.items():
            kind = "states" if name in self._names["states"] else "inputs"
            on[kind][self._place(kind, name)] = number_of(factor)
        lower, upper = ends_of(node, "range")
        return Constraint(Balls.of([on["states"]]), Balls.of([on["inputs"]]),
                          any(name not in self._names["states"] for name in terms),
                          choice_of(node, "measured_from", "zero", "reference") == "zero",
                          (number_or(node, "lower", lower), number_or(node, "upper", upper)),
                          soft_of(node["soft"]) if "soft" in node else None)

    def _parameter(self, node):
        role, value = node["role"], number_or(node, "value", None)
        require(role in ROLES, "problem: a role is not known to this checker")
        place = self._place(ROLES[role], node["of"])
        return Parameter(role, place, range_of(node["range"]) if value is None else UNBOUNDED, value)


def ends_of(node, key):
    return range_of(node[key]) if key in node else UNBOUNDED


def named_by_states(C, states):
    units = [[int(i == j) for j in range(len(states))] for i in range(len(states))]
    return [states[units.index(row)] if row in units else {"name": None} for row in C]


def terminal_set_of(node, nx):
    """T e_N <= t, as pairs of rows."""
    if node is None:
        return []
    require_keys(node, "T t")
    T = matrix_of(node["T"], len(node["T"]), nx)
    return [(Balls.of([row]), bound) for row, bound in zip(T, list_of(node["t"], len(T)))]


def soft_of(node):
    require_keys(node, "linear quadratic slack")
    return Soft(number_or(node, "linear", Fraction(0)), number_of(node["quadratic"]),
                choice_of(node, "slack", "stage", "horizon") == "horizon")


def blocks_of(root):
    """Lengths of the blocks over which u is held."""
    horizon = count_of(root["horizon"])
    require(1 <= horizon <= MOST_STEPS, "problem: horizon is out of range")
    if "moves" in root:
        blocks = list_of(root["moves"], len(root["moves"]), count_of)
    else:
        count = count_of(root["control_horizon"]) if "control_horizon" in root else horizon
        blocks = [1] * (count - 1) + [1 + horizon - count]
    require(min(blocks, default=0) >= 1, "problem: a block of moves, or control_horizon, is out of range")
    require(sum(blocks) == horizon, "problem: moves do not add up to the horizon")
    return blocks
