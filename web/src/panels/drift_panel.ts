// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import type { Drift } from "../api/types";
import { Chart } from "../ui/chart";
import { h, setAttribute, setText } from "../ui/dom";
import { duration, mm } from "../ui/format";
import type { Context } from "./context";

const OLD = "The daemon is silent: what is shown here is old, and says nothing of now.";

/** What the watch over the pose has seen in the last ten minutes. */
export class DriftPanel {
  private readonly statistic = new Chart({
    title: "Statistic of the test for a moved sensor",
    across: "seconds ago (negative)",
    unit: "no unit",
    lines: [
      { label: "statistic", colour: "#2f6fe0" },
      { label: "threshold", colour: "#d23b3b", dash: [6, 4] },
    ],
  });
  private readonly shift = new Chart({
    title: "Seen shift and turn",
    across: "seconds ago (negative)",
    unit: "mm, mrad",
    lines: [
      { label: "shift, mm", colour: "#c07a1e" },
      { label: "turn, mrad", colour: "#7a5cc0" },
    ],
  });
  private readonly meaning = h("p", { "data-test": "drift-meaning" });
  private readonly healing = h("p", { class: "hint" });
  private readonly events = h("ol", { class: "events", reversed: true, "data-test": "drift-events" });
  readonly element = h("section", {}, this.meaning, this.healing, this.statistic.element, this.shift.element, h("h3", {}, "Changes of the verdict"), this.events);

  constructor(private readonly context: Context) {
    context.state.sensors.follow(() => this.refresh());
    context.state.chosen.follow(() => this.refresh());
    setInterval(() => this.refresh(), 1000); // silence, too, is news
  }

  resize(): void {
    this.refresh(); // nothing was drawn while the tab was hidden
    this.statistic.resize();
    this.shift.resize();
  }

  private refresh(): void {
    const drift = this.context.state.chosenSensor?.drift;
    if (!drift || this.element.hidden) return;
    const isOld = this.context.state.isOld(this.context.state.chosen.value);
    setAttribute(this.element, "data-old", String(isOld));
    const depth = Math.abs(drift.depth_offset_change_m) > 0.001 ? ` The range reads ${mm(drift.depth_offset_change_m, 1)} more than when the pose was found.` : "";
    setText(this.meaning, isOld ? OLD : drift.watched ? drift.meaning + depth : "There is no pose to watch.");
    setText(this.healing, healingText(drift));
    const ages = drift.series.map((sample) => -sample.age_s);
    this.statistic.show(ages, [drift.series.map((sample) => sample.statistic), ages.map(() => drift.threshold)]);
    this.shift.show(ages, [drift.series.map((sample) => 1000 * sample.shift_m), drift.series.map((sample) => 1000 * sample.turn_rad)]);
    const lines = drift.events.slice(-20).reverse().map((event) => h("li", {}, `${event.verdict.replaceAll("_", " ")}, ${duration(event.age_s)} ago`));
    this.events.replaceChildren(...lines);
  }
}

function healingText({ healing, healing_in_s }: Drift): string {
  const mode = {
    automatic: "A sensor that has moved is calibrated again by itself.",
    ask: "A sensor that has moved is calibrated again; the result waits to be accepted.",
    off: "A sensor that has moved is not calibrated again by itself.",
  }[healing];
  return healing_in_s === null ? mode : `${mode} Next attempt in ${duration(healing_in_s)}.`;
}
