// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import type { CalibrationResult } from "../api/types";
import type { SensorState } from "../live/state";
import { h, setAttribute, setText } from "../ui/dom";
import { duration, mm, mrad } from "../ui/format";
import { type Context, perform } from "./context";
import { suggestPosture } from "./suggestion";

/** One line of trust for every sensor: may its pose be used, how good is it, why not, what to do. */
export function trustPanel(context: Context): HTMLElement {
  const told = h("p", { class: "unseen", role: "status" });
  const list = h("div", { class: "trust", role: "group", "aria-label": "Sensors" }, told);
  const lines = new Map<string, TrustLine>();
  const refresh = (): void => {
    for (const [id, line] of lines)
      if (!context.state.sensor(id)) {
        line.element.remove();
        lines.delete(id);
      }
    for (const [id, sensor] of context.state.sensors.value) {
      let line = lines.get(id);
      if (!line) {
        line = new TrustLine(context, id);
        lines.set(id, line);
        list.append(line.element);
      }
      line.show(sensor);
    }
    setText(told, [...lines.values()].map((line) => line.inAWord).join(", "));
  };
  context.state.sensors.follow(refresh);
  context.state.chosen.follow(refresh);
  context.state.connection.follow(refresh);
  setInterval(refresh, 500);
  return list;
}

class TrustLine {
  private readonly badge = h("span", { class: "badge", "data-test": "state" });
  private readonly verdict = h("span", { class: "verdict", "data-test": "verdict" });
  private readonly error = h("dd", { "data-test": "error" });
  private readonly age = h("dd", { "data-test": "age" });
  private readonly statistic = h("span", { "data-test": "statistic" });
  private readonly bar = h("div", { class: "bar" });
  private readonly why = h("p", { class: "why", "data-test": "why" });
  private readonly next = h("button", { class: "small", "data-test": "suggest" }, "Where to move the robot");
  private result: CalibrationResult | null = null;
  private resultOf = "";
  private readonly choose: HTMLButtonElement;
  /** For who hears the page: said when it changes, and without ages, which always do. */
  inAWord = "";
  readonly element: HTMLElement;

  constructor(
    private readonly context: Context,
    private readonly id: string,
  ) {
    this.choose = h("button", { class: "name", click: () => (context.state.chosen.value = id) }, id);
    this.next.addEventListener("click", () => {
      context.state.chosen.value = id;
      void perform(context, this.next, () => suggestPosture(context));
    });
    this.element = h(
      "article",
      { class: "sensor", "data-sensor": id },
      h("header", {}, this.choose, this.badge, this.verdict),
      h(
        "dl",
        {},
        h("div", {}, h("dt", {}, "Expected error"), this.error),
        h("div", {}, h("dt", {}, "Calibrated / checked"), this.age),
        h("div", {}, h("dt", {}, "Drift statistic / threshold"), h("dd", {}, this.statistic, h("div", { class: "meter" }, this.bar))),
      ),
      this.why,
      this.next,
    );
  }

  show(sensor: SensorState): void {
    const { pose, drift } = sensor;
    const silentMs = performance.now() - sensor.heardAt;
    const isOld = this.context.state.isOld(this.id);
    const isUsable = pose.valid && !isOld;
    setAttribute(this.element, "data-trust", isOld ? "old" : isUsable ? "valid" : pose.state);
    setAttribute(this.element, "data-chosen", String(this.context.state.chosen.value === this.id));
    setText(this.badge, isOld ? `as of ${duration(silentMs / 1000)} ago` : pose.valid ? "valid" : `not valid · ${pose.state}`);
    setText(this.verdict, drift.watched ? drift.verdict.replaceAll("_", " ") : "not watched");
    this.verdict.title = drift.meaning;
    this.showError(sensor);
    setText(this.age, `${duration(pose.calibrated_age_s)} / ${duration(pose.passed_check_age_s)} ago`);
    setText(this.statistic, drift.watched ? `${drift.statistic.toFixed(1)} / ${drift.threshold.toFixed(0)}` : "–");
    this.bar.style.width = `${Math.min(100, drift.watched ? (100 * drift.statistic) / drift.threshold : 0)}%`;
    this.bar.classList.toggle("over", drift.statistic > drift.threshold);
    setText(this.why, [healthOf(this.context, this.id), why(sensor, isOld)].filter(Boolean).join(" "));
    setAttribute(this.choose, "aria-pressed", String(this.context.state.chosen.value === this.id));
    this.inAWord = `${this.id}: ${isOld ? "what is known is old" : pose.valid ? "valid" : `not valid, ${pose.state}`}`;
  }

  /** At the points of the workspace where there are any, else of the pose itself. */
  private showError(sensor: SensorState): void {
    const { pose } = sensor;
    const known = pose.valid ? pose : pose.last_known;
    if (!known?.calibration) return setText(this.error, "no pose yet");
    if (known.calibration !== this.resultOf) this.fetchResult(known.calibration);
    const points = this.result?.workspace ?? [];
    const sigma = `${mm(known.sigma_position_m)}, ${mrad(known.sigma_rotation_rad)} (1σ)`;
    const worst = points.map((point) => `${point.name} ${mm(point.sigma_m)}`).join(" · ");
    setText(this.error, (pose.valid ? "" : "was ") + (worst ? `${worst} (1σ)` : sigma));
  }

  private fetchResult(calibration: string): void {
    this.resultOf = calibration;
    this.result = null;
    this.context.calibrations.find(calibration).then(
      (found) => (this.result = found.result ?? null),
      () => (this.resultOf = ""),
    );
  }
}

/** What is wrong with the sensor itself, or worth knowing of it. */
function healthOf(context: Context, id: string): string {
  const sensor = context.state.cell.value?.sensors.find((one) => one.id === id);
  if (!sensor || context.state.isOld(id)) return "";
  const health = sensor.health === "streaming" ? "" : `The sensor is ${sensor.health}${sensor.reason ? `: ${sensor.reason}` : ""}.`;
  return [health, sensor.notice ?? ""].filter(Boolean).join(" ");
}

/** In the daemon's own words wherever it has some. */
function why({ pose, drift }: SensorState, isOld: boolean): string {
  if (isOld) return "The daemon is silent: nothing here may be relied on until it answers again.";
  if (!pose.valid) {
    const healing = pose.job
      ? "A calibration is under way."
      : drift.healing_in_s === null ? "" : `It is calibrated again in ${duration(drift.healing_in_s)}.`;
    return [pose.reason ?? "", healing].filter(Boolean).join(". ");
  }
  return drift.watched && drift.verdict !== "in_place" ? drift.meaning : "The last check agreed; nothing to do.";
}
