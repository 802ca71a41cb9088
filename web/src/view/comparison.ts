// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import type { Calibration, Matrix4 } from "../api/types";

/** A pose before and after a calibration. */
export interface Comparison {
  before: Matrix4;
  after: Matrix4;
  /** What `before` is. */
  meaning: string;
}

/**
 * The newest accepted calibration against the one before it; of the first one against the best other place the search
 * from nothing had in mind. `history`: newest first.
 */
export function lastComparison(history: readonly Calibration[]): Comparison | null {
  const found = history.filter((calibration) => calibration.verdict === "accepted" && calibration.result?.T_base_sensor);
  const [newest, former] = found;
  const after = newest?.result?.T_base_sensor;
  if (!newest || !after) return null;
  if (former?.result?.T_base_sensor) return { before: former.result.T_base_sensor, after, meaning: `calibration ${former.id}` };
  const start = newest.result?.hypotheses?.[0]?.T_base_sensor;
  return start ? { before: start, after, meaning: "where the search from nothing began" } : null;
}
