// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import type { Matrix4 } from "three";

/** A depth image as points. */
export interface Splats {
  /** Direction (x, y) of each pixel, with z = 1. */
  rays: Float32Array;
  /** In units of `scale`, m. */
  depth: Uint16Array;
  scale: number;
  /** 0: not drawn. */
  shades: Uint8Array;
  matrix: Matrix4;
}

/** A pixel is a shade in its low bits and a depth above them, so that of two the lesser is the nearer. */
export const SHADE_BITS = 11;
export const SHADES = 1 << SHADE_BITS;
export const DEPTH_STEPS = 0xfffff;
/** Nothing was drawn there. Also the farthest. */
export const EMPTY = 0x7fffffff;

/** Where points and surfaces are drawn: rows from below, as WebGL has them. */
export interface SplatPicture {
  width: number;
  height: number;
  pixels: Int32Array;
}

/** Draws points of 2 × 2 pixels, the nearest in front. Returns how many are in the picture. */
export function splat({ width, height, pixels }: SplatPicture, splats: Splats, T_clip_base: Matrix4): number {
  const { rays, depth, scale, shades } = splats;
  const [a0, a1, a2, a3, b0, b1, b2, b3, c0, c1, c2, c3, d0, d1, d2, d3] = T_clip_base.clone().multiply(splats.matrix).elements;
  let drawn = 0;
  for (let pixel = 0; pixel < shades.length; ++pixel) {
    const shade = shades[pixel] as number;
    if (shade === 0) continue;
    const z = (depth[pixel] as number) * scale;
    const x = (rays[2 * pixel] as number) * z;
    const y = (rays[2 * pixel + 1] as number) * z;
    const w = a3 * x + b3 * y + c3 * z + d3;
    if (w <= 0) continue; // behind whoever looks
    const half = 0.5 / w;
    const u = ((a0 * x + b0 * y + c0 * z + d0) * half + 0.5) * width;
    const v = ((a1 * x + b1 * y + c1 * z + d1) * half + 0.5) * height;
    const far = (a2 * x + b2 * y + c2 * z + d2) * half + 0.5;
    if (!(u >= 1 && v >= 1 && u < width && v < height && far >= 0 && far < 1)) continue;
    const value = ((far * DEPTH_STEPS) << SHADE_BITS) | shade;
    const at = (v | 0) * width + (u | 0);
    if (value < (pixels[at] as number)) pixels[at] = value;
    if (value < (pixels[at - 1] as number)) pixels[at - 1] = value;
    if (value < (pixels[at - width] as number)) pixels[at - width] = value;
    if (value < (pixels[at - width - 1] as number)) pixels[at - width - 1] = value;
    drawn += 1;
  }
  return drawn;
}
