"""A problem file of type safety_filter with its safe set (offline_mpt/safety/README.md)."""
from fractions import Fraction

from balls import Balls
from exact import Refused, diagonal, require
from fields import (document_of, items_of, list_of, matrix_of, number_of, number_or, range_of, require_head,
                    require_keys)
from polyhedron import half_space

# What a file says that does not say it.
INPUT_ERROR, MARGIN = Fraction(1e-6), Fraction(1e-4)
MOST_STATES, MOST_INPUTS, MOST_ROWS = 6, 3, 400


class FilterProblem:
    """x' = A x + B u + B_d d, and S = {xi: H xi <= k}. An input is admissible where G u <= b + M xi; xi is the state, with a
    delay also the input before. Refuses keys that are not known."""

    def __init__(self, text):
        root = document_of(text)
        require_head(root, "safety_filter", "model sampling_time delay margin safe_set")
        self.sampling_time = number_of(root["sampling_time"])
        self.delay, self.margin = number_or(root, "delay", Fraction(0)), number_or(root, "margin", MARGIN)
        require(0 <= self.delay <= self.sampling_time > 0 < self.margin,
                "problem: sampling_time, delay or margin is out of range")
        self._read_model(root["model"])
        self._read_safe_set(root["safe_set"])

    @property
    def size(self):
        """Of xi."""
        return len(self.states) + (len(self.inputs) if self.delay else 0)

    def set_rows(self, size):
        """Half-spaces of S among as many entries, the first of which are xi."""
        behind = [Fraction(0)] * (size - self.size)
        return [half_space([*row, *behind], bound) for row, bound in zip(self.H, self.k)]

    def _read_model(self, model):
        require_keys(model, "states inputs disturbances A B B_d")
        states = items_of(model, "states", "name unit range error")
        inputs = items_of(model, "inputs", "name unit range wish weight error")
        disturbances = items_of(model, "disturbances", "name unit range")
        nx, nu = len(states), len(inputs)
        require(1 <= nx <= MOST_STATES, "problem: 1 to 6 states are allowed")
        require(1 <= nu <= MOST_INPUTS, "problem: 1 to 3 inputs are allowed")
        self.states, self.inputs = ([range_of(node["range"]) for node in nodes] for nodes in (states, inputs))
        self.wishes = [range_of(node.get("wish", node["range"])) for node in inputs]
        self.weights = [number_or(node, "weight", Fraction(1)) for node in inputs]
        require(min(self.weights) > 0, "problem: a weight is not positive")
        self.state_errors = [number_or(node, "error", Fraction(0)) for node in states]
        self.input_errors = [number_or(node, "error", INPUT_ERROR) for node in inputs]
        require(min(self.state_errors + self.input_errors) >= 0, "problem: an error is negative")
        self.A, self.B = Balls.of(matrix_of(model["A"], nx, nx)), Balls.of(matrix_of(model["B"], nx, nu))
        # A model without disturbances has one that is 0.
        self.disturbances, self.B_d = [(Fraction(0), Fraction(0))], Balls.zeros(nx, 1)
        if disturbances:
            self.disturbances = [range_of(node["range"]) for node in disturbances]
            self.B_d = Balls.of(matrix_of(model["B_d"], nx, len(disturbances)))

    def _read_safe_set(self, node):
        require_keys(node, "H k G b M")
        height, n = len(node["H"]), self.size
        require(height <= MOST_ROWS, "problem: safe_set has too many rows")
        self.H, self.M = matrix_of(node["H"], height, n), matrix_of(node["M"], height, n)
        self.G = matrix_of(node["G"], height, len(self.inputs))
        self.k, self.b = list_of(node["k"], height), list_of(node["b"], height)


def is_completed_text(whole, file):
    """Whether `whole` is the text of a problem file, followed by the key safe_set and nothing else."""
    rest = whole[len(file):]
    if not whole.startswith(file) or not (file.endswith("\n") or rest.startswith("\n")):
        return False
    try:
        return list(document_of(rest)) == ["safe_set"]
    except Refused:
        return False


def match_filter(certificate, problem):
    """Shows that the program of a certificate is that of a safety filter and its safe set, number by number: minimise the sum
    of weight (u - wish)^2 / 2 over z = u, with theta = (xi, wish)."""
    n, nu = problem.size, len(problem.inputs)
    weights = diagonal(problem.weights)
    before = problem.inputs if problem.delay else []
    wanted = {"box": [list(ends) for ends in problem.states + before + problem.wishes],
              "H": weights, "f": [[0]] * nu, "E": diagonal([1] * nu), "C": [[0] * (n + nu)] * nu,
              "c": [[0]] * nu, "F": [[0] * n + [-entry for entry in row] for row in weights]}
    program = certificate.program
    for name, matrix in wanted.items():
        require(program[name] == matrix, f"{name} is not that of the problem")
    rows = [A + S + b for A, S, b in zip(program["A"], program["S"], program["b"])]
    without_u = zip(program["A_theta"], program["b_theta"])
    rows += [[0] * nu + [-entry for entry in row] + bound for row, bound in without_u]
    expected = [G + M + [0] * nu + [bound] for G, M, bound in zip(problem.G, problem.M, problem.b)]
    for j, (lower, upper) in enumerate(problem.inputs):
        for sign, bound in ((1, upper), (-1, -lower)):
            expected.append([sign * (i == j) for i in range(nu)] + [0] * (n + nu) + [bound])
    require(sorted(rows) == sorted(expected), "the rows are not those of the problem")
    require(not certificate.equalities, "a safety filter has no equalities")
