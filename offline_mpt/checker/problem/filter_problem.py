"""A problem file of type safety_filter with its safe set (offline_mpt/safety/README.md)."""
from fractions import Fraction

from balls import UNIT, Balls
from exact import Matrix, Refused, require
from fields import (column_of, document_of, filled_range, items_of, matrix_of, number_of, number_or, require_head,
                    require_keys)
from expected_program import ExpectedProgram, ExpectedRow
from program_match import Match

# What a file says that does not say it.
INPUT_ERROR = Fraction(1e-6)
MARGIN = Fraction(1e-4)
MOST_STATES, MOST_INPUTS, MOST_ROWS = 6, 3, 400


class FilterProblem:
    """x' = A x + B u + B_d d, and S = {xi: H xi <= k}. An input is admissible where G u <= b + M xi; xi is the state, with a
    delay also the input before. Refuses keys that are not known."""

    def __init__(self, text):
        root = document_of(text)
        require_head(root, "safety_filter", "model sampling_time delay margin safe_set")
        model = root["model"]
        require_keys(model, "states inputs disturbances A B B_d")
        self._read_signals(model)
        nx, nd = len(self.states), len(self.disturbances)
        self.A = Balls.of(matrix_of(model["A"], nx, nx))
        self.B = Balls.of(matrix_of(model["B"], nx, len(self.inputs)))
        require("B_d" in model or nd == 0, "problem: B_d is missing")
        self.B_d = Balls.of(matrix_of(model.get("B_d", [[] for _ in range(nx)]), nx, nd))
        self.sampling_time = number_of(root["sampling_time"])
        self.delay = number_or(root, "delay", Fraction(0))
        self.margin = number_or(root, "margin", MARGIN)
        require(0 <= self.delay <= self.sampling_time > 0 < self.margin,
                "problem: sampling_time, delay or margin is out of range")
        require("safe_set" in root, "problem: safe_set is missing")
        self._read_safe_set(root["safe_set"])

    @property
    def size(self):
        """Of xi."""
        return len(self.states) + (len(self.inputs) if self.delay else 0)

    def _read_signals(self, model):
        self.states, self.state_errors = [], []
        for state in items_of(model, "states"):
            require_keys(state, "name unit range error")
            self.states.append(filled_range(state["range"]))
            self.state_errors.append(_error_of(state, Fraction(0)))
        self.inputs, self.wishes, self.weights, self.input_errors = [], [], [], []
        for entry in items_of(model, "inputs"):
            require_keys(entry, "name unit range wish weight error")
            self.inputs.append(filled_range(entry["range"]))
            self.wishes.append(filled_range(entry.get("wish", entry["range"])))
            self.weights.append(number_or(entry, "weight", Fraction(1)))
            require(self.weights[-1] > 0, "problem: a weight is not positive")
            self.input_errors.append(_error_of(entry, INPUT_ERROR))
        self.disturbances = []
        for disturbance in items_of(model, "disturbances"):
            require_keys(disturbance, "name unit range")
            self.disturbances.append(filled_range(disturbance["range"]))
        require(1 <= len(self.states) <= MOST_STATES, "problem: 1 to 6 states are allowed")
        require(1 <= len(self.inputs) <= MOST_INPUTS, "problem: 1 to 3 inputs are allowed")

    def _read_safe_set(self, node):
        require_keys(node, "H k G b M")
        height = len(node["H"])
        require(height <= MOST_ROWS, "problem: safe_set has too many rows")
        self.H = matrix_of(node["H"], height, self.size)
        self.G = matrix_of(node["G"], height, len(self.inputs))
        self.M = matrix_of(node["M"], height, self.size)
        self.k, self.b = (column_of(node[key], height).entries() for key in "kb")


def _error_of(node, absent):
    error = number_or(node, "error", absent)
    require(error >= 0, "problem: an error is negative")
    return error


def is_completed_text(whole, file):
    """Whether `whole` is the text of a problem file, followed by the key safe_set and nothing else."""
    rest = whole[len(file):]
    if not whole.startswith(file) or not (file.endswith("\n") or rest.startswith("\n")):
        return False
    try:
        added = document_of(rest)
    except Refused:
        return False
    return isinstance(added, dict) and list(added) == ["safe_set"]


def match_filter(certificate, problem):
    """Shows that the program of a certificate is that of a safety filter and its safe set, number by number."""
    require(not certificate.equalities, "a safety filter has no equalities")
    before = problem.inputs if problem.delay else []
    Match(certificate, [*problem.states, *before, *problem.wishes], filter_program(problem), Fraction(0))


def filter_program(problem):
    """Minimise sum of weight (u - wish)^2 / 2 over z = u, theta = (xi, wish)."""
    n, nu = problem.size, len(problem.inputs)
    H, F = Balls.zeros(nu, nu), Balls.zeros(nu, n + nu + 1)
    weights, bounds = (Balls.of(Matrix([values], len(values))) for values in (problem.weights, problem.b))
    ranges = Balls.of(Matrix(problem.inputs, 2))
    G, M = Balls.of(problem.G), Balls.of(problem.M)
    rows = []
    for j, ((lower, upper), weight) in enumerate(zip(ranges.rows, weights.rows[0])):
        H.rows[j][j], F.rows[j][n + j] = weight, -weight
        for sign, bound in ((1, upper), (-1, -lower)):
            rows.append(ExpectedRow([sign * UNIT if i == j else 0 for i in range(nu)], [0] * (n + nu), bound, ranges.radius))
    H.radius = F.radius = weights.radius
    radius = max(G.radius, M.radius, bounds.radius)
    rows += [ExpectedRow(on_u, on_xi + [0] * nu, bound, radius)
             for on_u, on_xi, bound in zip(G.rows, M.rows, bounds.rows[0])]
    return ExpectedProgram(H, F, Balls.zeros(nu, n + nu + 1), rows, Fraction(0))
