"""A problem that is a program in JSON: its numbers are those of the certificate."""
import json
from fractions import Fraction

from exact import Refused, require
from signals import Signal, match_signals

# Keys of the file and names of the certificate.
MATRICES = {"H": "H", "f": "f", "F": "F", "A": "A", "b": "b", "B": "S", "A_theta": "A_theta", "b_theta": "b_theta"}


def unique(pairs):
    fields = dict(pairs)
    require(len(fields) == len(pairs), "problem: a key is given twice")
    return fields


def finite(digits):
    value = float(digits)
    require(abs(value) < float("inf"), f"problem: {digits} is not a finite number")
    return Fraction(value)


def document_of(text):
    try:
        root = json.loads(text, object_pairs_hook=unique, parse_float=finite, parse_int=finite, parse_constant=finite)
    except (ValueError, RecursionError) as error:
        raise Refused(f"problem: {error}") from None
    require(isinstance(root, dict), "problem: has no keys")
    return root


def numbers_of(node):
    """All numbers of nested lists, in order; none of what is missing."""
    if isinstance(node, list):
        return [number for item in node for number in numbers_of(item)]
    require(node is None or isinstance(node, Fraction), "problem: a number is missing")
    return [] if node is None else [node]


def places_of(root, key, limit):
    """Whole numbers below `limit` behind a key."""
    places = numbers_of(root.get(key))
    require(all(place.denominator == 1 and 0 <= place < limit for place in places), f"{key} names what is not there")
    return [int(place) for place in places]


def match_json(certificate, root, region_map):
    """Shows that each number of the certificate's program is that of the problem, and that signals and period are."""
    program = certificate.program

    def compare(key, name, wanted):
        require(wanted == program[name].entries(), f"{key} is not that of the problem file")

    for key, name in MATRICES.items():
        compare(key, name, numbers_of(root.get(key)))
    lower, upper = numbers_of(root.get("lb")), numbers_of(root.get("ub"))
    require(len(lower) == len(upper), "lb and ub are not of one length")
    compare("lb or ub", "box", [end for ends in zip(lower, upper) for end in ends])
    require(set(places_of(root, "eq_ids", len(program["A"].rows))) == certificate.equalities,
            "eq_ids is not that of the problem file")
    if numbers_of(root.get("E")):
        for key in ("E", "C", "c"):
            compare(key, key, numbers_of(root.get(key)))
    else:
        # Without E, u are the entries of z that `out` names; without that too, all of z. Nothing is added.
        n = program["E"].columns
        places = places_of(root, "out", n) or range(n)
        compare("out", "E", [Fraction(j == place) for place in places for j in range(n)])
        require(not any(program["C"].entries() + program["c"].entries()), "out is not that of the problem file")
    signals = named_signals(root, "parameters", "theta_", list(zip(lower, upper)))
    signals += named_signals(root, "inputs", "u_", [(None, None)] * region_map.q)
    match_signals(region_map, signals, root.get("period", 0))


def named_signals(root, key, letter, ranges):
    """What the file does not name is theta_0, theta_1, .. and u_0, u_1, .. without unit. Parameters have the ranges of lb and
    ub, whatever their entries state."""
    named = root.get(key)
    if named is None:
        return [Signal(f"{letter}{j}", "1", *ends) for j, ends in enumerate(ranges)]
    require(len(named) == len(ranges), f"{key}: not as many as the map has")
    return [Signal(entry["name"], entry["unit"], *(own if own is not None else entry.get(side)
                                                   for own, side in zip(ends, ("lower", "upper"))))
            for entry, ends in zip(named, ranges)]
