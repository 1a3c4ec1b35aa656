"""Page and summary of TinyMPC's microcontroller benchmark. Fails where map and online solver answer differently, where the filter of
(state, wish) leaves the limits, and where it is within the bars in no type.

usage: embedded.py FOLDER, after embedded.sh exported map and solvers there.
"""

import ctypes
import json
import math
import os
import statistics
import subprocess
import sys

import embedded_filter as safety
import embedded_program as benchmark
import measure_export as measured_code

# Folder, title, type, call, and whether a workspace is needed.
VARIANTS = (
    ("map_double", "map, double", "double", "filter_evaluate(theta, u)", False),
    ("online_double", "online solver, double", "double", "filter_solve(&workspace, theta, u)", True),
    ("online_float", "online solver, float", "float", "filter_solve(&workspace, theta, u)", True),
)
# What the filter of (state, wish) is to need at most for 2 states: bytes of flash and of stack, instructions.
BARS = (24000, 128, 1700)
AXES = 16  # of 32 states
# Peers, and the variables that name their code (README.md).
PEERS = (("TinyMPC", "POLYFLY_TINYMPC"), ("OSQP", "POLYFLY_OSQP"))
NOISE_SEED = 1
FLAGS = measured_code.FLAGS
FLASH = 1 << 20  # of the board that the benchmark ran on [bytes]
TOLERANCE = {"double": 1e-7, "float": 2e-2}  # [m/s^2]
# Recorded in the benchmark's repository, folder Results, for 2 states and horizon 10.
PUBLISHED = (("TinyMPC", "57.0 ms", "57.1 ms", "206,032 B", "13,156 B"), ("OSQP", "4.6 ms", "172 ms", "213,352 B", "21,212 B"),
             ("TinyMPC, 32 states", "1.74 s", "1.74 s", "255,904 B", "46,772 B"), ("OSQP, 32 states", "does not fit", "", "", ""))
STYLE = """body{font:16px/1.5 system-ui,sans-serif;max-width:1080px;margin:2em auto;padding:0 1em;color:#22272e}
h2{margin:1.6em 0 .2em}svg{display:block;width:100%;height:auto}table{border-collapse:collapse}
td,th{padding:4px 12px;text-align:right;border-bottom:1px solid #dfe3e8}td:first-child,th:first-child{text-align:left}"""


def compile_library(place):
    measured_code.run(["cc", *FLAGS, "-shared", "-fPIC", "filter.c", "-o", "filter.so"], place)


def fly_map(folder):
    """Rows (theta, u, wish, whether the map has an answer), and the last state. From rest at 0. Without an answer the
    greatest input towards the middle is applied."""
    compile_library(os.path.join(folder, "map_double"))
    library = ctypes.CDLL(os.path.abspath(os.path.join(folder, "map_double", "filter.so")))
    x = v = 0.0
    rows = []
    for t in range(benchmark.STEPS):
        theta = (x, v, math.sin(benchmark.STEP * t), math.cos(benchmark.STEP * t))
        found = ctypes.c_double(0.0)
        has_answer = library.filter_evaluate((ctypes.c_double * 4)(*theta), ctypes.byref(found)) == 0
        u = found.value if has_answer else math.copysign(benchmark.INPUT_LIMIT, -x)
        rows.append((theta, u, benchmark.wish_at(x, v, t), has_answer))
        x, v = benchmark.advance(x, v, u)
    return rows, (x, v)


def is_outside(x, v):
    return max(abs(x), abs(v)) > benchmark.STATE_LIMIT + 1e-9


def count(folder, variant, thetas):
    """What measured.count tells of a variant of the filter."""
    name, _, real, call, has_workspace = variant
    return measured_code.count(os.path.join(folder, name), measured_code.Code("filter", real, call, has_workspace), thetas)


def differences(answers, rows, real):
    """Where the map has an answer: how many differ in status, or in u by more than rounding."""
    return sum(status != 0 or abs(u - expected) > TOLERANCE[real]
               for (status, _, u), (_, expected, _, has_answer) in zip(answers, rows) if has_answer)


def states_outside(rows, last):
    """Of the states that inputs led to."""
    return sum(is_outside(x, v) for x, v in [theta[:2] for theta, _, _, _ in rows[1:]] + [last])


def safe_filter(folder, real):
    """(results of the filter of (state, wish), rows of its flight). Flown by the exported code itself, without noise and with it."""
    place = os.path.join(folder, "safe_" + real)
    variant = ("safe_" + real, "", real, "filter_evaluate(theta, u)", False)
    compile_library(place)
    evaluate = safety.compiled(place, real)
    rows, last = safety.fly(evaluate)
    noisy, noisy_last = safety.fly(evaluate, NOISE_SEED)
    with open(os.path.join(place, "filter.json")) as file:
        told = json.load(file)
    thetas = [theta for theta, _, _, _ in rows + noisy] + safety.sampled() + measured_code.vectors(place, "filter", told)
    flash, ram, stack, answers = count(folder, variant, thetas)
    near = safety.nearby(thetas, [answer[1] for answer in answers])
    instructions = [answer[1] for answer in answers] + [answer[1] for answer in count(folder, variant, near)[3]]
    bound = max(told.get("error_bound", [0.0]))
    result = {
        "regions": told["regions"], "flash_bytes": flash, "ram_bytes": ram, "stack_bytes": stack, "inputs": len(instructions),
        "instructions_median": statistics.median(answer[1] for answer in answers[:len(rows)]), "instructions_greatest": max(instructions),
        "multiply_adds_bound": told["worst_case"]["multiply_adds"],
        "error_bound": bound, "changed": sum(abs(row[1] - row[0][2]) > bound for row in rows), "steps": len(rows),
        "states_outside": states_outside(rows, last), "states_outside_with_noise": states_outside(noisy, noisy_last),
        "without_solution": sum(not row[3] for row in rows + noisy),
        "different_answers": differences(answers, rows + noisy, real) if len(answers) == len(thetas) else len(thetas)}
    result["holds"] = all(value <= bar for value, bar in zip((flash, stack, max(instructions)), BARS))
    result["error_allowed"] = told["error_allowed"][0]
    return result, rows


def is_sound(result):
    return result["error_bound"] <= result["error_allowed"] and not any(result[key] for key in (
        "states_outside", "states_outside_with_noise", "without_solution", "different_answers"))


def gnuplot(lines):
    script = 'set terminal svg size 1040,300 font "sans,12" background "white"\nset grid lc rgb "#dddddd"\nset xlabel "time [s]"\nset key outside\n'
    svg = subprocess.run(["gnuplot"], input=script + "\n".join(lines), capture_output=True, text=True, check=True).stdout
    return svg[svg.index("<svg"):]


def draw(folder, name, rows):
    path = os.path.join(folder, name + ".csv")
    with open(path, "w") as file:
        file.writelines("%.6g %.6g %.6g %.6g %.6g %d\n" % (benchmark.STEP * t, theta[0], theta[1], u, wish, has_answer)
                        for t, (theta, u, wish, has_answer) in enumerate(rows))
    curve = '"%s" using 1:%s with %s lc rgb "%s" title "%s"'
    limits = '%g lc rgb "#22272e" dt 2 title "limits", %g lc rgb "#22272e" dt 2 notitle'
    state = limits % (benchmark.STATE_LIMIT, -benchmark.STATE_LIMIT)
    inputs = limits % (benchmark.INPUT_LIMIT, -benchmark.INPUT_LIMIT)
    missing = curve % (path, "($6 == 0 ? $2 : 1/0)", "points pt 7 ps 0.4", "#d55e00", "no solution")
    return gnuplot(['set ylabel "x [m], v [m/s]"', "set yrange [-2:2]", "plot " + ", ".join(
        [curve % (path, "2", "lines lw 2", "#0072b2", "x"), curve % (path, "3", "lines lw 2", "#56b4e9", "v"), missing, state])]) + gnuplot(
        ['set ylabel "u [m/s^2]"', "set yrange [-6:6]", "plot " + ", ".join(
            [curve % (path, "5", "lines", "#9aa4ae", "wish"), curve % (path, "4", "lines lw 2", "#0072b2", "u"), inputs])])


def table(head, rows):
    text = "<table><tr>" + "".join("<th>%s</th>" % cell for cell in head) + "</tr>"
    return text + "".join("<tr>" + "".join("<td>%s</td>" % cell for cell in row) + "</tr>" for row in rows) + "</table>"


def filter_section(filters, pictures):
    rows = []
    for real, result in filters.items():
        numbers = (result["instructions_median"], result["instructions_greatest"], AXES * result["instructions_greatest"])
        rows.append(("map, " + real, result["regions"], "{:,} B".format(result["flash_bytes"]), "%d B" % result["ram_bytes"],
                     "%d B" % result["stack_bytes"], *("{:,.0f}".format(number) for number in numbers),
                     "%d of %d" % (result["states_outside"], result["steps"]), "yes" if result["holds"] else "no"))
    rows.append(("at most", "", "{:,} B".format(BARS[0]), "0 B", "%d B" % BARS[1], "", "{:,}".format(BARS[2]),
                 "{:,}".format(AXES * BARS[2]), "0", ""))
    single = filters["float"]
    return [
        "<h2>A filter of (state, wish), with an invariant set</h2>",
        "<p>Another program for the same task (<code>region_maps/problems/safety/double_integrator.yaml</code>): the input that is nearest "
        "to the wish and keeps the state in the maximal robust control invariant set. The noise of the benchmark, 0.01 in both states, is "
        "its disturbance. It has 3 parameters, and no horizon. The caller limits the wish to the input's range, which changes no answer.</p>",
        table(("", "regions", "flash (code and tables)", "RAM without stack", "stack", "instructions, median", "greatest",
               "greatest, 32 states", "states outside", "within"), rows),
        "<p>The greatest number is that of %s inputs: both flights, samples of the box, the vectors of <code>filter_test.c</code>, "
        "and samples beside the worst of them. No parameter takes more multiply-adds than these, which is proven: %s. The stack is the sum of all functions of the code. "
        "With noise, %d states of another flight leave the limits.</p>"
        % ("{:,}".format(single["inputs"]),
           ", ".join("%s %d" % (real, result["multiply_adds_bound"]) for real, result in filters.items()),
           sum(result["states_outside_with_noise"] for result in filters.values())),
        "<p>The proof of each set counts on an error of the input, which holds what the code rounds (<code>is_allowed</code> in "
        "<code>filter.json</code>): %s. Integers of 16 bits need so much because the filter's laws are steep: a position that is off by x "
        "changes the admissible input by up to x / (h^2 / 2), which is 800 x. That set is smaller.</p>"
        % ", ".join("%s %.2g of %.2g m/s^2" % (real, result["error_bound"], result["error_allowed"]) for real, result in filters.items()),
        "<p>In double, stack and instructions exceed the bars: this processor has no unit for doubles, so that each sum calls a routine.</p>",
        "<p>Flown by the code in float, from the same start. It changes the limited wish in %d of %d steps.</p>" % (single["changed"], single["steps"]),
        pictures]


def peers_sentences(peers, missing):
    told = "Peers are measured where a variable names an object or library of theirs (test/experiments/README.md)."
    for title, result in peers.items():
        told += (" %s has no answer at %d of the inputs. Where it and the map have one, they differ by %.2g m/s^2 at most, %.2g in the median."
                 % (title, result["without_answer"], result["greatest_difference"], result["median_difference"]))
    return told + (" Not named: %s." % ", ".join(missing) if missing else "")


def measure_peers(folder, rows):
    """(rows of the table, results by name, variables that name nothing). Answers are compared, but only told: peers stop at a tolerance."""
    table_rows, results, missing = [], {}, []
    for title, variable in PEERS:
        library = os.environ.get(variable, "")
        if not library:
            missing.append(variable)
            continue
        place = os.path.join(folder, variable.lower())
        os.makedirs(place)
        flash, ram, answers = measured_code.count_library(place, os.path.abspath(library), "float", [row[0] for row in rows])
        compared = [abs(u - row[1]) for (status, _, u), row in zip(answers, rows) if row[3] and status == 0]
        instructions = [answer[1] for answer in answers]
        results[title] = {"flash_bytes": flash, "ram_bytes": ram, "instructions_median": statistics.median(instructions),
                          "instructions_greatest": max(instructions), "without_answer": sum(answer[0] != 0 for answer in answers),
                          "greatest_difference": max(compared, default=0.0),
                          "median_difference": statistics.median(compared or [0.0])}
        table_rows.append((title, flash, ram, results[title]["instructions_median"], max(instructions)))
    return table_rows, results, missing


def page(summary, measured, pictures):
    rows = [(title, "{:,} B".format(flash), "yes" if flash <= FLASH else "no", "%d B" % ram, "{:,.0f}".format(median), "{:,}".format(worst))
            for title, flash, ram, median, worst in measured]
    return "\n".join([
        "<!DOCTYPE html><html lang='en'><head><meta charset='utf-8'><title>A published embedded benchmark</title><style>%s</style></head><body>" % STYLE,
        "<h1>A published embedded benchmark, answered</h1>",
        "<p>TinyMPC's safety filter on a double integrator (RoboticExplorationLab/mcu-solver-benchmarks): 10 states, 9 inputs, "
        "sampled at 0.05 s. For one axis this is a program of 4 parameters, x, v, and sine and cosine of the reference's phase.</p>",
        "<h2>The same program, in one emulator, on the same %d inputs</h2>" % benchmark.STEPS,
        table(("", "flash (code and tables)", "fits 1 MB", "RAM without stack", "instructions, median", "greatest"), rows),
        "<p>Counted by qemu on a Cortex-M4F with 4 MB of memory for code. These are instructions, not cycles. On that processor "
        "double is computed in software. The map counts states beyond the limits as outside; the solver's program does not bound the first "
        "state. An axis is solved alone: "
        "32 states are 16 axes, 16 times the instructions, with the same flash and RAM.</p>",
        "<h2>Published by others, on a board of 168 MHz</h2>",
        table(("", "time of a step, median", "greatest", "flash of the sketch", "RAM of the sketch"), PUBLISHED),
        "<h2>What is fair, and what is not</h2><ul>"
        "<li>A map is for one model and one family of references. Theirs takes any reference.</li>"
        "<li>Their flash and RAM are those of whole Arduino sketches, with the runtime library. Ours are of the solver alone.</li>"
        "<li>In the median step, TinyMPC stopped at its limit of 500 iterations.</li>"
        "<li>Their solvers stopped at a tolerance of 1e-2. Map and solver here are exact up to rounding.</li>"
        "<li>Instructions of an emulator are not milliseconds of a board: memory and caches are not in them.</li>"
        "<li>The online solver's greatest number is of these inputs. Its iteration limit bounds all others.</li>"
        "<li>The filter of (state, wish) is another program. It has one wish, the published one nine. It keeps all states to come in the "
        "limits, the published one nine.</li>"
        "<li>%s</li></ul>" % peers_sentences(summary["peers"], summary["peers_missing"]),
        "<h2>What the published filter does</h2><p>Flown by the map. The program has no solution in %d of %d steps; there the greatest input towards "
        "the middle is applied. %d states leave the limits: the horizon has no terminal set.</p>"
        % (summary["without_solution"], benchmark.STEPS, summary["states_outside"]),
        pictures["published"],
        *filter_section(summary["filter"], pictures["filter"]),
        "<h2>On a board of your own</h2><p>Compile <code>filter_test.c</code> with <code>FILTER_TEST_NO_MAIN</code>, define "
        "<code>FILTER_TEST_BEGIN()</code> and <code>FILTER_TEST_END()</code> to read a cycle counter, for example DWT_CYCCNT, and call "
        "<code>filter_test()</code>. Its first vectors are those with the most operations.</p></body></html>", ""])


def main(folder):
    rows, last = fly_map(folder)
    summary = {"without_solution": sum(not row[3] for row in rows), "states_outside": states_outside(rows, last), "variants": {}}
    measured, wrong = [], 0
    for variant in VARIANTS:
        flash, ram, _, answers = count(folder, variant, [row[0] for row in rows])
        instructions = [answer[1] for answer in answers]
        different = differences(answers, rows, variant[2]) if len(answers) == len(rows) else len(rows)
        wrong += different
        measured.append((variant[1], flash, ram, statistics.median(instructions), max(instructions)))
        summary["variants"][variant[0]] = {"flash_bytes": flash, "ram_bytes": ram, "instructions_median": measured[-1][3],
                                           "instructions_greatest": measured[-1][4], "different_answers": different}
    others, summary["peers"], summary["peers_missing"] = measure_peers(folder, rows)
    measured += others
    summary["headline"] = [[title + ": instructions, greatest", worst, ""] for title, _, _, _, worst in measured]
    summary["headline"] += [["steps without a solution", summary["without_solution"], ""], ["states outside", summary["states_outside"], ""]]
    flights = {real: safe_filter(folder, real) for real in ("double", "float")}
    summary["filter"] = {real: result for real, (result, _) in flights.items()}
    for real, (result, _) in flights.items():
        summary["headline"] += [["filter of (state, wish), %s: instructions, greatest" % real, result["instructions_greatest"], ""],
                                ["filter of (state, wish), %s: states outside" % real, result["states_outside"], ""]]
    with open(os.path.join(folder, "summary.json"), "w") as file:
        json.dump(summary, file, indent=2)
    with open(os.path.join(folder, "report", "index.html"), "w") as file:
        file.write(page(summary, measured, {"published": draw(folder, "flight", rows), "filter": draw(folder, "safe_flight", flights["float"][1])}))
    sound = all(is_sound(result) for result in summary["filter"].values())
    return 0 if not wrong and sound and any(result["holds"] for result in summary["filter"].values()) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
