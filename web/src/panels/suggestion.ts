// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import type { NextPosture } from "../api/types";
import { h } from "../ui/dom";
import { degrees, mm, mrad } from "../ui/format";
import { type Context, sensorPath } from "./context";

/** Asks where the robot should go next; the answer is drawn as a ghost. */
export async function suggestPosture(context: Context): Promise<void> {
  const sensor = context.state.chosen.value;
  const posture = await context.client.get<NextPosture>(`${sensorPath(context)}/next-posture`);
  if (sensor === context.state.chosen.value) context.suggestion.value = posture;
}

/** The suggested posture in numbers, while there is one. */
export function suggestionPanel(context: Context): HTMLElement {
  const panel = h("section", { class: "suggestion", "aria-label": "Suggested posture", hidden: true, "data-test": "suggestion" });
  context.state.chosen.follow(() => (context.suggestion.value = null));
  context.suggestion.follow((posture) => {
    panel.hidden = posture === null;
    if (posture) panel.replaceChildren(...describe(context, posture));
  });
  return panel;
}

function describe(context: Context, posture: NextPosture): HTMLElement[] {
  const joints = posture.joint_names.map((name, index) =>
    h("tr", {}, h("th", { scope: "row" }, name), h("td", {}, degrees(posture.positions_rad[index]))),
  );
  const { sigma_position_m, sigma_rotation_rad } = posture.expected;
  return [
    h("h3", {}, "Move the robot here (drawn in green)"),
    h("p", {}, `Then ${mm(sigma_position_m)} and ${mrad(sigma_rotation_rad)} (1σ) can be expected. It improves ${posture.improves}. Check the way yourself: calibrd does not know what else stands in the cell.`),
    h("table", { class: "numbers" }, h("tbody", {}, ...joints)),
    h("button", { class: "small", click: () => (context.suggestion.value = null) }, "Close"),
  ];
}
