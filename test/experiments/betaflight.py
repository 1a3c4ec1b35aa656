"""Page and summary of the flights of Betaflight's SITL; fails where a flight that counts did not end well, or a law has none.

usage: betaflight.py FOLDER [--not-flown], with the LAW_NUMBER.json of betaflight_flight.py in it.
"""

import glob
import json
import os
import re
import sys

from betaflight_link import GREATEST_GAP, LIMITS, SETTLED

LAWS = ("linear", "explicit_linear", "nonlinear")
STYLE = """body{font:16px/1.5 system-ui,sans-serif;max-width:960px;margin:2em auto;padding:0 1em;color:#22272e}
table{border-collapse:collapse}td,th{padding:4px 12px;text-align:right;border-bottom:1px solid #dfe3e8}
td:first-child,th:first-child{text-align:left}.good,.bad{padding:10px 14px;border-radius:8px;color:#fff;font-weight:600}
.good{background:#00775a}.bad{background:#c04a00}"""
HEAD = {"hover": "hover", "step": "after the step", "eight": "eight, rms", "wind": "in wind", "loss": "odometry lost",
        "after": "after the loss"}


def read_flights(folder):
    """Of each law the results, in the order of their numbers."""
    flights = {law: [] for law in LAWS}
    for path in glob.glob(os.path.join(folder, "*_*.json")):
        law, number = re.fullmatch(r"(.+)_(\d+)\.json", os.path.basename(path)).groups()
        with open(path) as file:
            flights[law].append((int(number), json.load(file)))
    return {law: [result for _, result in sorted(rows, key=lambda row: row[0])] for law, rows in flights.items()}


def judge(flights):
    """Sentences about what is not well."""
    broken = []
    for law, results in flights.items():
        if not any(r["counts"] for r in results):
            broken.append("%s: no flight had command gaps below %g ms" % (law, 1000.0 * GREATEST_GAP))
        for number, r in enumerate(results, 1):
            for part, limit in LIMITS.items():
                distance = r["distance_m"][part]
                if r["counts"] and not distance <= limit:
                    broken.append("%s, flight %d, %s: %.3f m, at most %g m" % (law, number, HEAD[part], distance, limit))
    return broken


def cell(result, part):
    return "<td>%.1f</td>" % (100.0 * result["distance_m"][part])


def page(flights, broken):
    counted = [r for results in flights.values() for r in results if r["counts"]]
    well, gap = sum(1 for r in counted if r["well"]), 1000.0 * GREATEST_GAP
    parts = [
        "<!DOCTYPE html><html lang='en'><head><meta charset='utf-8'><title>Betaflight in the loop</title>",
        "<style>%s</style></head><body><h1>Betaflight in the loop</h1>" % STYLE,
        "<p class='%s'>%d of %d flights end well.</p>" % ("bad" if broken else "good", well, len(counted)),
        "".join("<p>%s</p>" % sentence for sentence in broken),
        "<p>Distance from the reference in cm: the greatest of the last %g s of a part, of the eight the rms, and the " % SETTLED,
        "greatest while odometry is lost. Flights with a command gap of %g ms or more do not count, because the " % gap,
        "computer was too busy.</p><table><tr><th>law, flight</th>",
        "".join("<th>%s</th>" % HEAD[part] for part in LIMITS),
        "<th>gap [ms]</th><th></th></tr><tr><td>at most</td>",
        "".join("<td>%g</td>" % (100.0 * limit) for limit in LIMITS.values()),
        "<td>%g</td><td></td></tr>" % gap,
    ]
    for law, results in flights.items():
        for number, r in enumerate(results, 1):
            verdict = ("well" if r["well"] else "not well") if r["counts"] else "does not count"
            cells = "".join(cell(r, part) for part in LIMITS)
            parts.append("<tr><td>%s, %d</td>%s<td>%.0f</td><td>%s</td></tr>" % (law, number, cells, 1000.0 * r["greatest_gap_s"], verdict))
    return "".join(parts) + "</table></body></html>\n"


NOT_FLOWN = "not flown: POLYFLY_BETAFLIGHT names no program"


def write_not_flown(folder):
    with open(os.path.join(folder, "report", "index.html"), "w") as file:
        file.write("<!DOCTYPE html><html lang='en'><head><meta charset='utf-8'><title>Betaflight in the loop</title>"
                   "</head><body>"
                   "<p>%s. test/experiments/README.md tells how to build one.</p></body></html>\n" % NOT_FLOWN.capitalize())
    with open(os.path.join(folder, "summary.json"), "w") as file:
        json.dump({"flights": {}, "headline": [[NOT_FLOWN, 0, "flights"]]}, file, indent=2)


def main(folder):
    flights = read_flights(folder)
    broken = judge(flights)
    with open(os.path.join(folder, "report", "index.html"), "w") as file:
        file.write(page(flights, broken))
    headline = []
    for law, results in flights.items():
        counted = [r for r in results if r["counts"]]
        headline.append(["%s: flights that end well" % law, sum(1 for r in counted if r["well"]), "of %d" % len(counted)])
        headline.append(["%s: flights that do not count" % law, len(results) - len(counted), ""])
        headline += [["%s: %s, greatest" % (law, HEAD[p]), max(r["distance_m"][p] for r in counted), "m"] for p in LIMITS if counted]
    with open(os.path.join(folder, "summary.json"), "w") as file:
        json.dump({"flights": flights, "broken": broken, "headline": headline}, file, indent=2)
    if broken:
        sys.exit("\n".join(broken))


if __name__ == "__main__":
    if "--not-flown" in sys.argv[2:]:
        write_not_flown(sys.argv[1])
    else:
        main(sys.argv[1])
