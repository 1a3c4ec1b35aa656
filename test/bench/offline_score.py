"""What the figures of `./run bench offline` amount to: ratios to the peer, sums, and the marks to reach.

Every function returns rows {"name", "value", "unit"}, with "peer" and "peer_value" where there is one, and with
"mark" (what to reach) and "reached" where there is a mark.
"""
import math

SHORT = 1e-3  # s; what takes less is left out of the least ratio
U_ERROR = 1e-6  # greatest relative error of u against the samples
MUST_SOLVE = ("di_N15", "mplp_di_inf_N5", "mplp_multirotor_inf_N3", "rnd_n6_m20_t3", "deg_scs_lowdim")


def row(name, value, unit="", peer=None, mark=None):
    result = {"name": name, "value": value, "unit": unit}
    if peer is not None:
        result.update(peer=peer[0], peer_value=peer[1])
    if mark is not None:
        sense, bound = mark
        result["mark"] = f"at {'most' if sense == '<=' else 'least'} {bound:.6g}"
        result["reached"] = value <= bound if sense == "<=" else value >= bound
    return result


def toolName(figure):
    return f"{figure['tool']}, {figure['variant']}"


def right(figure):
    """Whether the peer's run ended and agrees with all samples."""
    return (not figure.get("limit_reached") and figure.get("missed", 0) == 0 and figure.get("false_inside", 0) == 0
            and figure.get("feasible_samples", 1) > 0 and figure.get("u_error", 0.0) <= U_ERROR
            and figure.get("objective_error", 0.0) <= U_ERROR)


def ours(run):
    """Whether our run is complete and agrees with all samples."""
    return (run["status"] == "complete" and run.get("missed", 0) == 0 and run.get("false_inside", 0) == 0
            and run.get("u_error", 0.0) <= U_ERROR)


def problemRows(run, figures):
    """One problem: regions, time and what the samples say, each beside the peer's default, or what there is of it."""
    name = run["problem"] + ("" if run["status"] == "complete" else f" ({run['status']})")
    figure = next((f for f in figures if "error" not in f), None)

    def beside(key):
        if figure is None or key not in figure:
            return None
        return toolName(figure) + (" (limit reached)" if figure.get("limit_reached") else ""), figure[key]

    rows = [row(f"{name}: regions", run["regions"], "", beside("regions")),
            row(f"{name}: CPU time", run["cpu_seconds"], "s", beside("cpu_seconds"))]
    for other in figures[1:]:
        if "error" not in other:
            rows.append(row(f"{name}: CPU time", run["cpu_seconds"], "s", (toolName(other) + (
                " (limit reached)" if other.get("limit_reached") else ""), other["cpu_seconds"])))
    if "missed" in run:
        rows += [row(f"{name}: samples missed", run["missed"], f"of {run['feasible_samples']}", beside("missed"),
                     ("<=", 0)),
                 row(f"{name}: infeasible samples inside", run["false_inside"], f"of {run['infeasible_samples']}",
                     beside("false_inside"), ("<=", 0)),
                 row(f"{name}: greatest relative error of u", run["u_error"], "", beside("u_error"),
                     ("<=", U_ERROR))]
    return rows


def losesRegions(figure, figures):
    """Whether a variant has fewer regions than the other, when both ended: the samples do not meet every region."""
    return any(other["regions"] > figure["regions"] for other in figures
               if "error" not in other and not other.get("limit_reached"))


def ratiosTo(pairs, variant):
    """How many times faster we are than one variant, a dict for each problem on which it ended."""
    found = []
    for run, figures in pairs:
        for figure in figures:
            if figure["variant"] == variant and not figure.get("limit_reached"):
                found.append({"problem": run["problem"], "right": right(figure) and not losesRegions(figure, figures),
                              "ours": ours(run), "ratio": figure["cpu_seconds"] / max(run["cpu_seconds"], 1e-9),
                              "long": max(figure["cpu_seconds"], run["cpu_seconds"]) > SHORT})
    return found


def ratioRows(pairs, variant, prefix=""):
    """`pairs`: (our run, the peer's figures). How many times faster we are than one variant. A peer that loses
    regions has less to do: where it is wrong, its time is shown but proves nothing."""
    found = ratiosTo(pairs, variant)
    label = f"{prefix}times faster than '{variant}'"
    solved = [r["ratio"] for r in found if r["right"] and r["ours"]]
    rows = []
    if solved:
        mean = math.exp(sum(map(math.log, solved)) / len(solved))
        rows.append(row(f"{label}, geometric mean of the {len(solved)} problems that it solves", mean, "", None,
                        (">=", 3.0)))
        rows.append(row(f"{label}, median of them", sorted(solved)[len(solved) // 2]))
    for is_right, what, mark in ((True, "solves", (">=", 1.0)), (False, "gets wrong", None)):
        long_ones = sorted((r["ratio"], r["problem"]) for r in found if r["long"] and r["right"] == is_right)
        if long_ones:
            slower = [f"{name} {ratio:.2f}" for ratio, name in long_ones if ratio < 1.0]
            which = ", ".join(slower) if slower else long_ones[0][1]
            rows.append(row(f"{label}, least of the {len(long_ones)} over 1 ms that it {what} ({which})",
                            long_ones[0][0], "", None, mark))
    return rows


def baseRows(pairs):
    """Sums over the base problems, as (our run, the peer's figures)."""
    rows = ratioRows(pairs, "default") + ratioRows(pairs, "unpruned")
    for run, figures in pairs:
        if run["problem"] == "multirotor_N20":
            for figure in figures:
                if "error" not in figure:
                    rows.append(row(f"multirotor_N20: times faster than '{figure['variant']}'"
                                    + (", which reached its limit" if figure.get("limit_reached") else ""),
                                    figure["cpu_seconds"] / run["cpu_seconds"], "", None, (">=", 100.0)))
        if run["problem"] in MUST_SOLVE:
            rows.append(row(f"{run['problem']}: complete and right (1: yes)", int(ours(run)), "", None, (">=", 1)))
            rows.append(row(f"{run['problem']}: CPU time, which must be short", run["cpu_seconds"], "s", None, ("<=", 1.0)))
    wrong = [run["problem"] for run, _ in pairs if not ours(run)]
    rows.append(row("base problems not complete or not right" + (f" ({', '.join(wrong)})" if wrong else ""), len(wrong),
                    f"of {len(pairs)}", None, ("<=", 0)))
    return rows


def rate(runs, key):
    return sum(run["regions"] for run in runs) / max(sum(run[key] for run in runs), 1e-9)


def wholeRows(run):
    """A problem that takes longer than the limit of a run, solved without one."""
    name = f"{run['problem']}, without the limit, {run['threads']} thread{'s' if run['threads'] > 1 else ''}"
    return [row(f"{name}: complete (1: yes)", int(run["status"] == "complete"), "", None, (">=", 1)),
            row(f"{name}: regions", run["regions"]),
            row(f"{name}: CPU time", run["cpu_seconds"], "s"),
            row(f"{name}: time", run["wall_seconds"], "s"),
            row(f"{name}: peak memory", run["peak_bytes"], "B"),
            row(f"{name}: missed samples", run["missed"], f"of {run['feasible_samples']}", None, ("<=", 0)),
            row(f"{name}: infeasible samples inside", run["false_inside"], f"of {run['infeasible_samples']}", None,
                ("<=", 0)),
            row(f"{name}: greatest error of u", run["u_error"], "", None, ("<=", U_ERROR))]


def setRows(pairs, doubles, limit, whole=None):
    """The cdc24 set: rates, what was stopped by the limit. `doubles`: our runs with two threads; `whole`: earlier runs
    without the limit, by the name of the problem."""
    runs = [run for run, _ in pairs]
    stopped = [run["problem"] for run in runs if run["status"] != "complete"]
    whole = {name: run for name, run in (whole or {}).items() if name in stopped}
    stopped = [name for name in stopped if not (name in whole and ours(whole[name]))]
    rows = ratioRows(pairs, "default", "cdc24: ") + ratioRows(pairs, "unpruned", "cdc24: ")
    rows.append(row("cdc24: regions of all problems", sum(run["regions"] for run in runs)))
    peers = [None]
    for variant in ("default", "unpruned"):
        figures = [f for _, fs in pairs for f in fs if f["variant"] == variant and "error" not in f]
        if figures:
            wrong = len(figures) - sum(r["right"] for r in ratiosTo(pairs, variant))
            peers.append((f"{toolName(figures[0])}, {wrong} of {len(figures)} stopped or wrong",
                          rate(figures, "cpu_seconds")))
    for peer in peers[1:] or peers:
        rows.append(row("cdc24: regions per CPU second, one thread", rate(runs, "cpu_seconds"), "1/s", peer,
                        (">=", 8000)))
    if doubles:
        rows.append(row("cdc24: regions per second, two threads", rate(doubles, "wall_seconds"), "1/s"))
        rows.append(row("cdc24: two threads, times the rate of one",
                        rate(doubles, "wall_seconds") / rate(runs, "wall_seconds"), "", None, (">=", 1.7)))
    rows.append(row(f"cdc24: stopped after {limit:g} s or incomplete, and not solved without the limit"
                    + (f" ({', '.join(stopped)})" if stopped else ""), len(stopped), f"of {len(runs)}", None, ("<=", 0)))
    for run in whole.values():
        rows += wholeRows(run)
    if whole and not stopped:
        all_runs = [run for run in runs if run["status"] == "complete"] + list(whole.values())
        rows.append(row("cdc24: regions of all problems, each solved whole", sum(run["regions"] for run in all_runs)))
        rows.append(row("cdc24: regions per CPU second, each solved whole, of one thread or what its row says",
                        rate(all_runs, "cpu_seconds"), "1/s", None, (">=", 8000)))
    wrong = [r["problem"] for r in runs if r["status"] == "complete" and not ours(r)]
    rows.append(row("cdc24: complete, but against a sample" + (f" ({', '.join(wrong)})" if wrong else ""), len(wrong),
                    f"of {len(runs)}", None, ("<=", 0)))
    return rows


def lookupRows(run, time_mark=None, depth_mark=False):
    """Look-ups and tree of one map; `time_mark`: of the median [ns]."""
    label = f"{run['problem']} ({run['regions']} regions, {run['parameters']} parameters)"
    depth = ("<=", 2.0 * math.log2(run["regions"]) + 4.0) if depth_mark else None
    time = ("<=", time_mark) if time_mark else None
    return [row(f"{label}: look-up, random regions, median", run["regions_median_ns"], "ns", None, time),
            row(f"{label}: look-up, random regions, 99 %", run["regions_99_ns"], "ns"),
            row(f"{label}: look-up, random in the box, median", run["box_median_ns"], "ns"),
            row(f"{label}: look-up, all caches emptied, median", run["cold_median_ns"], "ns"),
            row(f"{label}: tree depth", run["depth"], "", None, depth),
            row(f"{label}: half-spaces tested in a leaf, most", run["region_checks"]),
            row(f"{label}: multiply-adds of a look-up, most", run["multiply_adds"]),
            row(f"{label}: tree nodes, with leaves", treeSize(run)),
            row(f"{label}: tree, CPU time", run["tree_cpu_seconds"], "s")]


def treeSize(run):
    """Interior nodes and the children of them that are leaves, as the peer counts."""
    return 2 * run["nodes"] + 1


def springRows(run, peer_nodes, peer_depth):
    peer = "ParametricDAQP 0.6.1 (noted)"
    return [row("mass_spring4_N5: tree nodes, with leaves", treeSize(run), "", (peer, peer_nodes),
                ("<=", peer_nodes / 4)),
            row("mass_spring4_N5: tree depth", run["depth"], "", (peer, peer_depth), ("<=", peer_depth)),
            row("mass_spring4_N5: tree, CPU time", run["tree_cpu_seconds"], "s")]


def certificateRows(run, mark):
    name = f"{run['problem']} ({run['regions']} regions): exact certificate"
    if run["limit_reached"]:
        name += ", stopped"
    return [row(f"{name}, {run['threads']} threads", run["wall_seconds"], "s", None, ("<=", mark)),
            row(f"{name} passes (1: yes)", int(run["passed"]), f"{run['defects']} defects", None, (">=", 1))]


def memoryRows(runs):
    return [row(f"{run['problem']} ({run['regions']} regions, 4 parameters): peak memory of a region",
                run["peak_bytes"] / max(run["regions"], 1), "B", None, ("<=", 2000)) for run in runs]
