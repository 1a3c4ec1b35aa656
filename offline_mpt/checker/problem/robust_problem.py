"""A problem file of type robust_mpc (offline_mpt/robust/README.md). Numbers are exact as written."""
import re
from collections import namedtuple
from fractions import Fraction

from exact import Matrix, require
from fields import (choice_of, count_of, document_of, filled_range, items_of, matrix_of, number_of, number_or, require_head,
                    require_keys, weight_of, word_of)

MOST_STAGES = 40
LEAST_BITS, MOST_BITS = 8, 200
MOST_DIGITS = 400
# Digits of which no zero leads, perhaps a point, perhaps an exponent.
DECIMAL = re.compile(r"(?!0[0-9])([0-9]*)(?:\.([0-9]*))?(?:[eE]([-+]?[0-9]+))?")

# A gain, or weights of its LQR.
Gain = namedtuple("Gain", "value Q R")


def decimal_of(text):
    """A decimal number without sign."""
    found = DECIMAL.fullmatch(text)
    whole, part = (found[1], found[2] or "") if found else ("", "")
    require(whole + part, f"problem: {text} is no number in decimal digits without leading zeros")
    stated = found[3] or "0"
    require(len(stated) <= MOST_DIGITS, f"problem: {text} is out of range")
    exponent = int(stated) - len(part)
    require(abs(int(stated)) <= MOST_DIGITS and abs(exponent) <= MOST_DIGITS, f"problem: {text} is out of range")
    return int(whole + part) * Fraction(10) ** exponent


def exact_of(node):
    """A number as written, or a quotient of two."""
    text = word_of(node)
    sign, digits = (text[0], text[1:]) if text[:1] in ("-", "+") else ("+", text)
    above, slash, below = digits.partition("/")
    value = decimal_of(above)
    if slash:
        divisor = decimal_of(below)
        require(divisor != 0, "problem: a division by 0")
        value /= divisor
    return -value if sign == "-" else value


def exact_range(node):
    return filled_range(node, exact_of)


class RobustProblem:
    """x' or x_{k+1} = A x + B u + G w, outputs C x. Refuses keys and choices that are not known."""

    def __init__(self, text):
        root = document_of(text)
        require_head(root, "robust_mpc", "provenance model sampling_time horizon stack feedback_predictions feedback_gain "
                                         "tie_break floor invariance peak_in_map parameters")
        self.sampling_time, self.horizon = number_of(root["sampling_time"]), count_of(root["horizon"])
        require(self.sampling_time > 0 and 2 <= self.horizon <= MOST_STAGES,
                "problem: sampling_time or horizon is out of range")
        self._read_signals(root["model"])
        self._read_model(root["model"])
        # Stages x_{k+1} .. x_{k+N} instead of x_k .. x_{k+N-1}.
        self.is_shifted = choice_of(root, "stack", ("paper", "shift")) == "shift"
        self.feedback = choice_of(root, "feedback_predictions", ("free", "zero", "fixed"))
        # Where the state must be in the invariant set.
        self.invariance = choice_of(root, "invariance", ("none", "first_step", "terminal"))
        self.has_peak = choice_of(root, "peak_in_map", ("false", "true")) == "true"
        self.floor = exact_of(root["floor"]) if "floor" in root else Fraction(0)
        self.tie_gain = self._gain_of(root["tie_break"])
        require(self.feedback == "fixed" or "feedback_gain" not in root,
                "problem: feedback_gain goes with feedback_predictions: fixed")
        self.feedback_gain = self._gain_of(root["feedback_gain"]) if "feedback_gain" in root else self.tie_gain
        self._read_parameters(items_of(root, "parameters"))

    def _read_signals(self, model):
        require_keys(model, "time bits states inputs disturbances A B G C delay")
        self._states, self.state_ranges = [], {}
        for place, state in enumerate(items_of(model, "states")):
            require_keys(state, "name unit range")
            self._states.append(word_of(state["name"]))
            if "range" in state:
                self.state_ranges[place] = exact_range(state["range"])
        inputs = items_of(model, "inputs")
        require(self._states and len(inputs) == 1, "problem: one input is needed, and a state")
        require_keys(inputs[0], "name unit range")
        self.input_range = exact_range(inputs[0]["range"])
        self.disturbances = []
        for disturbance in items_of(model, "disturbances"):
            require_keys(disturbance, "name unit range")
            self.disturbances.append(exact_range(disturbance["range"]))
        require(number_or(model, "delay", 0) >= 0, "problem: delay is negative")

    def _read_model(self, model):
        nx = len(self._states)
        self.is_discrete = choice_of(model, "time", ("continuous", "discrete")) == "discrete"
        # Model and computed gains are rounded to multiples of 2^-bits.
        self.bits = count_of(model["bits"]) if "bits" in model else 40
        require(LEAST_BITS <= self.bits <= MOST_BITS, "problem: bits is out of range")
        self.A, self.B = matrix_of(model["A"], nx, nx, exact_of), matrix_of(model["B"], nx, 1, exact_of)
        self.G = matrix_of(model["G"], nx, len(self.disturbances), exact_of)
        self.C = matrix_of(model["C"], len(model["C"]), nx, exact_of)

    def _gain_of(self, node):
        require_keys(node, "gain Q R")
        if "gain" not in node:
            return Gain(None, weight_of(node["Q"], len(self._states), exact_of), weight_of(node["R"], 1, exact_of))
        require(len(node) == 1, "problem: a gain has weights too")
        return Gain(matrix_of(node["gain"], 1, len(self._states), exact_of), None, None)

    def _read_parameters(self, parameters):
        """Ranges, what a reference adds to x and u, and the parameter of each state's error."""
        ranges, state_shift, input_shift, errors = [], [], [], {}
        for j, parameter in enumerate(parameters):
            require_keys(parameter, "name role of unit range state input")
            ranges.append(list(exact_range(parameter["range"])))
            state, value = [Fraction(0)] * len(self._states), Fraction(0)
            if choice_of(parameter, "role", ("error", "reference")) == "error":
                require(parameter["of"] in self._states, "problem: a parameter names no state")
                place = self._states.index(parameter["of"])
                require(place not in errors, "problem: two parameters are the error of one state")
                errors[place] = j
            else:
                [state], [[value]] = matrix_of([parameter["state"]], 1, len(self._states), exact_of).rows, matrix_of(
                    [parameter["input"]], 1, 1, exact_of).rows
            state_shift.append(state)
            input_shift.append([value])
        require(len(errors) == len(self._states), "problem: a state has no error among the parameters")
        self.ranges, self.state_shift = Matrix(ranges, 2), Matrix(state_shift, len(self._states))
        self.input_shift = Matrix(input_shift, 1)
        self.errors = [errors[place] for place in range(len(self._states))]
