"""Names, units and ranges of a map's parameters and inputs, and its period."""
from collections import namedtuple
from fractions import Fraction

from exact import require
from fields import decimal_of, items_of, number_or, word_of

# Relative: a range in doubles, or rounded from a quotient.
SAME_BOUND = Fraction(1, 10**12)

# A range has None where there is no bound.
Signal = namedtuple("Signal", "name unit lower upper")


def quotient_of(node):
    """A number, or a quotient of two."""
    above, slash, below = word_of(node).partition("/")
    divisor = decimal_of(below) if slash else Fraction(1)
    require(divisor != 0, "problem: a division by 0")
    return decimal_of(above) / divisor


def signal_of(node, key="range", ending=""):
    ends = map(quotient_of, node[key]) if key in node else (None, None)
    return Signal(node["name"] + ending, node["unit"], *ends)


def signals_of_model(root):
    """Of a file of type tracking_mpc or robust_mpc; a parameter with a value is no entry of theta."""
    signals = [signal_of(parameter) for parameter in items_of(root, "parameters") if "value" not in parameter]
    signals += map(signal_of, items_of(root["model"], "inputs"))
    if root.get("peak_in_map") == "true":
        signals.append(Signal("tau", "1", quotient_of(root["floor"]) if "floor" in root else Fraction(0), None))
    return signals


def signals_of_filter(root):
    """Of a file of type safety_filter: states, inputs before where there is a delay, wishes; then the inputs."""
    inputs = items_of(root["model"], "inputs")
    before = [signal_of(entry, ending="_before") for entry in inputs] if number_or(root, "delay", 0) > 0 else []
    wishes = [signal_of(entry, "wish" if "wish" in entry else "range", "_wish") for entry in inputs]
    return [*map(signal_of, items_of(root["model"], "states")), *before, *wishes, *map(signal_of, inputs)]


def is_same(in_map, end, infinite):
    """Whether a double is the end of a range."""
    if end is None or abs(in_map) == abs(infinite):
        return end is None and in_map == infinite
    return abs(Fraction(in_map) - end) <= SAME_BOUND * abs(end)


def match_signals(region_map, signals, period):
    """Shows that parameters and inputs of the map are these, and its period. Refuses other ones."""
    require(len(signals) == len(region_map.names), "the map has another number of signals")
    in_map = zip(region_map.names, region_map.units, region_map.bounds)
    for signal, (name, unit, (lower, upper)) in zip(signals, in_map):
        require(name == signal.name, f"the map has the signal {name} in the place of {signal.name}")
        require(unit == signal.unit, f"{name}: its unit is another one")
        require(is_same(lower, signal.lower, -float("inf")) and is_same(upper, signal.upper, float("inf")),
                f"{name}: its range is not that of the problem")
    require(region_map.period == period, "the map's period is not that of the problem")


def match_problem_signals(region_map, root):
    """The same of a problem in YAML."""
    is_filter = root["type"] == "safety_filter"
    match_signals(region_map, (signals_of_filter if is_filter else signals_of_model)(root),
                  number_or(root, "sampling_time", 0))
