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

/** The newest accepted calibration against the one before it; null where there is none. `history`: newest first. */
export function lastComparison(history: readonly Calibration[]): Comparison | null {
  const found = history.filter((calibration) => calibration.verdict === "accepted" && calibration.result?.T_base_sensor);
  const [after, before] = found.map((calibration) => calibration.result?.T_base_sensor);
  return before && after ? { before, after, meaning: `calibration ${found[1]?.id}` } : null;
}
