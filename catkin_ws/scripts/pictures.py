#!/usr/bin/env python3
"""Takes the pictures that README.md shows out of a flight's report, coordinates rounded to what is seen.

usage: pictures.py build/demo/report/index.html FOLDER
"""
import html
import os
import re
import sys

PICTURES = {"The flight from above": "flight.svg", "Distance to the map's edge": "coverage.svg"}
NEAR = 1.5  # a point of a line nearer than this to the one before is left out [px]


def shortened(path):
    """The coordinates of a path, rounded, without points that nobody sees."""
    if re.search(r"[^MLZ\d\s,.-]", path):
        return path
    kept, last = [], None
    points = re.findall(r"([ML])\s*(-?[\d.]+),(-?[\d.]+)|(Z)", path)
    for index, (letter, x, y, close) in enumerate(points):
        if close:
            kept.append("Z")
            continue
        here = (float(x), float(y))
        ends = letter == "M" or index + 1 == len(points) or points[index + 1][0] != "L"
        if ends or max(abs(here[0] - last[0]), abs(here[1] - last[1])) >= NEAR:
            kept.append("%s%.1f,%.1f" % (letter, *here))
            last = here
    return " ".join(kept)


def compact(picture):
    """The same picture without what gnuplot leaves in it and nobody sees."""
    picture = re.sub(r"(\sd=')([^']*)'", lambda match: match[1] + shortened(match[2]) + "'", picture)
    picture = re.sub(r"(\spoints = ')([^']*)'",
                     lambda match: match[1] + re.sub(r"(\d\.\d)\d", r"\1", match[2].strip()) + "'", picture)
    picture = re.sub(r"<title>gnuplot_plot[^<]*</title>", "", re.sub(r"\s+", " ", picture))
    left = None
    while left != picture:  # groups in groups
        left, picture = picture, re.sub(r"<g\b[^>]*>\s*</g>", "", picture)
    return re.sub(r">\s*<", ">\n<", picture) + "\n"


def main(report, folder):
    with open(report, encoding="utf-8") as file:
        page = file.read()
    os.makedirs(folder, exist_ok=True)
    found = dict(re.findall(r"<h2>([^<]*)</h2>(?:<p>[^<]*</p>\s*)*(<svg.*?</svg>)", page, re.DOTALL))
    for heading, name in PICTURES.items():
        if html.escape(heading, quote=False) not in found:
            sys.exit("%s: there is no picture '%s'" % (report, heading))
        with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
            file.write(compact(found[html.escape(heading, quote=False)]))


if __name__ == "__main__":
    main(*sys.argv[1:])
