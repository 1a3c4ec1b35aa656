"""Table, picture and page of the calibration experiment; fails where the tracking error falls by less than a third.

usage: calibration.py FOLDER, after the flights of calibration.sh.
"""

import json
import os
import subprocess
import sys

import rosbag
import yaml

FLIGHTS = ("uncalibrated", "calibrated", "covered")  # the last: calibrated, in the ranges that were proposed
LEAST_GAIN = 1.0 / 3.0  # by which the tracking error must fall


def read_json(path):
    with open(path) as file:
        return json.load(file)


def tracking_errors(path):
    """(time since the start [s], distance from the reference [m]) of a bag of validation topics."""
    with rosbag.Bag(path) as bag:
        rows = [(t.to_sec(), message.data) for _, message, t in bag.read_messages(["/validation/tracking_error"])]
    return [(time - rows[0][0], error) for time, error in rows]


def draw(folder):
    for flight in FLIGHTS:
        with open(os.path.join(folder, flight, "error.csv"), "w") as file:
            file.writelines("%.3f,%.6f\n" % row for row in tracking_errors(os.path.join(folder, flight, "topics.bag")))
    colors = ("#d55e00", "#56b4e9", "#0072b2")
    curves = ", ".join(
        '"%s" using 1:2 with lines lc rgb "%s" lw 1.5 title "%s maps"' % (os.path.join(folder, f, "error.csv"), c, f)
        for f, c in zip(FLIGHTS, colors)
    )
    script = (
        'set terminal svg size 1040,360 font "sans,12" background "white"\nset datafile separator ","\n'
        'set grid lc rgb "#dddddd"\nset xlabel "time [s]"\nset ylabel "distance from the reference [m]"\nplot ' + curves
    )
    svg = subprocess.run(["gnuplot"], input=script, capture_output=True, text=True, check=True).stdout
    return svg[svg.index("<svg") :]


def loops(folder):
    """Rows: axis, hidden, found, what the problem file had."""
    with open(os.path.join(folder, "hidden.yaml")) as file:
        hidden = yaml.safe_load(file)["plant"]["vehicle"]
    with open(os.path.join(folder, "calibration.yaml")) as file:
        found = yaml.safe_load(file)["axes"]
    rows = []
    for axis, problem in (("roll", "lateral"), ("pitch", "longitudinal")):
        with open("region_maps/problems/multirotor_%s.yaml" % problem) as file:
            model = yaml.safe_load(file)["model"]
        tau = -1.0 / model["A"][2][2]
        handed_out = found[axis]["model_without_delay"]
        for name, had in (("gain", model["B"][2][0] * tau), ("tau", tau)):
            true = hidden["%s_%s" % (axis, "time" if name == "tau" else "gain")]
            rows.append((axis, name, had, true, handed_out[name], handed_out["intervals_95"][name]))
    return rows


def page(folder, summaries, rows):
    style = (
        "body{font-family:sans-serif;max-width:1080px;margin:2em auto;color:#22272e}"
        "td,th{padding:4px 12px;text-align:right;border-bottom:1px solid #ddd}td:first-child{text-align:left}"
    )
    text = "<!DOCTYPE html><html lang='en'><head><meta charset='utf-8'><title>Calibration</title><style>%s</style>" % style
    text += "</head><body><h1>From flight to map</h1><p>A vehicle whose attitude loops are not those of the problem files: "
    text += "flown with the maps as they are, excited, calibrated, flown with maps of the calibrated problems, and in the wider ranges "
    text += "that the validation of that flight proposed.</p>"
    text += "<table><tr><th></th><th>problem file</th><th>vehicle</th><th>identified</th><th>95 %</th></tr>"
    for axis, name, had, true, value, interval in rows:
        text += "<tr><td>%s %s</td><td>%.3f</td><td>%.3f</td><td>%.4f</td><td>%.4f to %.4f</td></tr>" % (
            (axis, name, had, true, value) + tuple(interval)
        )
    text += "</table><h2>Tracking</h2><table><tr><th></th><th>rms</th><th>greatest</th><th>inside the maps</th></tr>"
    for flight in FLIGHTS:
        s = summaries[flight]
        text += "<tr><td><a href='%s/index.html'>%s</a></td><td>%.1f cm</td><td>%.1f cm</td><td>%.2f %%</td></tr>" % (
            flight, flight, 100 * s["tracking_rms_m"], 100 * s["tracking_max_m"], 100 * s["coverage"])
    text += "</table>" + draw(folder)
    text += "<p><a href='calibration/index.html'>The calibration's own report</a></p></body></html>\n"
    return text


def main(folder):
    summaries = {flight: read_json(os.path.join(folder, flight, "summary.json")) for flight in FLIGHTS}
    rows = loops(folder)
    before, calibrated, after = (summaries[flight]["tracking_rms_m"] for flight in FLIGHTS)
    with open(os.path.join(folder, "report", "index.html"), "w") as file:
        file.write(page(folder, summaries, rows))
    summary = dict(summaries["covered"])
    summary["headline"] = [
        ["tracking error rms, uncalibrated", before, "m"],
        ["tracking error rms, calibrated", calibrated, "m"],
        ["tracking error rms, in the proposed ranges", after, "m"],
        ["fall of the tracking error", 100 * (1 - after / before), "%"],
    ] + [["%s %s identified" % row[:2], row[4], "s" if row[1] == "tau" else ""] for row in rows]
    with open(os.path.join(folder, "summary.json"), "w") as file:
        json.dump(summary, file, indent=2)
    for axis, name, had, true, value, interval in rows:
        print("%-5s %-4s problem %.3f  vehicle %.3f  identified %.4f (%.4f to %.4f)" % ((axis, name, had, true, value) + tuple(interval)))
    print("tracking error rms: %.4f m uncalibrated, %.4f m calibrated, %.4f m in the proposed ranges" % (before, calibrated, after))
    if not max(calibrated, after) <= (1.0 - LEAST_GAIN) * before:
        sys.exit("the tracking error fell by less than a third")


if __name__ == "__main__":
    main(sys.argv[1])
