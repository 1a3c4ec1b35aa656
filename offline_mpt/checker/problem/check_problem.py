#!/usr/bin/env python3
"""check_problem CERTIFICATE --map MAP [--problem FILE]: confirms that the program of a certificate is the discretised,
condensed problem of its map. Whole numbers, fractions and YAML only; shares no code with the solver."""
import sys

from certificate import RobustCertificate, read_certificate
from command_line import Parser, checked
from exact import require
from fields import document_of
from files import read_file, with_file
from filter_answers import Answers
from filter_problem import FilterProblem, is_completed_text, match_filter
from json_problem import match_json
from program_match import match_tracking
from region_map import RegionMap
from robust_match import match_robust
from robust_problem import RobustProblem
from safe_set import confirm_safe_set
from signals import match_yaml_signals
from tracking_problem import TrackingProblem

VERSION = "@POLYFLY_VERSION@"
USAGE = """\
usage: check_problem CERTIFICATE --map MAP [--problem FILE] [--time-limit SECONDS]
Confirms that the program of CERTIFICATE, from 'offline_mpt verify --exact', is the problem that MAP carries,
discretised and condensed: each row within 1e-12 of its greatest entry, and each input within 1e-6 of its
range. What the map answers for that program, check_certificate confirms. Of a YAML file of type robust_mpc,
the model and all rows of the certificate are those of the file, and its invariant set is one. Of type
safety_filter, the safe set is one, and answers in it keep the state there. Of a program in JSON, each number
is compared. Names, units and ranges of the map's parameters and inputs, and its period, are those of the
problem too.
With --problem, MAP must carry the text of that file; of a safety filter, then the safe set behind it.
Exit codes: 0 confirmed; 1 refused; 2 the command line or a file is invalid, or memory ran out; 3 stopped at
the time limit.
"""
TRACKING = """\
confirmed: the program is that of the problem{beside}, within {0.difference:.3g} of the greatest entry of each row
what that may change in an input: at most {0.effect:.3g} of its range
the Riccati equation of the terminal weight holds within {0.expected.riccati_residual:.3g}
"""
ROBUST = """\
confirmed: the model is that of the problem, within {0.difference:.3g}; {0.rows} rows follow from it exactly
"""
INVARIANCE = """\
{0.invariance_rows} rows more keep a step in a set within all bounds, which is robustly invariant as long as the \
references stay; that no greater set is so is {confirmed}
"""
FILTER = """\
confirmed: each number of the program is that of the problem and its safe set
safe set, {} rows: it is within the ranges, each of its states has an admissible input, and each such input leads \
into it, for all disturbances and errors
answers in the safe set to wishes in their range: none needs more than the margin, and where no row is active the wish \
comes back unchanged
"""
PROGRAM = "confirmed: each number of the program is that of the problem\n"
SIGNALS = "the map's signals, ranges and period are those of the problem\n"


def confirm_tracking(certificate, region_map):
    match = match_tracking(certificate, TrackingProblem(region_map.problem))
    beside = " beside the feedback of its Riccati gains" if match.expected.beside_feedback else ""
    return TRACKING.format(match, beside=beside)


def confirm_robust(certificate, region_map):
    match = match_robust(certificate, RobustProblem(region_map.problem), region_map)
    confirmed = "confirmed" if match.is_greatest else "not confirmed"
    return (ROBUST + (INVARIANCE if match.invariance_rows else "")).format(match, confirmed=confirmed)


def confirm_filter(certificate, region_map):
    problem = FilterProblem(region_map.problem)
    match_filter(certificate, problem)
    confirm_safe_set(problem)
    Answers(problem, region_map).confirm()
    return FILTER.format(len(problem.k))


def confirm_yaml(certificate, region_map):
    root = document_of(region_map.problem)
    is_robust = isinstance(certificate, RobustCertificate)
    confirm_type = confirm_robust if is_robust else (
        confirm_filter if root.get("type") == "safety_filter" else confirm_tracking)
    text = confirm_type(certificate, region_map)
    match_yaml_signals(region_map, root)
    return text


def confirm_json(certificate, region_map):
    require(not isinstance(certificate, RobustCertificate), "the certificate is of another kind of problem")
    match_json(certificate, region_map.problem, region_map)
    return PROGRAM


def confirm(arguments):
    region_map = with_file(arguments.map, RegionMap)

    def require_text(content):
        text = content.decode("utf-8", "surrogateescape")
        require(text == region_map.problem or is_completed_text(region_map.problem, text),
                "the problem file is not the one that the map was made from")

    if arguments.problem:
        with_file(arguments.problem, require_text)
    require(region_map.reduced_from == 0,
            "the map was reduced; check its original, whose answers check_certificate compares")
    certificate = read_certificate(read_file(arguments.file), region_map)
    confirm_kind = {"yaml": confirm_yaml, "json": confirm_json}.get(region_map.kind)
    require(confirm_kind, "the map's kind of problem is unknown")
    return confirm_kind(certificate, region_map) + SIGNALS


if __name__ == "__main__":
    NAME = "check_problem"
    sys.exit(checked(NAME, Parser(USAGE, f"{NAME} {VERSION}", {"--map": True, "--problem": False}), confirm))
