// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Numbers for people: always with their unit, never with more digits than mean something.

export const NOT_KNOWN = "–";

export function mm(metres: number | null | undefined, digits = 2): string {
  return fixed(metres, 1e3, digits, "mm");
}

export function mrad(radians: number | null | undefined, digits = 2): string {
  return fixed(radians, 1e3, digits, "mrad");
}

export function degrees(radians: number | null | undefined, digits = 1): string {
  return fixed(radians, 180 / Math.PI, digits, "°", "");
}

export function percent(share: number | null | undefined, digits = 0): string {
  return fixed(share, 100, digits, "%");
}

function fixed(value: number | null | undefined, factor: number, digits: number, unit: string, gap = "\u202f"): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return NOT_KNOWN;
  return `${(value * factor).toFixed(digits)}${gap}${unit}`;
}

/** "3 s", "5 min", "2 h", "4 d". */
export function duration(seconds: number | null | undefined): string {
  if (seconds === null || seconds === undefined || !Number.isFinite(seconds)) return NOT_KNOWN;
  if (seconds < 10) return `${seconds.toFixed(1)}\u202fs`;
  if (seconds < 120) return `${Math.round(seconds)}\u202fs`;
  if (seconds < 7200) return `${Math.round(seconds / 60)}\u202fmin`;
  if (seconds < 172800) return `${Math.round(seconds / 3600)}\u202fh`;
  return `${Math.round(seconds / 86400)}\u202fd`;
}

/** RFC 3339 as the day and time of whoever looks. */
export function when(time: string | null | undefined): string {
  if (!time) return NOT_KNOWN;
  return new Date(time).toLocaleString(undefined, { dateStyle: "medium", timeStyle: "medium" });
}
