// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import type { Camera } from "../api/types";

let known: { key: string; rays: Float32Array } = { key: "", rays: new Float32Array() };

/** The same array for the same camera: it takes longer to make than a frame takes to come. */
export function raysOf(camera: Camera): Float32Array {
  const key = JSON.stringify(camera);
  if (key !== known.key) known = { key, rays: pixelRays(camera) };
  return known.rays;
}

/** Direction (x, y), with z = 1, that each pixel sees along, distortion undone. Sensor frame: x right, y down. */
function pixelRays(camera: Camera): Float32Array {
  const rays = new Float32Array(2 * camera.width * camera.height);
  let at = 0;
  for (let v = 0; v < camera.height; ++v)
    for (let u = 0; u < camera.width; ++u) {
      const [x, y] = undistort((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, camera.distortion);
      rays[at++] = x;
      rays[at++] = y;
    }
  return rays;
}

/** Fixed-point iteration on OpenCV's model (k1, k2, p1, p2, k3), as cv::undistortPoints does it. */
function undistort(xd: number, yd: number, [k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0]: number[]): [number, number] {
  let x = xd;
  let y = yd;
  for (let step = 0; step < 12; ++step) {
    const r2 = x * x + y * y;
    const radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    const dx = 2 * p1 * x * y + p2 * (r2 + 2 * x * x);
    const dy = p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
    x = (xd - dx) / radial;
    y = (yd - dy) / radial;
  }
  return [x, y];
}
