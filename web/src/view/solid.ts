// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { Matrix4, Vector3 } from "three";
import { LIGHT } from "./light";
import { DEPTH_STEPS, SHADE_BITS, type SplatPicture } from "./splat";

/** Shades of a solid, from the dark side to full light. */
export const LIGHT_LEVELS = 40;

/** Surfaces are drawn so much deeper than they are: else of the points that lie on them noise would hide one in two. */
export const BEHIND_M = 0.01;

/** The surface of a link, in its frame. */
export interface Solid {
  /** Nine numbers for each triangle, counter-clockwise seen from outside. */
  corners: Float32Array;
  /** Three numbers for each triangle. */
  normals: Float32Array;
  /** The darkest of LIGHT_LEVELS. */
  firstShade: number;
  T_base_link: Matrix4;
}

/** From the corners, not from a file that may have them wrong: who is seen and who is lit then agree. */
export function normalsOf(corners: Float32Array): Float32Array {
  const normals = new Float32Array(corners.length / 3);
  const [a, b, c] = [new Vector3(), new Vector3(), new Vector3()];
  for (let at = 0; at < corners.length; at += 9) {
    a.fromArray(corners, at);
    b.fromArray(corners, at + 3).sub(a);
    c.fromArray(corners, at + 6).sub(a);
    b.cross(c).normalize().toArray(normals, at / 3);
  }
  return normals;
}

/** A corner in the picture: pixels from the left and from below, and depth in steps. */
type Corner = Float64Array;
const [p, q, r]: [Corner, Corner, Corner] = [new Float64Array(3), new Float64Array(3), new Float64Array(3)];

/** Draws what faces `eye` (base frame), the nearest in front. */
export function drawSolid(picture: SplatPicture, { corners, normals, firstShade, T_base_link }: Solid, T_clip_base: Matrix4, eye: Vector3): void {
  const T_link_base = T_base_link.clone().invert();
  const from = eye.clone().applyMatrix4(T_link_base);
  const sun = LIGHT.towardsSun.clone().transformDirection(T_link_base);
  const place = projection(T_clip_base.clone().multiply(T_base_link), picture);
  for (let at = 0; at < normals.length; at += 3) {
    const x = normals[at] as number;
    const y = normals[at + 1] as number;
    const z = normals[at + 2] as number;
    const corner = 3 * at;
    const towards = x * (from.x - (corners[corner] as number)) + y * (from.y - (corners[corner + 1] as number)) + z * (from.z - (corners[corner + 2] as number));
    if (!(towards > 0)) continue;
    if (!place(corners, corner, p) || !place(corners, corner + 3, q) || !place(corners, corner + 6, r)) continue;
    const cosine = x * sun.x + y * sun.y + z * sun.z;
    fill(picture, firstShade + (cosine > 0 ? Math.round(cosine * (LIGHT_LEVELS - 1)) : 0));
  }
}

type Projection = (corners: Float32Array, at: number, into: Corner) => boolean;

/** False: behind whoever looks, or nearer or farther than the picture reaches. */
function projection(T_clip_link: Matrix4, { width, height }: SplatPicture): Projection {
  const [a0, a1, a2, a3, b0, b1, b2, b3, c0, c1, c2, c3, d0, d1, d2, d3] = T_clip_link.elements;
  return (corners, at, into) => {
    const x = corners[at] as number;
    const y = corners[at + 1] as number;
    const z = corners[at + 2] as number;
    const w = a3 * x + b3 * y + c3 * z + d3;
    const half = 0.5 / w;
    const far = (0.5 * (a2 * x + b2 * y + c2 * z + d2 + BEHIND_M)) / (w + BEHIND_M) + 0.5; // of a camera that looks along w
    into[0] = ((a0 * x + b0 * y + c0 * z + d0) * half + 0.5) * width;
    into[1] = ((a1 * x + b1 * y + c1 * z + d1) * half + 0.5) * height;
    into[2] = far * DEPTH_STEPS;
    return w > 0 && far >= 0 && far < 1;
  };
}

/** The pixels whose centres lie in the triangle p, q, r. Inside, shares of the area tell the depth, which in a picture is linear. */
function fill({ width, height, pixels }: SplatPicture, shade: number): void {
  const x0 = p[0] as number;
  const y0 = p[1] as number;
  const z0 = p[2] as number;
  const qx = (q[0] as number) - x0;
  const qy = (q[1] as number) - y0;
  const rx = (r[0] as number) - x0;
  const ry = (r[1] as number) - y0;
  const area = qx * ry - rx * qy;
  if (!(area > 0)) return;
  const left = Math.max(0, Math.ceil(Math.min(0, qx, rx) + x0 - 0.5));
  const right = Math.min(width - 1, Math.floor(Math.max(0, qx, rx) + x0 - 0.5));
  const bottom = Math.max(0, Math.ceil(Math.min(0, qy, ry) + y0 - 0.5));
  const top = Math.min(height - 1, Math.floor(Math.max(0, qy, ry) + y0 - 0.5));
  if (left > right || bottom > top) return; // between the pixels' centres, as most of what is small
  const perQ = ((q[2] as number) - z0) / area;
  const perR = ((r[2] as number) - z0) / area;
  // At the centre of the first pixel, and from there step by step.
  const x = left + 0.5 - x0;
  const y = bottom + 0.5 - y0;
  let rowQ = x * ry - rx * y;
  let rowR = qx * y - x * qy;
  for (let row = bottom; row <= top; ++row, rowQ -= rx, rowR += qx) {
    let ofQ = rowQ;
    let ofR = rowR;
    let isInside = false;
    for (let at = row * width + left, end = row * width + right; at <= end; ++at, ofQ += ry, ofR -= qy) {
      if (ofQ < 0 || ofR < 0 || ofQ + ofR > area) {
        if (isInside) break;
        continue;
      }
      isInside = true;
      const value = ((z0 + ofQ * perQ + ofR * perR) << SHADE_BITS) | shade;
      if (value < (pixels[at] as number)) pixels[at] = value;
    }
  }
}
