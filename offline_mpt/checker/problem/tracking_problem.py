"""A problem file of type tracking_mpc (region_maps/problems/README.md)."""
from collections import namedtuple
from fractions import Fraction

from balls import Balls
from exact import Matrix, require
from fields import (choice_of, column_of, count_of, document_of, items_of, matrix_of, number_of, number_or, range_of,
                    require_head, require_keys, weight_of, word_of)

MOST_STEPS = 200
# The kind of signal that a parameter of a role belongs to.
ROLES = {"error": "state", "previous_input": "input", "input_reference": "input", "state_reference": "state",
         "state": "state", "reference": "output", "disturbance": "disturbance"}
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
        require(isinstance(root, dict), "problem: an entry has no keys")
        require("H" not in root, "problem: is a program in JSON, whose numbers check_certificate --problem compares")
        require_head(root, "tracking_mpc", "provenance model sampling_time horizon moves control_horizon weights terminal_set "
                                           "constraints parameters")
        self._read_signals(root["model"])
        self._read_model(root["model"])
        self.sampling_time = number_of(root["sampling_time"])
        require(self.sampling_time > 0, "problem: sampling_time is out of range")
        self.blocks = blocks_of(root)
        self._read_weights(root["weights"])
        self._read_terminal_set(root.get("terminal_set"))
        self.constraints = [self._constraint(node) for node in items_of(root, "constraints")]
        self.parameters = [self._parameter(node) for node in items_of(root, "parameters")]

    @property
    def free(self):
        """Parameters that are entries of theta."""
        return [parameter for parameter in self.parameters if parameter.value is None]

    def _place(self, kind, name):
        require(name in self._names[kind], f"problem: {name} is not known to this checker")
        return self._names[kind].index(name)

    def _read_signals(self, model):
        require_keys(model, "time states inputs disturbances outputs A B B_d C delay")
        lists = {kind: items_of(model, kind + "s") for kind in ("state", "input", "disturbance", "output")}
        self._names = {kind: [word_of(node["name"]) for node in nodes] for kind, nodes in lists.items()}
        for state in lists["state"]:
            require_keys(state, "name unit range")
        for entry in lists["input"]:
            require_keys(entry, "name unit range change")
        self.states = [ends_of(state, "range") for state in lists["state"]]
        self.inputs = [range_of(entry["range"]) for entry in lists["input"]]
        self.changes = [ends_of(entry, "change") for entry in lists["input"]]
        require(self.states and self.inputs, "problem: there are no states or inputs")

    def _read_model(self, model):
        nx, nu, nd = len(self.states), len(self.inputs), len(self._names["disturbance"])
        self.is_discrete = choice_of(model, "time", ("continuous", "discrete")) == "discrete"
        outputs = matrix_of(model["C"], nu, nx)
        self.A = Balls.of(matrix_of(model["A"], nx, nx))
        self.B = Balls.of(matrix_of(model["B"], nx, nu))
        self.B_d = Balls.of(matrix_of(model["B_d"], nx, nd)) if "B_d" in model else Balls.zeros(nx, 0)
        self.C = Balls.of(outputs)
        if "outputs" not in model:
            # An output without a name of its own has that of the state which it is.
            units = [[int(i == j) for j in range(nx)] for i in range(nx)]
            self._names["output"] = [self._names["state"][units.index(row)] if row in units else None
                                     for row in outputs.rows]

    def _read_weights(self, weights):
        require_keys(weights, "Q R R_delta terminal")
        nx, nu = len(self.states), len(self.inputs)
        self.Q = Balls.of(weight_of(weights["Q"], nx))
        self.R = Balls.of(weight_of(weights["R"], nu))
        self.R_delta = Balls.of(weight_of(weights["R_delta"], nu)) if "R_delta" in weights else Balls.zeros(nu, nu)
        # None: that of the Riccati equation.
        self.P, self.ends_at_reference = None, False
        if isinstance(weights.get("terminal"), list):
            self.P = Balls.of(weight_of(weights["terminal"], nx))
        else:
            self.ends_at_reference = choice_of(weights, "terminal", ("riccati", "equality")) == "equality"

    def _read_terminal_set(self, node):
        """T e_N <= t"""
        nx = len(self.states)
        self.T, self.t = Balls.zeros(0, nx), []
        if node is not None:
            require_keys(node, "T t")
            self.T = Balls.of(matrix_of(node["T"], len(node["T"]), nx))
            self.t = column_of(node["t"], len(node["T"])).entries()

    def _constraint(self, node):
        require_keys(node, "of name unit range lower upper measured_from soft")
        of = node["of"]
        terms = of if isinstance(of, dict) else {word_of(of): None}
        on = {"state": [Fraction(0)] * len(self.states), "input": [Fraction(0)] * len(self.inputs)}
        for name, factor in terms.items():
            kind = "state" if name in self._names["state"] else "input"
            on[kind][self._place(kind, name)] = Fraction(1) if factor is None else number_of(factor)
        lower, upper = ends_of(node, "range")
        return Constraint(*(Balls.of(Matrix([row], len(row))) for row in on.values()),
                          any(name not in self._names["state"] for name in terms),
                          choice_of(node, "measured_from", ("zero", "reference")) == "zero",
                          (number_or(node, "lower", lower), number_or(node, "upper", upper)),
                          soft_of(node["soft"]) if "soft" in node else None)

    def _parameter(self, node):
        require_keys(node, "name role of unit range value")
        role = word_of(node["role"])
        require(role in ROLES, "problem: a role is not known to this checker")
        value = number_or(node, "value", None)
        return Parameter(role, self._place(ROLES[role], node["of"]),
                         range_of(node["range"]) if value is None else UNBOUNDED, value)


def ends_of(node, key):
    return range_of(node[key]) if key in node else UNBOUNDED


def soft_of(node):
    require_keys(node, "linear quadratic slack")
    return Soft(number_or(node, "linear", Fraction(0)), number_of(node["quadratic"]),
                choice_of(node, "slack", ("stage", "horizon")) == "horizon")


def blocks_of(root):
    """Lengths of the blocks over which u is held."""
    horizon = count_of(root["horizon"])
    require(1 <= horizon <= MOST_STEPS, "problem: horizon is out of range")
    if "moves" in root:
        blocks = [count_of(node) for node in items_of(root, "moves")]
    else:
        count = count_of(root["control_horizon"]) if "control_horizon" in root else horizon
        require(1 <= count <= horizon, "problem: control_horizon is out of range")
        blocks = [1] * (count - 1) + [1 + horizon - count]
    require(all(1 <= length <= horizon for length in blocks), "problem: moves: a block is out of range")
    require(sum(blocks) == horizon, "problem: moves do not add up to the horizon")
    return blocks
