#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""The table of `calibrd-bench moving`, from its JSON lines on stdin."""

import json
import statistics
import sys


def main():
    lines = [json.loads(line) for line in sys.stdin if line.strip()]
    both = [s for s in lines if "mm" in s.get("still", {}) and "mm" in s.get("moving", {})]
    if not both:
        raise SystemExit("no scene was calibrated both ways")
    print(f"scenes {len(lines)}, calibrated both ways {len(both)}, without an offset or a pose {len(lines) - len(both)}")
    offsets = sorted(abs(s["offset_error_ms"]) for s in both)
    print(f"offset error: median {statistics.median(offsets):.2f} ms, largest {offsets[-1]:.2f} ms; over its sigma, rms "
          f"{statistics.mean((s['offset_error_ms'] / s['offset_sigma_ms']) ** 2 for s in both) ** 0.5:.2f}")
    print("| views | accepted | wrong yet accepted | mm, median / 95 % / rms | mrad |\n|---|---|---|---|---|")
    for kind in ("still", "moving", "uncorrected"):
        shown = [s[kind] for s in both if "mm" in s.get(kind, {})]
        if shown:
            accepted = [e for e in shown if e["verdict"] == "accepted"]
            wrong = sum(e["mm"] > 10 or e["mrad"] > 10 for e in accepted)
            print(f"| {kind} | {len(accepted)} of {len(shown)} | {wrong} | {spread(shown, 'mm')} | {spread(shown, 'mrad')} |")
    for unit in ("mm", "mrad"):
        ratio = [rms([s["moving"] for s in both], unit) / rms([s["still"] for s in both], unit),
                 statistics.median(s["moving"][unit] for s in both) / statistics.median(s["still"][unit] for s in both)]
        print(f"moving over still, {unit}: rms {ratio[0]:.2f}, median {ratio[1]:.2f}")


def rms(errors: list[dict], unit: str) -> float:
    return statistics.mean(e[unit] ** 2 for e in errors) ** 0.5


def spread(errors: list[dict], unit: str) -> str:
    values = sorted(e[unit] for e in errors)
    return f"{statistics.median(values):.2f} / {values[int(0.95 * (len(values) - 1))]:.2f} / {rms(errors, unit):.2f}"


if __name__ == "__main__":
    main()
