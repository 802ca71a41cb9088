#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Reads what `calibrd-bench watch`, `watch-creep`, `watch-hours` and `watch-tail` print (files named, or stdin) and
prints a table of each kind that is there. With --require: exit status 1 unless all is as it must be."""
import collections
import json
import math
import random
import sys

LAST_TUNING_SEED, FIRST_REPORT_SEED = 999, 100001
RATE_HZ, YEAR_S = 30, 365.25 * 86400
VERDICTS = ("in_place", "sensor_moved", "something_in_front", "scene_changed", "robot_model_wrong",
            "depth_bias_changed", "no_evidence")
SMALLEST = 6  # mm or mrad: moves up to here are a figure of their own
LEAST_PEAKS, TAIL_SHARE, BOOTSTRAPS = 20, 0.1, 1000
LEAST_RIGHT, MOST_FRAMES, MOST_CREEP = 0.95, (15, 30), 3.0  # what must be; frames: median, 95 %; mm or mrad


def quantile(values, share):
    """The smallest value that `share` of them do not exceed."""
    ordered = sorted(values)
    return ordered[max(0, math.ceil(share * len(ordered)) - 1)] if ordered else math.nan


def seeds_of(lines):
    seeds = [line["seed"] for line in lines]
    if max(seeds) <= LAST_TUNING_SEED:
        kind = "for tuning"
    else:
        kind = "for the report" if min(seeds) >= FIRST_REPORT_SEED else "NEITHER FOR TUNING NOR FOR THE REPORT"
    return f"seeds {min(seeds)}..{max(seeds)}, {kind}"


def times(lines):
    return (f"ms of one frame on one thread, median / 99 %, worst cell: {max(l['ms_median'] for l in lines):.2f} / "
            f"{max(l['ms_99'] for l in lines):.2f}; median cell: {quantile([l['ms_median'] for l in lines], 0.5):.2f} / "
            f"{quantile([l['ms_99'] for l in lines], 0.5):.2f}")


def is_small(move):
    return move["moved_mm"] <= SMALLEST and move["turned_mrad"] <= SMALLEST


def show_frames(name, moves):
    """Median and 95 % of the frames to the verdict."""
    frames = [move["frames_to_verdict"] for move in moves if move["frames_to_verdict"] >= 0]
    print(f"  {name}: {len(moves)}, found {len(frames)}, frames median / 95 % / most: {quantile(frames, 0.5)} / "
          f"{quantile(frames, 0.95)} / {max(frames, default=math.nan)}")
    return quantile(frames, 0.5), quantile(frames, 0.95)


def show_events(lines):
    counts = collections.Counter((line["event"], line["verdict"]) for line in lines)
    right = sum(line["event"] == line["verdict"] for line in lines)
    print(f"{len(lines)} events, {seeds_of(lines)}; right: {right} ({100 * right / len(lines):.1f} %)")
    width = max(map(len, VERDICTS)) + 2
    print("staged \\ said".ljust(width) + "".join(name[:10].rjust(12) for name in VERDICTS))
    for event in VERDICTS:
        if any(line["event"] == event for line in lines):
            print(event.ljust(width) + "".join(str(counts[event, said] or "-").rjust(12) for said in VERDICTS))
    moves = [line for line in lines if line["event"] == "sensor_moved"]
    missed = [line for line in moves if line["verdict"] != "sensor_moved"]
    false = [line for line in lines if line["event"] != "sensor_moved" and "sensor_moved" in (line["verdict"],
                                                                                              line["before"])]
    print(f"moved, missed: {len(missed)} of {len(moves)}; said to have moved though it stood: {len(false)}")
    is_well = right >= LEAST_RIGHT * len(lines) and not missed
    if moves:
        is_well &= all(it <= most for it, most in zip(show_frames("all moves", moves), MOST_FRAMES))
        show_frames(f"of at most {SMALLEST} mm and {SMALLEST} mrad", [move for move in moves if is_small(move)])
    print(times(lines))
    for line in lines:
        if line["event"] != line["verdict"] or line["before"] != "in_place":
            print(f"  seed {line['seed']} {line['robot']}: {line['what']}: {line['verdict']}, before {line['before']}, "
                  f"{line['seconds']}")
    return is_well


def show_creep(lines):
    found = [line["at"] for line in lines if line["found"]]
    print(f"{len(lines)} sensors that creep, {seeds_of(lines)}: found {len(found)}; mm or mrad when found, median / most: "
          f"{quantile(found, 0.5):.2f} / {max(found, default=math.nan):.2f}")
    for line in lines:
        print(f"  seed {line['seed']} {line['robot']}: {'turned' if line['turns'] else 'shifted'} "
              f"{line['at']:.2f} {'mrad' if line['turns'] else 'mm'}{'' if line['found'] else ', NOT FOUND'}; one frame's "
              f"sigma {line['sigma_mm']:.2f} mm, {line['sigma_mrad']:.2f} mrad; range {line['offset_mm']:+.1f} mm")
    return all(line["found"] and line["at"] < MOST_CREEP for line in lines)


def show_hours(lines):
    frames = sum(line["frames"] for line in lines)
    print(f"{len(lines)} cells at work, {seeds_of(lines)}: {frames} frames = {frames / RATE_HZ / 3600:.2f} h, "
          f"{sum(line['scene_changes'] for line in lines)} changes of the scene; false alarms: "
          f"{sum(line['false_alarms'] for line in lines)}; largest statistic "
          f"{max(line['largest'] for line in lines):.2f} of {lines[0]['threshold']:.2f}")
    shown = collections.Counter()
    for line in lines:
        shown.update(line["seconds"])
    print("  shown: " + ", ".join(f"{name} {seconds:.0f} s" for name, seconds in shown.most_common()))
    unseen_s = sum(line["unseen_s"] for line in lines)
    print(f"  the pose could not be called good, for nothing showed that the sensor stands: {unseen_s:.1f} s")
    print(f"  the robot's word against the pose, of its limit, at most: {max(line['robot_doubt'] for line in lines):.2f} in postures "
          f"one by one, {max(line['creep_doubt'] for line in lines):.2f} in their mean; comparisons: {sum(line['checks'] for line in lines)}")
    print(times(lines))
    return not any(line["false_alarms"] for line in lines)


def peaks_of(blocks, share):
    return sorted(peak for block in blocks for tail in block["tails"] if tail["tolerance_share"] == share
                  for peak in tail["peaks"])


def run_length_s(blocks, share, threshold):
    """Mean time to an alarm: peaks above the highest tenth's beginning fall off exponentially (peaks over threshold)."""
    peaks = peaks_of(blocks, share)
    if len(peaks) < LEAST_PEAKS:
        return math.inf
    begin = quantile(peaks, 1 - max(TAIL_SHARE, LEAST_PEAKS / len(peaks)))
    tail = [peak - begin for peak in peaks if peak > begin]
    if not tail:
        return math.inf
    scale = sum(tail) / len(tail)
    seconds = sum(block["frames"] for block in blocks) / RATE_HZ
    return seconds / len(tail) * math.exp((threshold - begin) / scale)


def show_tail(blocks, drawn):
    threshold = drawn["threshold"]
    print(f"{drawn['resampled_h']:.0f} h drawn from {drawn['blocks']} blocks of {drawn['block_s']:.0f} s: "
          f"{drawn['alarms']} alarms, largest statistic {drawn['largest']:.2f} of {threshold:.2f}")
    for share in sorted({tail["tolerance_share"] for tail in blocks[0]["tails"]}, reverse=True):
        peaks = peaks_of(blocks, share)
        if len(peaks) < LEAST_PEAKS:
            print(f"  with {share:.0%} of the tolerance: {len(peaks)} peaks, largest {max(peaks, default=0):.2f}: no tail to fit")
            continue
        source = random.Random(1)
        again = [run_length_s(source.choices(blocks, k=len(blocks)), share, threshold) / YEAR_S for _ in range(BOOTSTRAPS)]
        print(f"  with {share:.0%} of the tolerance: mean time to a false alarm from an exponential tail of {len(peaks)} peaks, "
              f"largest {peaks[-1]:.2f}: {run_length_s(blocks, share, threshold) / YEAR_S:.3g} years; 90 % of {BOOTSTRAPS} draws "
              f"of as many blocks: {quantile(again, 0.05):.3g} to {quantile(again, 0.95):.3g} years")
        break  # less tolerance bounds it less well
    return drawn["alarms"] == 0


def main(arguments):
    paths = [each for each in arguments if each != "--require"]
    files = [open(path, encoding="utf-8") for path in paths] or [sys.stdin]
    lines = [json.loads(line) for file in files for line in file if line.strip()]
    are_well = []
    for key, show in (("event", show_events), ("turns", show_creep), ("with_evidence", show_hours)):
        chosen = [line for line in lines if key in line]
        if chosen:
            are_well.append(show(chosen))
    drawn = [line for line in lines if "resampled_h" in line]
    if drawn:
        are_well.append(show_tail([line for line in lines if "tails" in line], drawn[-1]))
    if not lines:
        sys.exit("watch_table.py: nothing to read")
    if len(paths) < len(arguments) and not all(are_well):
        sys.exit(1)


if __name__ == "__main__":
    main(sys.argv[1:])
