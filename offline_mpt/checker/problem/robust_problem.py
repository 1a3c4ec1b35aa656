"""A problem file of type robust_mpc (offline_mpt/robust/README.md). Numbers are exact as written."""
from collections import namedtuple
from fractions import Fraction

from exact import require
from fields import (choice_of, count_of, document_of, exact_of, items_of, list_of, matrix_of, number_of,
                    number_or, range_of, require_head, require_keys, weight_of)

MOST_STAGES = 40
LEAST_BITS, BITS, MOST_BITS = 8, 40, 200

# A gain, or weights of its LQR.
Gain = namedtuple("Gain", "value Q R")


class RobustProblem:
    """x' or x_{k+1} = A x + B u + G w, outputs C x. Refuses keys and choices that are not known."""

    def __init__(self, text):
        root = document_of(text)
        require_head(root, "robust_mpc", "provenance model sampling_time horizon stack feedback_predictions "
                                         "feedback_gain tie_break floor invariance peak_in_map parameters")
        self.sampling_time, self.horizon = number_of(root["sampling_time"]), count_of(root["horizon"])
        require(self.sampling_time > 0 and 2 <= self.horizon <= MOST_STAGES,
                "problem: sampling_time or horizon is out of range")
        self._read_model(root["model"])
        # Stages x_{k+1} .. x_{k+N} instead of x_k .. x_{k+N-1}.
        self.is_shifted = choice_of(root, "stack", "paper", "shift") == "shift"
        self.feedback = choice_of(root, "feedback_predictions", "free", "zero", "fixed")
        # Where the state must be in the invariant set.
        self.invariance = choice_of(root, "invariance", "none", "first_step", "terminal")
        self.has_peak = choice_of(root, "peak_in_map", "false", "true") == "true"
        self.floor = exact_of(root["floor"]) if "floor" in root else Fraction(0)
        self.tie_gain = self._gain_of(root["tie_break"])
        require(self.feedback == "fixed" or "feedback_gain" not in root,
                "problem: feedback_gain goes with feedback_predictions: fixed")
        self.feedback_gain = self._gain_of(root.get("feedback_gain", root["tie_break"]))
        self._read_parameters(items_of(root, "parameters", "name role of unit range state input"))

    def _read_model(self, model):
        require_keys(model, "time bits states inputs disturbances A B G C delay")
        kinds = "states", "inputs", "disturbances"
        states, inputs, disturbances = (items_of(model, kind, "name unit range") for kind in kinds)
        require(states and len(inputs) == 1, "problem: one input is needed, and a state")
        self._states = [state["name"] for state in states]
        bounded = [(i, state["range"]) for i, state in enumerate(states) if "range" in state]
        self.state_ranges = {i: range_of(ends, exact_of) for i, ends in bounded}
        self.input_range = range_of(inputs[0]["range"], exact_of)
        self.disturbances = [range_of(disturbance["range"], exact_of) for disturbance in disturbances]
        require(number_or(model, "delay", 0) >= 0, "problem: delay is negative")
        self.is_discrete = choice_of(model, "time", "continuous", "discrete") == "discrete"
        # Model and computed gains are rounded to multiples of 2^-bits.
        self.bits = int(number_or(model, "bits", BITS))
        require(LEAST_BITS <= self.bits <= MOST_BITS, "problem: bits is out of range")
        nx = len(states)
        self.A, self.B = matrix_of(model["A"], nx, nx, exact_of), matrix_of(model["B"], nx, 1, exact_of)
        self.G = matrix_of(model["G"], nx, len(disturbances), exact_of)
        self.C = matrix_of(model["C"], len(model["C"]), nx, exact_of)

    def _gain_of(self, node):
        require_keys(node, "gain Q R")
        nx = len(self._states)
        if "gain" not in node:
            return Gain(None, weight_of(node["Q"], nx, exact_of), weight_of(node["R"], 1, exact_of))
        require(len(node) == 1, "problem: a gain has weights too")
        return Gain(matrix_of(node["gain"], 1, nx, exact_of), None, None)

    def _read_parameters(self, parameters):
        """Ranges, what a reference adds to x and u, and the parameter of each state's error."""
        nx, errors = len(self._states), {}
        self.ranges = [list(range_of(parameter["range"], exact_of)) for parameter in parameters]
        self.state_shift, self.input_shift = [], []
        for j, parameter in enumerate(parameters):
            if choice_of(parameter, "role", "error", "reference") == "error":
                require(parameter["of"] not in errors, "problem: two parameters are the error of one state")
                errors[parameter["of"]] = j
                shifts = [Fraction(0)] * nx, [Fraction(0)]
            else:
                shifts = list_of(parameter["state"], nx, exact_of), list_of(parameter["input"], 1, exact_of)
            self.state_shift.append(shifts[0])
            self.input_shift.append(shifts[1])
        require(errors.keys() == set(self._states), "problem: not each state has an error as parameter")
        self.errors = [errors[state] for state in self._states]
