// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// The colours of view/cloud.ts for pictures without WebGL, as 256 steps of red, green, blue.

/** The robot's own. */
export const METAL = "#b9c2ca";

export type Ramp = Uint8ClampedArray;

function ramp(colour: (share: number) => [number, number, number]): Ramp {
  const steps = new Uint8ClampedArray(3 * 256);
  for (let step = 0; step < 256; ++step) steps.set(colour(step / 255).map((part) => 255 * part), 3 * step);
  return steps;
}

/** A. Mikhailov's polynomial fit of the Turbo colour map. */
export const TURBO = ramp((t) => {
  const powers = [1, t, t ** 2, t ** 3, t ** 4, t ** 5];
  const sum = (factors: number[]): number => factors.reduce((total, factor, index) => total + factor * (powers[index] ?? 0), 0);
  return [
    sum([0.13572138, 4.6153926, -42.66032258, 132.13108234, -152.94239396, 59.28637943]),
    sum([0.09140261, 2.19418839, 4.84296658, -14.18503333, 4.27729857, 2.82956604]),
    sum([0.1066733, 12.64194608, -60.58204836, 110.36276771, -89.90310912, 27.34824973]),
  ];
});

/** Blue: nearer than predicted; white: as predicted; red: farther. */
export const DIVERGING = ramp((t) => {
  const [end, share] = t < 0.5 ? [[0.13, 0.4, 0.9], 1 - 2 * t] : [[0.87, 0.17, 0.17], 2 * t - 1];
  return (end as number[]).map((part) => 0.95 + (part - 0.95) * (share as number)) as [number, number, number];
});

export function rgbOf(hex: string): [number, number, number] {
  const value = Number.parseInt(hex.slice(1), 16);
  return [value >> 16, (value >> 8) & 255, value & 255];
}
