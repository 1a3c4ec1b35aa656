"""Names, units and ranges of a map's parameters and inputs, and its period."""
from collections import namedtuple
from fractions import Fraction

from exact import require
from fields import exact_of, number_or

# Relative: a range in doubles, or rounded from a quotient.
SAME_BOUND = Fraction(1, 10**12)

# A range has infinite ends where there are no bounds.
Signal = namedtuple("Signal", "name unit lower upper")
INFINITE = float("inf")


def signal_of(node, key="range", ending=""):
    ends = map(exact_of, node[key]) if key in node else (-INFINITE, INFINITE)
    return Signal(node["name"] + ending, node["unit"], *ends)


def signals_of_model(root):
    """Of a file of type tracking_mpc or robust_mpc; a parameter with a value is no entry of theta."""
    nodes = [node for node in root["parameters"] if "value" not in node] + root["model"]["inputs"]
    peak = Signal("tau", "1", exact_of(root["floor"]) if "floor" in root else Fraction(0), INFINITE)
    return [*map(signal_of, nodes), *([peak] if root.get("peak_in_map") == "true" else [])]


def signals_of_filter(root):
    """Of a file of type safety_filter: states, inputs before where there is a delay, wishes; then the inputs."""
    inputs = root["model"]["inputs"]
    before = [signal_of(node, ending="_before") for node in inputs] if number_or(root, "delay", 0) > 0 else []
    wishes = [signal_of(node, "wish" if "wish" in node else "range", "_wish") for node in inputs]
    return [*map(signal_of, root["model"]["states"]), *before, *wishes, *map(signal_of, inputs)]


def is_same(in_map, end):
    """Whether a double is the end of a range."""
    if INFINITE in (abs(in_map), abs(end)):
        return in_map == end
    return abs(Fraction(in_map) - end) <= SAME_BOUND * abs(end)


def match_signals(region_map, signals, period):
    """Shows that parameters and inputs of the map are these, and its period. Refuses other ones."""
    require(len(signals) == len(region_map.names), "the map has another number of signals")
    in_map = zip(region_map.names, region_map.units, region_map.bounds)
    for wanted, (name, unit, ends) in zip(signals, in_map):
        require(name == wanted.name, f"the map has the signal {name} in the place of {wanted.name}")
        require(unit == wanted.unit, f"{name}: its unit is another one")
        require(all(map(is_same, ends, wanted[2:])), f"{name}: its range is not that of the problem")
    require(region_map.period == period, "the map's period is not that of the problem")


def match_yaml_signals(region_map, root):
    """The same of a problem in YAML."""
    signals = signals_of_filter(root) if root["type"] == "safety_filter" else signals_of_model(root)
    match_signals(region_map, signals, number_or(root, "sampling_time", 0))
