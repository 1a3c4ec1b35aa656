#!/usr/bin/env python3
"""check_problem CERTIFICATE --map MAP [--problem FILE]: confirms that the program of a certificate is the discretised,
condensed problem of its map. Whole numbers, fractions and YAML only; shares no code with the solver."""
import sys

import fields
import json_problem
from certificate import RobustCertificate, read_certificate
from command_line import BadUsage, Progress, run
from exact import require
from files import read_file, with_file
from filter_problem import FilterProblem, is_completed_text, match_filter
from program_match import match_tracking
from region_map import RegionMap
from robust_match import match_robust
from robust_problem import RobustProblem
from safe_set import confirm_answers, confirm_safe_set
from signals import match_problem_signals
from tracking_problem import TrackingProblem

VERSION = "0.3.0"
USAGE = """\
usage: check_problem CERTIFICATE --map MAP [--problem FILE] [--time-limit SECONDS]
Confirms that the program of CERTIFICATE, from 'offline_mpt verify --exact', is the problem that MAP carries,
discretised and condensed: each row within 1e-12 of its greatest entry, and each input within 1e-6 of its range. What the map answers for that program,
check_certificate confirms. Of a YAML file of type robust_mpc, the model and all rows of the certificate are those of
the file, and its invariant set is one. Of type safety_filter, the safe set is one, and answers in it keep the state
there. Of a program in JSON, each number is compared. Names, units and ranges of the map's parameters and inputs, and
its period, are those of the problem too.
With --problem, MAP must carry the text of that file; of a safety filter, that text and the safe set behind it.
Exit codes: 0 confirmed; 1 refused; 2 the command line or a file is invalid, or memory ran out; 3 stopped at the time limit.
"""


def confirm_tracking(certificate, region_map):
    match = match_tracking(certificate, TrackingProblem(region_map.problem))
    return (f"confirmed: the program is that of the problem"
            f"{' beside the feedback of its Riccati gains' if match.beside_feedback else ''}, within "
            f"{float(match.difference):.3g} of the greatest entry of each row\n"
            f"what that may change in an input: at most {float(match.effect):.3g} of its range\n"
            f"the Riccati equation of the terminal weight holds within {float(match.riccati_residual):.3g}\n")


def confirm_robust(certificate, region_map):
    match = match_robust(certificate, RobustProblem(region_map.problem), region_map)
    text = (f"confirmed: the model is that of the problem, within {float(match.difference):.3g}; {match.rows} rows follow "
            f"from it exactly\n")
    if match.invariance_rows:
        text += (f"{match.invariance_rows} rows more keep a step in a set within all bounds, which is robustly invariant as "
                 f"long as the references stay; that no greater set is so is {'' if match.is_greatest else 'not '}confirmed\n")
    return text


def confirm_filter(certificate, region_map):
    problem = FilterProblem(region_map.problem)
    progress = Progress()
    match_filter(certificate, problem)
    confirm_safe_set(problem, progress)
    confirm_answers(problem, region_map, progress)
    return (f"confirmed: each number of the program is that of the problem and its safe set\n"
            f"safe set, {len(problem.k)} rows: it is within the ranges, each of its states has an admissible input, and each "
            f"such input leads into it, for all disturbances and errors\n"
            f"answers in the safe set to wishes in their range: none needs more than the margin, and where no row is active "
            f"the wish comes back unchanged\n")


def confirm_yaml(certificate, region_map):
    root = fields.document_of(region_map.problem)
    require(isinstance(root, dict) and "H" not in root, "the map's kind of problem is another one")
    if isinstance(certificate, RobustCertificate):
        confirm_kind = confirm_robust
    else:
        confirm_kind = confirm_filter if root.get("type") == "safety_filter" else confirm_tracking
    text = confirm_kind(certificate, region_map)
    match_problem_signals(region_map, root)
    return text


def confirm_json(certificate, region_map):
    require(not isinstance(certificate, RobustCertificate), "the certificate is of another kind of problem")
    json_problem.match_json(certificate, json_problem.document_of(region_map.problem), region_map)
    return "confirmed: each number of the program is that of the problem\n"


def confirm(arguments):
    if "--map" not in arguments:
        raise BadUsage("--map is missing")
    region_map = with_file(arguments["--map"], RegionMap)

    def require_text(content):
        text = content.decode("utf-8", "surrogateescape")
        require(text == region_map.problem or is_completed_text(region_map.problem, text),
                "the problem file is not the one that the map was made from")

    if "--problem" in arguments:
        with_file(arguments["--problem"], require_text)
    require(region_map.reduced_from == 0,
            "the map was reduced; check its original, whose answers check_certificate compares")
    require(region_map.kind in ("yaml", "json"), "the map's kind of problem is another one")
    certificate = read_certificate(read_file(arguments[""]), region_map)
    text = (confirm_json if region_map.kind == "json" else confirm_yaml)(certificate, region_map)
    return text + "the map's signals, ranges and period are those of the problem\n"


if __name__ == "__main__":
    sys.exit(run("check_problem", VERSION, USAGE, ("--map", "--problem"), confirm))
