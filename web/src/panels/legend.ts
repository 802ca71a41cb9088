// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { h } from "../ui/dom";
import { CLASS_COLOURS, DEPTH_RANGE_M, RESIDUAL_RANGE_M } from "../view/cloud";
import type { HeatKind } from "./heat";
import type { Colouring } from "./view_panel";

const CLASSES = ["", "not known", "robot", "background", "unexpected"];

/** What the colours of the points mean. */
export function legend(colouring: Colouring): HTMLElement {
  if (colouring === "class")
    return h("ul", { class: "classes" }, ...CLASSES.map((name, index) => (name ? h("li", {}, swatch(CLASS_COLOURS[index] ?? ""), name) : null)));
  const range = RESIDUAL_RANGE_M * 1000;
  const [from, to, text] =
    colouring === "depth"
      ? [`${DEPTH_RANGE_M[0]} m`, `${DEPTH_RANGE_M[1]} m`, "depth along the optical axis"]
      : [`−${range} mm`, `+${range} mm`, "measured − predicted depth, on the robot"];
  return scale(from, colouring, to, text);
}

/** What the colours of the robot's links mean. */
export function heatLegend(kind: HeatKind): HTMLElement {
  const range = RESIDUAL_RANGE_M * 500;
  if (kind === "coverage") return scale("0 %", kind, "100 %", "of a link seen where it was predicted");
  return scale(`−${range} mm`, kind, `+${range} mm`, "measured − predicted depth, median of a link");
}

function scale(from: string, ramp: string, to: string, text: string): HTMLElement {
  return h("div", { class: "scale" }, h("span", {}, from), h("span", { class: `ramp ${ramp}` }), h("span", {}, to), h("small", {}, text));
}

function swatch(colour: string): HTMLElement {
  const element = h("span", { class: "swatch" });
  element.style.backgroundColor = colour;
  return element;
}
