#!/usr/bin/env python3
"""Draws what a flow did step by step: python3 clouds/plot_trace.py TRACE.csv [MORE.csv ...] PICTURE.svg

One panel for each column of --trace, one line for each file; needs nothing but Python.
"""

import csv
import pathlib
import sys

COLOURS = ["#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#ff7f0e", "#8c564b"]
WIDTH, HEIGHT, LEFT, TOP, GAP = 300, 150, 70, 30, 40


def read(path):
    """Column names, and per column its (step, value) where there is one."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    if not rows or "step" not in rows[0]:
        sys.exit(f"{path} is no trace: its first line must name the columns, 'step' among them")
    return {name: [(float(r["step"]), float(r[name])) for r in rows if r[name]] for name in rows[0] if name != "step"}


def panel(name, lines, top):
    """One column of all files as SVG."""
    points = [p for line in lines for p in line]
    if not points:
        return ""
    last, low, high = max(p[0] for p in points) or 1, min(p[1] for p in points), max(p[1] for p in points)
    span = high - low or abs(high) or 1
    x = lambda step: LEFT + WIDTH * step / last
    y = lambda value: top + HEIGHT * (1 - (value - low) / span)
    text = f'<rect x="{LEFT}" y="{top}" width="{WIDTH}" height="{HEIGHT}" fill="none" stroke="#999"/>'
    text += f'<text x="{LEFT}" y="{top - 6}" font-weight="bold">{name.replace("_", " ")}</text>'
    for value in {low, high}:
        text += f'<text x="{LEFT - 4}" y="{y(value) + 4}" text-anchor="end">{value:.4g}</text>'
    text += f'<text x="{LEFT + WIDTH}" y="{top + HEIGHT + 14}" text-anchor="end">step {last:g}</text>'
    for line, colour in zip(lines, COLOURS):
        path = " ".join(f"{x(s):.1f},{y(v):.1f}" for s, v in line)
        text += f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="1.5"/>'
    return text


def main():
    if len(sys.argv) < 3 or len(sys.argv) - 2 > len(COLOURS):
        sys.exit(__doc__)
    traces = [read(path) for path in sys.argv[1:-1]]
    body, top = "", TOP
    for name in traces[0]:
        drawn = panel(name, [t.get(name, []) for t in traces], top)
        body += drawn
        top += HEIGHT + GAP if drawn else 0
    for path, colour in zip(sys.argv[1:-1], COLOURS):
        body += f'<text x="{LEFT}" y="{top}" fill="{colour}">{pathlib.Path(path).stem}</text>'
        top += 16
    picture = (f'<svg xmlns="http://www.w3.org/2000/svg" width="{LEFT + WIDTH + 20}" height="{top}" '
               f'font-family="sans-serif" font-size="12"><rect width="100%" height="100%" fill="white"/>{body}</svg>\n')
    pathlib.Path(sys.argv[-1]).write_text(picture)


if __name__ == "__main__":
    main()
