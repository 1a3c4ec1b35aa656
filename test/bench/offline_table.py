"""The table that people read of `./run bench offline`."""
import offline_score as score


def cells(figure):
    """Regions, seconds and missed samples of a peer's run."""
    if figure is None or "error" in figure:
        return "-", "-", "-"
    late = ">" if figure.get("limit_reached") else ""
    missed = f"{figure['missed']}/{figure['feasible_samples']}" if "missed" in figure else "?"
    wrong = "" if late or score.right(figure) or figure.get("missed", 0) else " wrong"
    return f"{late}{figure['regions']}", f"{late}{figure['cpu_seconds']:.4g}", missed + wrong


def line(run, figures):
    by_variant = {figure["variant"]: figure for figure in figures}
    default, unpruned = by_variant.get("default"), by_variant.get("unpruned")
    regions = f"{run['regions']}" + ("" if run["status"] == "complete" else f" {run['status']}")
    texts = [run["problem"], regions, f"{run['cpu_seconds']:.4g}"]
    if "missed" in run:
        texts += [f"{run['missed']}/{run['feasible_samples']}", f"{run['false_inside']}/{run['infeasible_samples']}",
                  f"{run['u_error']:.1e}"]
    else:
        texts += ["", "", ""]
    for figure in (default, unpruned):
        ratio = "-"
        if figure is not None and "error" not in figure:
            ratio = f"{figure['cpu_seconds'] / max(run['cpu_seconds'], 1e-9):.3g}"
        texts += [*cells(figure), ratio]
    return texts


HEADER = ["problem", "regions", "CPU s", "missed", "inside", "error", "default:", "CPU s", "missed", "ratio",
          "unpruned:", "CPU s", "missed", "ratio"]


def aligned(lines):
    widths = [max(len(text) for text in column) for column in zip(*lines)]
    return ["  ".join([texts[0].ljust(widths[0])] + [t.rjust(w) for t, w in zip(texts[1:], widths[1:])])
            for texts in lines]


def markLine(row):
    verdict = "" if "mark" not in row else f"   {row['mark']}: {'reached' if row['reached'] else 'MISSED'}"
    peer = f"   {row['peer']}: {row['peer_value']:.6g}" if "peer" in row else ""
    return f"  {row['name']}: {row['value']:.6g} {row['unit']}{verdict}{peer}"


def write(path, bench, rows):
    text = []
    if bench.peer:
        text += [f"The peer's figures: {bench.peer.text}.",
                 "ratio: its CPU time by ours; missed: feasible samples in no region; inside: infeasible ones in a region;",
                 ">: stopped by the limit.", ""]
    else:
        text += ["The reference problems were not at hand: what needs them is left out.", ""]
    pairs = bench.demo + bench.base + bench.set
    if pairs:
        text += aligned([HEADER] + [line(run, figures) for run, figures in pairs]) + [""]
    of_problems = {row["name"] for run, figures in pairs for row in score.problemRows(run, figures)}
    text += [markLine(row) for row in rows if row["name"] not in of_problems]
    missed = [row for row in rows if row.get("reached") is False]
    text += ["", f"marks missed: {len(missed)}"] + [markLine(row) for row in missed]
    with open(path, "w") as file:
        file.write("\n".join(text) + "\n")
