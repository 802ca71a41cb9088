// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { type Frame, NO_LINK, PIXEL } from "../api/frames";
import { CLASS_COLOURS, DEPTH_RANGE_M, RESIDUAL_RANGE_M } from "./cloud";
import { DIVERGING, type Ramp, rgbOf, TURBO } from "./colours";

type Colour = (pixel: number) => [number, number, number];

const CLASSES = CLASS_COLOURS.map(rgbOf);
const OUTLINE = [255, 255, 255] as const;
const OUTLINE_EDGE = [0, 0, 0] as const;

/** The depth image in the colours asked for, the predicted robot's outline drawn over it: where they part, the pose is wrong. */
export function drawEye(frame: Frame, colouring: "depth" | "residual" | "class", picture: ImageData): void {
  const colour = { depth: byDepth, residual: byResidual, class: byClass }[colouring](frame);
  const { data } = picture;
  for (let pixel = 0; pixel < frame.depth.length; ++pixel) {
    const [r, g, b] = frame.depth[pixel] === 0 ? [12, 14, 16] : colour(pixel);
    data[4 * pixel] = r;
    data[4 * pixel + 1] = g;
    data[4 * pixel + 2] = b;
    data[4 * pixel + 3] = 255;
  }
  drawOutline(frame, data);
}

function step(ramp: Ramp, share: number): [number, number, number] {
  const at = 3 * Math.round(255 * Math.min(1, Math.max(0, share)));
  return [ramp[at] ?? 0, ramp[at + 1] ?? 0, ramp[at + 2] ?? 0];
}

function byDepth(frame: Frame): Colour {
  const [near, far] = DEPTH_RANGE_M;
  return (pixel) => step(TURBO, ((frame.depth[pixel] ?? 0) * frame.depth_scale_m - near) / (far - near));
}

function byResidual(frame: Frame): Colour {
  return (pixel) => {
    const predicted = frame.predicted[pixel] ?? 0;
    if (predicted === 0 || frame.seen[pixel] !== PIXEL.robot) return [52, 58, 64];
    const residual_m = ((frame.depth[pixel] ?? 0) - predicted) * frame.depth_scale_m;
    return step(DIVERGING, 0.5 + residual_m / (2 * RESIDUAL_RANGE_M));
  };
}

function byClass(frame: Frame): Colour {
  return (pixel) => CLASSES[frame.seen[pixel] ?? 0] ?? [0, 0, 0];
}

/** White inside, black outside, so that it is seen on any colour. */
function drawOutline(frame: Frame, data: Uint8ClampedArray): void {
  const { width, height } = frame.camera;
  const isRobot = (x: number, y: number): boolean =>
    x >= 0 && y >= 0 && x < width && y < height && frame.link[y * width + x] !== NO_LINK;
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) {
      const inside = isRobot(x, y);
      const around = [isRobot(x + 1, y), isRobot(x - 1, y), isRobot(x, y + 1), isRobot(x, y - 1)];
      if (around.every((is) => is === inside)) continue;
      data.set(inside ? OUTLINE : OUTLINE_EDGE, 4 * (y * width + x));
    }
}
