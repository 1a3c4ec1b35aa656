"""Curves over a common axis as an SVG file."""
import html
import math

WIDTH, HEIGHT, MARGIN = 860, 480, 60  # [px]
COLOURS = ("#2f79b5", "#d67528", "#4f8f4f", "#7d5ba6")


def _ticks(lower, upper, most=8):
    """Round numbers within the range."""
    power = 10.0 ** math.floor(math.log10((upper - lower) / most))
    step = next(power * factor for factor in (1, 2, 5, 10) if (upper - lower) / (power * factor) <= most)
    return [step * i for i in range(math.ceil(lower / step), math.floor(upper / step) + 1)]


def write_chart(path, title, labels, x, curves):
    """`labels`: of both axes; `curves`: {name: values}, as long as x."""
    x_range = min(x), max(x)
    low, high = (bound(bound(values) for values in curves.values()) for bound in (min, max))
    y_range = low - 0.05 * (high - low), high + 0.05 * (high - low)

    def place(value, limits, first, last):
        return first + (last - first) * (value - limits[0]) / (limits[1] - limits[0])

    def at(a, b):
        return (f"{place(a, x_range, MARGIN, WIDTH - MARGIN):.1f}", f"{place(b, y_range, HEIGHT - MARGIN, MARGIN):.1f}")

    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" font-family="Helvetica" '
             'font-size="13"><rect width="100%" height="100%" fill="#ffffff"/>',
             f'<text x="{WIDTH / 2}" y="28" text-anchor="middle" font-size="16">{html.escape(title)}</text>',
             f'<text x="{WIDTH / 2}" y="{HEIGHT - 14}" text-anchor="middle">{html.escape(labels[0])}</text>',
             f'<text x="16" y="{MARGIN - 16}">{html.escape(labels[1])}</text>']
    for value in _ticks(*x_range):
        left, bottom = at(value, y_range[0])
        parts.append(f'<path d="M{left},{bottom}V{MARGIN}" stroke="#e3e7eb"/>'
                     f'<text x="{left}" y="{float(bottom) + 18:.1f}" text-anchor="middle">{value:.3g}</text>')
    for value in _ticks(*y_range):
        left, bottom = at(x_range[0], value)
        parts.append(f'<path d="M{left},{bottom}H{WIDTH - MARGIN}" stroke="#e3e7eb"/>'
                     f'<text x="{float(left) - 6:.1f}" y="{float(bottom) + 4:.1f}" text-anchor="end">{value:.3g}</text>')
    for index, (name, values) in enumerate(curves.items()):
        colour = COLOURS[index % len(COLOURS)]
        points = " ".join(",".join(at(a, b)) for a, b in zip(x, values))
        parts.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="2"/>'
                     f'<text x="{WIDTH - MARGIN - 6}" y="{HEIGHT - MARGIN - 12 - 18 * index}" text-anchor="end" fill="{colour}">'
                     f"{html.escape(name)}</text>")
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join(parts) + "\n</svg>\n")
