#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Draws the paper's figures 8 and 9 (error for each axis, for each angle) and a table from the lines of results_run.py.

usage: results_figures.py LINES NAME TITLE DOCS_DIRECTORY
writes results/NAME_axes.svg and results/NAME_angles.svg, and the table into results.md between its markers for NAME
"""

import json
import random
import re
import statistics
import sys
from pathlib import Path
from typing import Callable, NamedTuple


class Series(NamedTuple):
    """Calibrations that are drawn in one colour."""

    name: str
    colour: str
    holds: Callable[[dict], bool]


class Quantity(NamedTuple):
    """What one figure shows: of each line, three values under `key`."""

    key: str
    names: tuple[str, str, str]
    unit: str
    published: float
    step: float


PAPER = Series("paper's method, one posture, guess", "#d95f02", lambda line: line["method"] == "paper")
THREE = Series("the same, three virtual sensors", "#8a5a00", lambda line: line["method"] == "paper, three sensors")
FULL = Series("full method, one posture, same guess", "#1b6ca8", lambda line: line["method"] == "full" and line["posture"] != "both")
BOTH = Series("full method, two postures, no guess", "#2a8a57", lambda line: line["method"] == "full" and line["posture"] == "both")
DRAWN, TABLED = (PAPER, FULL, BOTH), (PAPER, THREE, FULL, BOTH)
AXES = Quantity("position_mm", ("x", "y", "z"), "mm", 21.88, 10)
ANGLES = Quantity("angle_rad", ("roll", "pitch", "yaw"), "rad", 0.023, 0.01)

PANEL, GAP, LEFT, TOP, HEIGHT = 210, 16, 56, 60, 300
LIMITS = 2  # times the published error: what is farther off lies on the edge, as a triangle


def text(x: float, y: float, words: str, size: int = 12, anchor: str = "middle", colour: str = "#222") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" text-anchor="{anchor}" fill="{colour}">{words}</text>'


def line_across(y: float, left: float, colour: str, dash: str = "") -> str:
    return (f'<line x1="{left:.1f}" x2="{left + PANEL:.1f}" y1="{y:.1f}" y2="{y:.1f}" stroke="{colour}"'
            + (f' stroke-dasharray="{dash}"' if dash else "") + "/>")


def mark(x: float, y: float, column: int, filled: bool, beyond: int) -> str:
    style = f'class="s{column}{"" if filled else " hollow"}"'
    if beyond:
        return f'<path d="M{x - 4:.1f} {y + 7 * beyond:.1f}h8l-4 {-7 * beyond}z" {style}/>'
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" {style}/>'


def styles() -> str:
    rules = [f".s{column}{{stroke:{series.colour};fill:{series.colour};fill-opacity:.55}}" for column, series in enumerate(DRAWN)]
    return "<style>" + "".join(rules) + ".hollow{fill:none}</style>"


def panel(lines: list[dict], quantity: Quantity, axis: int, left: float) -> list[str]:
    limit = LIMITS * quantity.published
    height_of = lambda value: TOP + HEIGHT / 2 - value / limit * HEIGHT / 2
    parts = [f'<rect x="{left:.1f}" y="{TOP}" width="{PANEL}" height="{HEIGHT}" fill="none" stroke="#888"/>',
             text(left + PANEL / 2, TOP + HEIGHT + 18, quantity.names[axis], 14)]
    for tick in range(-int(limit / quantity.step), int(limit / quantity.step) + 1):
        y = height_of(tick * quantity.step)
        parts.append(line_across(y, left, "#888" if tick == 0 else "#e4e4e4"))
        if axis == 0 and tick % 2 == 0:
            parts.append(text(left - 6, y + 4, f"{tick * quantity.step:g}", 11, "end"))
    parts += [line_across(height_of(sign * quantity.published), left, "#b00", "5 4") for sign in (-1, 1)]
    dice = random.Random(axis)
    for column, series in enumerate(DRAWN):
        centre = left + PANEL * (2 * column + 1) / (2 * len(DRAWN))
        for line in filter(series.holds, lines):
            if quantity.key in line:
                value = line[quantity.key][axis]
                beyond = (value > limit) - (value < -limit)
                trusted = series is PAPER or line["verdict"] == "accepted"
                parts.append(mark(centre + dice.uniform(-22, 22), height_of(max(-limit, min(limit, value))), column, trusted,
                                  beyond))
    return parts


def figure(lines: list[dict], quantity: Quantity, title: str) -> str:
    width, height = LEFT + 3 * PANEL + 2 * GAP + 16, TOP + HEIGHT + 76
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif">',
             styles(), f'<rect width="{width}" height="{height}" fill="#fff"/>', text(LEFT, 24, title, 15, "start"),
             text(LEFT, 44, f"error in {quantity.unit}; red: largest published error, {quantity.published:g} {quantity.unit}; "
                            "triangle: farther off than is drawn; hollow: not accepted", 11, "start", "#555")]
    for axis in range(3):
        parts += panel(lines, quantity, axis, LEFT + axis * (PANEL + GAP))
    for column, series in enumerate(DRAWN):
        x = LEFT + column * (width - LEFT) / len(DRAWN)
        parts += [mark(x + 4, TOP + HEIGHT + 46, column, True, 0),
                  text(x + 12, TOP + HEIGHT + 50, series.name, 10, "start")]
    return "\n".join([*parts, "</svg>", ""])


def figures_of(lines: list[dict], quantity: Quantity, form: str) -> list[str]:
    """Per axis: median and largest size of the error."""
    sizes = [[abs(line[quantity.key][axis]) for line in lines if quantity.key in line] for axis in range(3)]
    return [f"{statistics.median(of_axis):{form}} / {max(of_axis):{form}}" if of_axis else "–" for of_axis in sizes]


def table(lines: list[dict]) -> str:
    rows = ["| method | poses | x mm | y mm | z mm | roll rad | pitch rad | yaw rad | s |", "|---|---|---|---|---|---|---|---|---|"]
    for series in TABLED:
        of_series = [line for line in lines if series.holds(line)]
        chosen = [("", of_series)]
        if series in (FULL, BOTH):
            chosen = [(", accepted", [line for line in of_series if line["verdict"] == "accepted"])]
        for suffix, some in chosen:
            seconds = f"{statistics.median(line['ms'] for line in of_series) / 1e3:.1f}"
            rows.append("| " + " | ".join([series.name + suffix, f"{len(some)} of {len(of_series)}",
                                           *figures_of(some, AXES, ".2f"), *figures_of(some, ANGLES, ".4f"), seconds]) + " |")
    return "\n".join(rows)


def main() -> None:
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    source, name, title, docs = sys.argv[1:]
    lines = [json.loads(line) for line in Path(source).read_text().splitlines()]
    folder, page = Path(docs, "results"), Path(docs, "results.md")
    folder.mkdir(exist_ok=True)
    Path(folder, f"{name}_axes.svg").write_text(figure(lines, AXES, f"{title}: error for each axis"))
    Path(folder, f"{name}_angles.svg").write_text(figure(lines, ANGLES, f"{title}: error for each angle"))
    print(table(lines))
    between = re.compile(rf"(<!-- {name} -->\n).*?(\n<!-- end -->)", re.DOTALL)
    page.write_text(between.sub(lambda match: match[1] + table(lines) + match[2], page.read_text()))


if __name__ == "__main__":
    main()
