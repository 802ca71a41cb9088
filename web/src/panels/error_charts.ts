// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { Matrix4, Quaternion } from "three";
import type { Calibration, CalibrationResult, Matrix4 as Rows } from "../api/types";
import { Chart, type Line } from "../ui/chart";
import { h } from "../ui/dom";
import { matrixOf } from "../view/matrix";

const AXES: Line[] = [
  { label: "x", colour: "#d23b3b", isPoints: true },
  { label: "y", colour: "#2a9a4b", isPoints: true },
  { label: "z", colour: "#2f6fe0", isPoints: true },
];

/** Of every calibration: how far it is from the one being served, along each axis and about each axis of the base frame, as in
 * figures 8 and 9 of the paper; and what is left of the residual. */
export class ErrorCharts {
  private readonly position = new Chart({ title: "Position against the pose being served", across: "calibration, oldest first", unit: "mm", lines: AXES, isCounted: true });
  private readonly rotation = new Chart({ title: "Rotation against the pose being served", across: "calibration, oldest first", unit: "mrad", lines: AXES, isCounted: true });
  private readonly residual = new Chart({
    title: "Residual and claimed σ of the position",
    across: "calibration, oldest first",
    unit: "mm",
    lines: [
      { label: "residual (rms)", colour: "#7a5cc0", isPoints: true },
      { label: "σ position", colour: "#c07a1e", isPoints: true },
    ],
    isCounted: true,
  });
  readonly element = h("div", { class: "charts" }, this.position.element, this.rotation.element, this.residual.element);

  /** Newest first; `reference` is the pose being served, T_base_sensor. */
  show(history: readonly Calibration[], reference: Rows | undefined): void {
    const found = history.filter((calibration) => calibration.result?.T_base_sensor).reverse();
    const numbers = found.map((_, index) => index + 1);
    const results = found.map((calibration) => calibration.result as CalibrationResult);
    const shifts = results.map((result) => (reference && result.T_base_sensor ? difference(reference, result.T_base_sensor) : null));
    const axis = (kind: "shift_mm" | "turn_mrad", at: number): (number | null)[] => shifts.map((shift) => shift?.[kind][at] ?? null);
    this.position.show(numbers, [0, 1, 2].map((at) => axis("shift_mm", at)));
    this.rotation.show(numbers, [0, 1, 2].map((at) => axis("turn_mrad", at)));
    this.residual.show(numbers, [
      results.map((result) => milli(result.residual_rms_m)),
      results.map((result) => milli(result.sigma_position_m)),
    ]);
  }

  resize(): void {
    for (const chart of [this.position, this.rotation, this.residual]) chart.resize();
  }
}

function milli(value: number | null): number | null {
  return value === null ? null : value * 1000;
}

/** From a to b in axes of the base frame: shift (mm) and rotation vector (mrad). */
function difference(a: Rows, b: Rows): { shift_mm: number[]; turn_mrad: number[] } {
  const shift_mm = [0, 1, 2].map((row) => 1000 * ((b[row]?.[3] ?? 0) - (a[row]?.[3] ?? 0)));
  const rotation = (rows: Rows): Quaternion => new Quaternion().setFromRotationMatrix(new Matrix4().extractRotation(matrixOf(rows)));
  const turn = rotation(b).multiply(rotation(a).invert());
  const sine = Math.hypot(turn.x, turn.y, turn.z);
  const angle = 2 * Math.atan2(sine, Math.abs(turn.w)) * Math.sign(turn.w || 1);
  const turn_mrad = [turn.x, turn.y, turn.z].map((part) => (sine > 0 ? (1000 * angle * part) / sine : 0));
  return { shift_mm, turn_mrad };
}
