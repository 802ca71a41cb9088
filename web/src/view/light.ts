// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { Color, Vector3 } from "three";

/** The light of the scene, for whoever draws: WebGL or the processor. */
export const LIGHT = { ambient: 1.3, sun: 2.2, towardsSun: new Vector3(2, -3, 5).normalize() } as const;

/** What a dull surface of this colour looks like, `cosine` being that of its normal to the sun: as three.js lights it, sRGB of 0 to 255. */
export function lit(colour: string, cosine: number): [number, number, number] {
  const light = (LIGHT.ambient + LIGHT.sun * Math.max(0, cosine)) / Math.PI;
  const { r, g, b } = new Color(colour).multiplyScalar(light).convertLinearToSRGB();
  return [r, g, b].map((part) => Math.round(255 * Math.min(1, part))) as [number, number, number];
}
