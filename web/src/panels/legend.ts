// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { h } from "../ui/dom";
import { CLASS_COLOURS, DEPTH_RANGE_M, RESIDUAL_RANGE_M } from "../view/cloud";
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
  return h("div", { class: "scale" }, h("span", {}, from), h("span", { class: `ramp ${colouring}` }), h("span", {}, to), h("small", {}, text));
}

function swatch(colour: string): HTMLElement {
  const element = h("span", { class: "swatch" });
  element.style.backgroundColor = colour;
  return element;
}
