"""A problem that is a program in JSON: its numbers are those of the certificate."""
from exact import require
from fields import document_of, number_of
from signals import INFINITE, Signal, match_signals

# Keys of the file and names of the certificate.
MATRICES = [*zip("H f F A b B A_theta b_theta".split(), "H f F A b S A_theta b_theta".split())]
OUTPUTS = [*zip("ECc", "ECc")]


def numbers_of(node):
    """All numbers of nested lists, in order; none of what is missing."""
    if node == "null" or node is None:
        return []
    return flat(map(numbers_of, node)) if isinstance(node, list) else [number_of(node)]


def flat(matrix):
    return [entry for row in matrix for entry in row]


def match_json(certificate, text, region_map):
    """Shows that each number of the certificate's program is that of the problem, and that signals and period are."""
    p, q = region_map.p, region_map.q
    # No string of JSON has a tab.
    root, program = document_of(text.replace("\t", " ")), certificate.program
    has_outputs = bool(numbers_of(root.get("E")))
    for key, name in MATRICES + (OUTPUTS if has_outputs else []):
        require(flat(program[name]) == numbers_of(root.get(key)), f"{key} is not that of the problem file")
    ranges = list(zip(numbers_of(root["lb"]), numbers_of(root["ub"])))
    require(list(map(tuple, program["box"])) == ranges, "lb or ub is not that of the problem file")
    equalities = sorted(certificate.equalities)
    require(sorted(numbers_of(root.get("eq_ids"))) == equalities, "eq_ids is not that of the problem file")
    if not has_outputs:
        # u are the entries of z that `out` names; without that too, all of z. Nothing is added.
        places = range(len(program["H"]))
        out = numbers_of(root.get("out")) or places
        wanted = [[int(place == j) for j in places] for place in out if place in places]
        require(program["E"] == wanted, "out is not that of the problem file")
        require(not any(flat(program["C"] + program["c"])), "C or c is not that of the problem file")
    parameters, inputs = (names_of(root, *key) for key in (("parameters", "theta_", p), ("inputs", "u_", q)))
    signals = [Signal(*names, *ends) for names, ends in zip(parameters, ranges)]
    for names, node in zip(inputs, root.get("inputs", [{}] * q)):
        lower, upper = (numbers_of(node.get(end)) for end in ("lower", "upper"))
        signals.append(Signal(*names, *(lower or [-INFINITE]), *(upper or [INFINITE])))
    match_signals(region_map, signals, *(numbers_of(root.get("period")) or [0]))


def names_of(root, key, letter, count):
    """Names and units. What the file does not name is theta_0, theta_1, .. and u_0, u_1, .. without unit."""
    nodes = root.get(key, [{"name": f"{letter}{j}", "unit": "1"} for j in range(count)])
    require(len(nodes) == count, f"{key}: not as many as the map has")
    return [(node["name"], node["unit"]) for node in nodes]
