#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Reads what `calibrd-bench scenes` prints (files named, or stdin) and prints it as a table; `--bound` the one of
errors over the Cramer-Rao bound.

Seeds 1..999 are for tuning, those from 100001 for reports: never tune on a scene that a report speaks of."""
import collections
import json
import math
import sys

LAST_TUNING_SEED, FIRST_REPORT_SEED = 999, 100001
GOOD_MM, GOOD_MRAD = 5, 5
WRONG_MM, WRONG_MRAD = 10, 10
LEVELS = ("clean", "cell", "field")

LEGEND = f"""\
accepted     share of all scenes whose pose was accepted
good         accepted and within {GOOD_MM} mm and {GOOD_MRAD} mrad, of all scenes
WRONG        accepted, yet off by more than {WRONG_MM} mm or {WRONG_MRAD} mrad, or by more than {WRONG_MM} mm at the check points
mm, mrad     error of accepted poses, median / 95 %, against the pose that is right for the joints as reported: the
             true pose, but where joint zeros are off (field)
check mm     check points of the last link, root mean square of a scene, accepted ones, median / 95 %
in 95 %      share of accepted poses whose truth lies inside their 95 % ellipsoid (6 degrees of freedom): 95 % is right
NEES/6       mean squared error over claimed variance: 1 is right, above it the claim is too good, below too modest
ms           of one calibration, median / 95 %, of all scenes"""


def read_lines(files):
    return [json.loads(line) for file in files for line in file if line.strip()]


def quantile(values, share):
    """The smallest value that `share` of them do not exceed."""
    ordered = sorted(values)
    return ordered[max(0, math.ceil(share * len(ordered)) - 1)] if ordered else math.nan


def mean(values):
    values = list(values)
    return sum(values) / len(values) if values else math.nan


def rms(values):
    return math.sqrt(mean(value * value for value in values))


def number(value, digits):
    return "-" if math.isnan(value) else f"{value:.{digits}f}"


def percent(part, whole):
    return f"{100 * part / whole:.1f} %" if whole else "-"


def is_accepted(run):
    return run["verdict"] == "accepted"


def is_good(run):
    return is_accepted(run) and run["as_reported_mm"] <= GOOD_MM and run["as_reported_mrad"] <= GOOD_MRAD


def is_wrong(run):
    """Accepted and not within the bounds. What is not a number is not within them."""
    return is_accepted(run) and not (run["as_reported_mm"] <= WRONG_MM and run["as_reported_mrad"] <= WRONG_MRAD
                                     and run["check_points_mm"] <= WRONG_MM)


def row(name, runs):
    accepted = [run for run in runs if is_accepted(run)]

    def pair(key, digits):
        values = [run[key] for run in accepted]
        return f"{number(quantile(values, 0.5), digits)} / {number(quantile(values, 0.95), digits)}"

    times = [run["time_ms"] for run in runs]
    return [name, str(runs[0]["K"]), str(len(runs)), percent(len(accepted), len(runs)),
            percent(sum(map(is_good, runs)), len(runs)), str(sum(map(is_wrong, runs))),
            pair("as_reported_mm", 2), pair("as_reported_mrad", 2), pair("check_points_mm", 2),
            percent(sum(run["inside95"] for run in accepted), len(accepted)),
            number(mean(run["nees"] for run in accepted) / 6, 2),
            f"{number(quantile(times, 0.5), 0)} / {number(quantile(times, 0.95), 0)}"]


def print_columns(rows):
    widths = [max(map(len, column)) for column in zip(*rows)]
    for cells in rows:
        print("  ".join(cell.ljust(width) if i == 0 else cell.rjust(width)
                        for i, (cell, width) in enumerate(zip(cells, widths))))


def groups(runs):
    """The name and the runs of every row: all, then by level, then by robot; each by K, most views first."""
    counts = sorted({run["K"] for run in runs}, reverse=True)
    for key, values in (("", [""]), ("level", LEVELS), ("robot", sorted({run["robot"] for run in runs}))):
        for value in values:
            for count in counts:
                some = [run for run in runs if run["K"] == count and (not key or run[key] == value)]
                if some:
                    yield value or "all", some


def print_header(lines):
    runs = [run for run in lines if "error" not in run]
    seeds = [line["seed"] for line in lines]
    kind = ("for tuning" if max(seeds) <= LAST_TUNING_SEED else "for the report" if min(seeds) >= FIRST_REPORT_SEED
            else "NEITHER of one kind NOR of the other")
    print(f"seeds {min(seeds)}..{max(seeds)}, {kind} (1..{LAST_TUNING_SEED} are for tuning, from {FIRST_REPORT_SEED} for"
          " reports)")
    guesses = {(run.get("guess_mm"), run.get("guess_deg")) for run in lines}
    print("guess: " + ", ".join("none" if mm is None else f"{mm:g} mm and {deg:g} deg off" for mm, deg in guesses)
          + ("; depth alone" if any(run["depth_only"] for run in runs) else "; depth and image"))
    if any(run["jobs"] > 1 for run in runs):
        print("TIMES ARE NOT THE FIGURE: several scenes ran at a time (--jobs)")
    failed = [line for line in lines if "error" in line]
    if failed:
        print(f"not simulated: {len(failed)} scenes, seeds " + ", ".join(str(line["seed"]) for line in failed))


def print_wrong(runs):
    wrong = [run for run in runs if is_wrong(run)]
    print(f"\nwrong yet accepted: {len(wrong)} of {sum(map(is_accepted, runs))} accepted")
    for run in wrong:
        print(f"  seed {run['seed']} K {run['K']} {run['level']} {run['robot']}: {run['as_reported_mm']:.2f} mm "
              f"{run['as_reported_mrad']:.2f} mrad, check points {run['check_points_mm']:.2f} mm, claimed sigma "
              f"{run['sigma_position_mm']:.2f} mm {run['sigma_rotation_mrad']:.2f} mrad")


def print_reasons(runs):
    for count in sorted({run["K"] for run in runs}, reverse=True):
        turned_down = [run for run in runs if run["K"] == count and not is_accepted(run)]
        if turned_down:
            tally = collections.Counter(f"{run['verdict']}:{'+'.join(run['reasons'])}" for run in turned_down)
            print(f"not accepted, K {count}: " + ", ".join(f"{code} {n}" for code, n in tally.most_common()))


def print_table(lines):
    print_header(lines)
    runs = [run for run in lines if "error" not in run]
    if not runs:
        return
    head = ["", "K", "scenes", "accepted", "good", "WRONG", "mm", "mrad", "check mm", "in 95 %", "NEES/6", "ms"]
    print()
    print_columns([head] + [row(name, some) for name, some in groups(runs)])
    print_wrong(runs)
    print_reasons(runs)
    print("\n" + LEGEND)


def print_bound(lines):
    print_header(lines)
    runs = [run for run in lines if "error" not in run]
    rows = [["", "K", "poses", "RMS error", "bound, range known", "ratio", "bound, range free", "ratio"]]
    for name, unit in (("position", "mm"), ("rotation", "mrad")):
        for count in sorted({run["K"] for run in runs}, reverse=True):
            posed = [run for run in runs if run["K"] == count and f"error_{unit}" in run]
            error, known, free = (rms(run[key] for run in posed)
                                  for key in (f"error_{unit}", f"bound_known_{unit}", f"bound_free_{unit}"))
            rows.append([f"{name} {unit}", str(count), str(len(posed)), number(error, 4), number(known, 4),
                         number(error / known, 2), number(free, 4), number(error / free, 2)])
    print()
    print_columns(rows)
    print("\nCramer-Rao bound from depths of the robot's surface away from edges, root mean square over the scenes, by\n"
          "differences of rendered depths and the simulator's own noise, whole mm included. Known: the range is known to\n"
          "be right. Free: its offset (prior 20 mm) and scale (prior 0.5 %) are found beside the pose. All poses count,\n"
          "accepted or not. calibrate() finds joint zeros and a periodic range term too, which neither bound has; and it\n"
          "uses the outline in the depth, of which neither bound knows: a ratio may fall below 1.")


def main(arguments):
    bound = "--bound" in arguments
    names = [name for name in arguments if name != "--bound"]
    lines = read_lines([open(name, encoding="utf-8") for name in names] if names else [sys.stdin])
    if not lines:
        sys.exit("scenes_table.py: no lines: did calibrd-bench scenes fail?")
    twice = [key for key, n in collections.Counter((line["seed"], line.get("K")) for line in lines).items() if n > 1]
    if twice:
        sys.exit(f"scenes_table.py: seed {twice[0][0]} with K {twice[0][1]} stands there twice: one run at a time")
    (print_bound if bound else print_table)(lines)


if __name__ == "__main__":
    main(sys.argv[1:])
