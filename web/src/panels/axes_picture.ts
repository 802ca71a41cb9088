// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { svg } from "../ui/dom";

const COLOURS = { x: "#d23b3b", y: "#2a9a4b", z: "#2f6fe0" } as const;
type Axis = keyof typeof COLOURS;

/** Where the axes end in the picture; all begin at (40, 50). */
const ENDS: Record<"base" | "sensor", Record<Axis, [number, number]>> = {
  base: { x: [16, 68], y: [76, 56], z: [40, 12] },
  sensor: { x: [78, 50], y: [40, 88], z: [62, 28] },
};

/** A frame's three axes, with letters: colour is not the only way to tell them apart. */
export function axesPicture(frame: "base" | "sensor"): SVGElement {
  const axes = (Object.keys(COLOURS) as Axis[]).map((axis) => {
    const [x, y] = ENDS[frame][axis];
    const beyond = (from: number, to: number): number => to + 0.18 * (to - from);
    return svg(
      "g",
      { stroke: COLOURS[axis], fill: COLOURS[axis] },
      svg("line", { x1: 40, y1: 50, x2: x, y2: y, "stroke-width": 3 }),
      svg("text", { x: beyond(40, x) - 4, y: beyond(50, y) + 4, stroke: "none", "font-size": 13, "font-weight": 700 }, axis),
    );
  });
  const label = frame === "base" ? "Axes of the base frame: z up" : "Axes of the sensor frame: x right, y down, z forward";
  return svg("svg", { viewBox: "0 0 96 104", width: 96, height: 104, role: "img", "aria-label": label }, ...axes);
}
