// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { type Frame, NO_LINK, PIXEL } from "../api/frames";
import type { CalibrationResult } from "../api/types";
import { RESIDUAL_RANGE_M } from "../view/cloud";
import { DIVERGING, type Ramp } from "../view/colours";
import type { Context } from "./context";

export type HeatKind = "coverage" | "residual";

/** What the robot's links are painted by, and the colours of those that are named. */
export interface Heat {
  kind: HeatKind;
  colours: ReadonlyMap<string, string>;
}

/** Fewer pixels than these say nothing of a link. */
const LEAST_PIXELS = 20;

/** Coverage as the calibration found it, residual as the newest frame shows it. */
export function heatOf(context: Context, kind: HeatKind, result: CalibrationResult | null): Heat {
  const colours = new Map<string, string>();
  if (kind === "coverage") for (const { link, coverage } of result?.links ?? []) colours.set(link, colourOf(DIVERGING, 1 - coverage));
  const frame = context.frames.frame.value;
  if (kind === "residual" && frame)
    for (const [link, residual_m] of residuals(frame)) colours.set(link, colourOf(DIVERGING, 0.5 + residual_m / RESIDUAL_RANGE_M));
  return { kind, colours };
}

/** Median of measured minus predicted depth for every link that is seen, m. */
export function residuals(frame: Frame): Map<string, number> {
  const values = new Map<number, number[]>();
  frame.link.forEach((link, pixel) => {
    if (link === NO_LINK || frame.seen[pixel] !== PIXEL.robot) return;
    const list = values.get(link) ?? [];
    list.push((frame.depth[pixel] ?? 0) - (frame.predicted[pixel] ?? 0));
    values.set(link, list);
  });
  const medians = new Map<string, number>();
  for (const [link, list] of values) {
    if (list.length < LEAST_PIXELS) continue;
    list.sort((a, b) => a - b);
    medians.set(frame.links[link] ?? "", (list[list.length >> 1] ?? 0) * frame.depth_scale_m);
  }
  return medians;
}

function colourOf(ramp: Ramp, share: number): string {
  const at = 3 * Math.round(255 * Math.min(1, Math.max(0, share)));
  return `rgb(${ramp[at]}, ${ramp[at + 1]}, ${ramp[at + 2]})`;
}
