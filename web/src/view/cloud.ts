// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { Matrix4 } from "three";
import { type Frame, PIXEL } from "../api/frames";
import { raysOf } from "./rays";
import { type Splats } from "./splat";

/** What the points of a cloud are and how they are coloured. */
export type Look = "depth" | "residual" | "class" | "virtual" | "robot";

/** Residuals are shown from minus to plus this. */
export const RESIDUAL_RANGE_M = 0.02;
export const DEPTH_RANGE_M: [number, number] = [0.5, 4];

/** Colours of the classes, in the order of PIXEL; told apart with any colour vision. */
export const CLASS_COLOURS = ["#000000", "#7d8790", "#2f8fe0", "#a58a63", "#e2336b"] as const;

/** Shades are places in a palette; 0: the pixel is not drawn. Those of points fit a byte; from `solids` on they are of surfaces. */
export const SHADE = { none: 0, ramp: 1, rampLast: 240, classes: 241, virtual: 250, robot: 251, solids: 256 } as const;

/** One look at the pixels of a sensor, as points: its matrix is T_base_sensor. */
export class Cloud {
  readonly matrix = new Matrix4();
  visible = false;
  private frame: Frame | null = null;
  private shades = new Uint8Array();
  private isShaded = false;

  constructor(private shown: Look) {}

  get look(): Look {
    return this.shown;
  }

  set look(look: Look) {
    this.shown = look;
    this.isShaded = false;
  }

  take(frame: Frame): void {
    this.frame = frame;
    this.isShaded = false;
  }

  /** What is to be drawn; null: nothing. Pixels are shaded once for each frame, and only when somebody looks. */
  get splats(): Splats | null {
    const { frame } = this;
    if (!frame || !this.visible) return null;
    if (!this.isShaded) this.shade(frame);
    const depth = this.shown === "virtual" ? frame.predicted : frame.depth;
    return { rays: raysOf(frame.camera), depth, scale: frame.depth_scale_m, shades: this.shades, matrix: this.matrix };
  }

  private shade(frame: Frame): void {
    const count = frame.depth.length;
    if (this.shades.length !== count) this.shades = new Uint8Array(count);
    const shade = { depth: byDepth, residual: byResidual, class: byClass, virtual: asVirtual, robot: asRobot }[this.shown](frame);
    for (let pixel = 0; pixel < count; ++pixel) this.shades[pixel] = shade(pixel);
    this.isShaded = true;
  }
}

type Shading = (frame: Frame) => (pixel: number) => number;

function onRamp(share: number): number {
  return SHADE.ramp + Math.round(Math.min(1, Math.max(0, share)) * (SHADE.rampLast - SHADE.ramp));
}

function isRobot(frame: Frame, pixel: number): boolean {
  return frame.depth[pixel] !== 0 && frame.predicted[pixel] !== 0 && frame.seen[pixel] === PIXEL.robot;
}

const byDepth: Shading = (frame) => {
  const [near, far] = DEPTH_RANGE_M;
  return (pixel) => {
    const raw = frame.depth[pixel] ?? 0;
    return raw === 0 ? SHADE.none : onRamp((raw * frame.depth_scale_m - near) / (far - near));
  };
};

const byResidual: Shading = (frame) => (pixel) => {
  if (!isRobot(frame, pixel)) return SHADE.none;
  const residual_m = ((frame.depth[pixel] ?? 0) - (frame.predicted[pixel] ?? 0)) * frame.depth_scale_m;
  return onRamp(0.5 + residual_m / (2 * RESIDUAL_RANGE_M));
};

const byClass: Shading = (frame) => (pixel) => (frame.depth[pixel] === 0 ? SHADE.none : SHADE.classes + (frame.seen[pixel] ?? 0));
const asVirtual: Shading = (frame) => (pixel) => (frame.predicted[pixel] === 0 ? SHADE.none : SHADE.virtual);
const asRobot: Shading = (frame) => (pixel) => (isRobot(frame, pixel) ? SHADE.robot : SHADE.none);
