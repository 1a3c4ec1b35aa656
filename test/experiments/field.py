"""Page and summary of a day in the field; fails where a calibrated flight tracks worse than the uncalibrated one.

usage: field.py FOLDER, after the flights of field.sh.
"""

import html
import json
import math
import os
import subprocess
import sys

import rosbag
import yaml

FLIGHTS = ("uncalibrated", "calibrated", "covered")  # the last: calibrated, in the ranges that were proposed
EXCITATIONS = ("morning", "noon", "evening")
AXES = (("roll", "lateral"), ("pitch", "longitudinal"))
COLORS = ("#d55e00", "#56b4e9", "#0072b2")
STYLE = """body{font:16px/1.5 system-ui,sans-serif;max-width:1080px;margin:2em auto;padding:0 1em;color:#22272e}
h2{margin:1.6em 0 .2em}p{margin:.3em 0}svg{display:block;width:100%;height:auto}table{border-collapse:collapse}
td,th{padding:4px 12px;text-align:right;border-bottom:1px solid #dfe3e8}td:first-child,th:first-child{text-align:left}
.good,.bad{padding:10px 14px;border-radius:8px;color:#fff;font-weight:600}.good{background:#00775a}.bad{background:#c04a00}"""


def read_json(path):
    with open(path) as file:
        return json.load(file)


def read_yaml(path):
    with open(path) as file:
        return yaml.safe_load(file)


def gnuplot(size, lines):
    script = 'set terminal svg size %d,%d font "sans,12" background "white"\nset datafile separator ","\n' % size
    script += 'set grid lc rgb "#dddddd"\n' + "\n".join(lines)
    svg = subprocess.run(["gnuplot"], input=script, capture_output=True, text=True, check=True).stdout
    return svg[svg.index("<svg") :]


def write_rows(path, rows):
    with open(path, "w") as file:
        file.writelines(",".join("%.6g" % value for value in row) + "\n" for row in rows)
    return path


def roll_of(quaternion):
    q = quaternion
    return math.atan2(2.0 * (q.w * q.x + q.y * q.z), 1.0 - 2.0 * (q.x * q.x + q.y * q.y))


def rolls(bag_path):
    """Rows (time [s], roll [rad]) as commanded and as measured."""
    command, measured = [], []
    with rosbag.Bag(bag_path) as bag:
        start = None
        for topic, message, time in bag.read_messages():
            start = time if start is None else start
            since = (time - start).to_sec()
            if topic.endswith("roll_pitch_yawrate_thrust"):
                command.append((since, message.roll))
            elif topic.endswith("odometry"):
                measured.append((since, roll_of(message.pose.pose.orientation)))
    return command, measured


def draw_excitations(folder, calibration):
    """Command and response of roll in each flight; what was used is shaded."""
    lines = ["set multiplot layout 3,1", 'set ylabel "roll [rad]"', "set yrange [-0.6:0.6]", "set key off"]
    used = {flight["file"]: flight["windows"] for flight in calibration["axes"]["roll"]["flights"]}
    for name in EXCITATIONS:
        command, measured = rolls(os.path.join(folder, name + ".bag"))
        paths = [write_rows(os.path.join(folder, "%s_%s.csv" % (name, kind)), rows[::4])
                 for kind, rows in (("command", command), ("measured", measured))]
        lines.append("unset object")
        for first, last in used[name + ".bag"]:
            lines.append('set object rectangle from %g,graph 0 to %g,graph 1 fc rgb "#e2eef7" fs noborder behind' % (first, last))
        lines.append('set title "%s" offset 0,-0.8' % name)
        if name == EXCITATIONS[-1]:
            lines.append('set xlabel "time [s]"')
        lines.append('plot "%s" using 1:2 with lines lc rgb "#9aa4ae", "%s" using 1:2 with lines lc rgb "#0072b2"' % tuple(paths))
    return gnuplot((1040, 620), lines)


def loops(folder, calibration):
    """Rows: axis, parameter, problem file, vehicle, identified, its interval, of each flight (value, interval)."""
    hidden = read_yaml(os.path.join(folder, "hidden.yaml"))["plant"]["vehicle"]
    rows = []
    for axis, problem in AXES:
        model = read_yaml("region_maps/problems/multirotor_%s.yaml" % problem)["model"]
        tau = -1.0 / model["A"][2][2]
        found = calibration["axes"][axis]
        for name, had in (("gain", model["B"][2][0] * tau), ("tau", tau)):
            handed_out = found["model_without_delay"]
            true = hidden["%s_%s" % (axis, "time" if name == "tau" else "gain")]
            of_flights = [flight["parameters"][name] for flight in found["flights"]]
            rows.append((axis, name, had, true, handed_out[name], handed_out["intervals_95"][name], of_flights))
    return rows


def draw_loops(folder, rows):
    """Each parameter: the flights, all together, the vehicle."""
    lines = ["set multiplot layout 1,4", "set key off", 'set xtics ("morning" 1, "noon" 2, "evening" 3, "all" 4) rotate by 30 right',
             "set xrange [0.5:4.5]", 'set ytics format "%.4f"']
    for axis, name, _, true, value, interval, flights in rows:
        points = [(i + 1, f["value"], *f["interval_95"]) for i, f in enumerate(flights)] + [(4, value, *interval)]
        path = write_rows(os.path.join(folder, "%s_%s.csv" % (axis, name)), points)
        lines.append('set title "%s %s%s"' % (axis, name, " [s]" if name == "tau" else ""))
        lines.append('plot %g with lines lc rgb "#d55e00", "%s" using 1:2:3:4 with yerrorbars pt 7 ps 0.6 lc rgb "#0072b2"' % (true, path))
    return gnuplot((1040, 300), lines)


def tracking_errors(path):
    """Rows (time since the start [s], distance from the reference [m]) of a bag of validation topics."""
    with rosbag.Bag(path) as bag:
        rows = [(t.to_sec(), message.data) for _, message, t in bag.read_messages(["/validation/tracking_error"])]
    return [(time - rows[0][0], error) for time, error in rows]


def draw_tracking(folder):
    curves = []
    for flight, color in zip(FLIGHTS, COLORS):
        rows = tracking_errors(os.path.join(folder, flight, "topics.bag"))
        path = write_rows(os.path.join(folder, flight, "error.csv"), rows)
        curves.append('"%s" using 1:2 with lines lc rgb "%s" lw 1.5 title "%s maps"' % (path, color, flight))
    return gnuplot((1040, 360), ['set xlabel "time [s]"', 'set ylabel "distance from the reference [m]"', "plot " + ", ".join(curves)])


def table(head, rows):
    text = "<table><tr>" + "".join("<th>%s</th>" % cell for cell in head) + "</tr>"
    return text + "".join("<tr>" + "".join("<td>%s</td>" % cell for cell in row) + "</tr>" for row in rows) + "</table>"


def flight_row(name, summary):
    return ("<a href='%s/index.html'>%s</a>" % (name, name), "%.1f cm" % (100 * summary["tracking_rms_m"]),
            "%.1f cm" % (100 * summary["tracking_max_m"]), "%.2f %%" % (100 * summary["coverage"]), summary["verdict"])


def page(folder, calibration, summaries, rows, fall):
    damaged = summaries["damaged"]
    share = damaged["recording"]["messages"]["share"]
    parameters = [("%s %s" % row[:2], "%.3f" % row[2], "%.3f" % row[3], "%.4f" % row[4], "%.4f to %.4f" % tuple(row[5])) for row in rows]
    parts = [
        "<!DOCTYPE html><html lang='en'><head><meta charset='utf-8'><title>A day in the field</title><style>%s</style></head><body>" % STYLE,
        "<h1>A day in the field</h1><p>A vehicle has slower and weaker attitude loops than its problem files say.</p>",
        "<p class='%s'>Calibrated, its tracking error is %.0f %% less.</p>" % ("good" if fall >= 0.0 else "bad", 100 * fall),
        "<h2>1. Three flights that excite the loops</h2><p>Roll as commanded (grey) and as measured (blue). Shaded: what the "
        "identification used. In the evening the vehicle loses a rotor and tumbles. That part is left out.</p>",
        draw_excitations(folder, calibration),
        "<h2>2. One model for all flights</h2><p>Each flight with its 95 % interval, and all together with the spread between "
        "flights. The line is the vehicle. <a href='calibration/index.html'>The calibration's own report</a></p>",
        draw_loops(folder, rows),
        table(("", "problem file", "vehicle", "identified", "95 %"), parameters),
        "<h2>3. Maps of the calibrated problems</h2><p>The same figure, flown with the maps as they were, with maps of the calibrated "
        "problems, and in the wider ranges that the validation of that flight proposed.</p>",
        draw_tracking(folder),
        table(("", "tracking error, rms", "greatest", "inside the maps", "verdict"), [flight_row(f, summaries[f]) for f in FLIGHTS]),
        "<h2>4. A damaged copy of the last bag</h2><p>Parts of the file are overwritten. %.1f %% of the messages could be read. "
        "<a href='damaged/index.html'>Its validation</a> is not green:</p>" % (100 * share),
        "<p class='%s'>%s</p><ul>" % ("bad" if damaged["verdict"] != "passed" else "good", damaged["verdict"].capitalize()),
        "".join("<li>%s</li>" % html.escape(sentence) for sentence in damaged["broken"] + damaged["warnings"]),
        "</ul></body></html>\n",
    ]
    return "".join(parts)


def main(folder):
    calibration = read_yaml(os.path.join(folder, "calibration.yaml"))
    summaries = {flight: read_json(os.path.join(folder, flight, "summary.json")) for flight in FLIGHTS + ("damaged",)}
    rows = loops(folder, calibration)
    before, calibrated, after = (summaries[flight]["tracking_rms_m"] for flight in FLIGHTS)
    fall = 1.0 - max(calibrated, after) / before
    with open(os.path.join(folder, "report", "index.html"), "w") as file:
        file.write(page(folder, calibration, summaries, rows, fall))
    summary = dict(summaries["covered"])
    summary["headline"] = [
        ["tracking error rms, uncalibrated", before, "m"],
        ["tracking error rms, calibrated", calibrated, "m"],
        ["tracking error rms, in the proposed ranges", after, "m"],
        ["fall of the tracking error", 100 * fall, "%"],
    ] + [["%s %s identified" % row[:2], row[4], "s" if row[1] == "tau" else ""] for row in rows]
    with open(os.path.join(folder, "summary.json"), "w") as file:
        json.dump(summary, file, indent=2)
    for axis, name, had, true, value, interval, _ in rows:
        print("%-5s %-4s problem %.3f  vehicle %.3f  identified %.4f (%.4f to %.4f)" % ((axis, name, had, true, value) + tuple(interval)))
    print("tracking error rms: %.4f m uncalibrated, %.4f m calibrated, %.4f m in the proposed ranges" % (before, calibrated, after))
    if summaries["damaged"]["verdict"] == "passed":
        sys.exit("the validation of a damaged bag is green")
    if not fall >= 0.0:
        sys.exit("a calibrated flight tracks worse than the uncalibrated one")


if __name__ == "__main__":
    main(sys.argv[1])
