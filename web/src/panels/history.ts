// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { explain } from "../api/client";
import type { Calibration, CalibrationDiff } from "../api/types";
import { h, keepingFocus } from "../ui/dom";
import { mm, mrad, percent, when } from "../ui/format";
import { oneAtATime } from "../ui/one_at_a_time";
import { activate } from "./actions";
import { type Context, perform } from "./context";
import { ErrorCharts } from "./error_charts";
import { type Heat, type HeatKind, heatOf } from "./heat";

/** So many at first, and so many more each time that older ones are asked for. */
const SHOWN = 20;
const REPAINT_MS = 500;

/** Every calibration of the chosen sensor, newest first: how it went, how it differs, back to it. */
export class HistoryPanel {
  private readonly rows = h("tbody", { "data-test": "history" });
  private readonly diff = h("div", { class: "diff", "data-test": "diff" });
  private readonly charts = new ErrorCharts();
  private readonly compared: string[] = [];
  /** Of which button the robot has its colours. */
  private painted = "";
  private repaintedAt = 0;
  private shown = SHOWN;
  private readonly older = h("button", { class: "small", hidden: true, "data-test": "older" }, "Older ones");
  private readonly refresh = oneAtATime(() => this.fetch());
  readonly element: HTMLElement;

  constructor(private readonly context: Context) {
    const columns = ["Calibration", "σ of the pose", "Residual, coverage"];
    const head = h("thead", {}, h("tr", {}, h("th", { scope: "col" }, h("span", { class: "unseen" }, "compare")), ...columns.map((title) => h("th", { scope: "col" }, title))));
    this.element = h(
      "section",
      {},
      h("p", { class: "hint" }, "Tick two to compare them."),
      h("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Calibrations" }, h("table", { class: "history" }, head, this.rows)),
      this.older,
      this.diff,
      this.charts.element,
    );
    const { state } = context;
    state.chosen.follow(() => this.forget());
    this.older.addEventListener("click", () => {
      this.shown += SHOWN;
      void perform(context, this.older, () => this.refresh());
    });
    context.frames.frame.follow(() => this.repaint());
    for (const signal of [state.historyVersion, state.chosen, state.connection, state.session]) signal.follow(() => void this.refresh());
  }

  resize(): void {
    this.charts.resize();
  }

  private async fetch(): Promise<void> {
    const { state, calibrations, notices } = this.context;
    if (!state.isLive || !state.chosen.value) return;
    const sensor = state.chosen.value;
    try {
      const [shown, servedId] = [this.shown, state.chosenSensor?.pose.calibration ?? state.chosenSensor?.pose.last_known?.calibration];
      const found = await calibrations.history(sensor, shown + 1);
      const history = found.slice(0, shown);
      const served = found.find(({ current }) => current) ?? (servedId ? await calibrations.find(servedId) : null); // which may be older than what is shown
      if (sensor !== state.chosen.value) return; // another one is looked at by now
      this.older.hidden = found.length <= shown;
      keepingFocus(this.rows, () => this.rows.replaceChildren(...history.map((calibration) => this.row(calibration))));
      this.charts.show(history, served?.result?.T_base_sensor);
    } catch (failure) {
      if (state.isLive) notices.tell(explain(failure), true);
    }
  }

  /** What is there is of another sensor. */
  private forget(): void {
    this.paint("", null);
    this.compared.length = 0;
    this.rows.replaceChildren();
    this.diff.replaceChildren();
    this.charts.show([], undefined);
    this.shown = SHOWN;
  }

  private row(calibration: Calibration): HTMLElement {
    const { id, result } = calibration;
    const choose = h("input", { type: "checkbox", "data-test": "compare-row", "aria-label": `Compare ${id}`, checked: this.compared.includes(id), disabled: !result?.T_base_sensor });
    choose.addEventListener("change", () => void this.choose(id, choose));
    const why = [calibration.message ?? "", ...(result?.reasons ?? []).map((reason) => reason.text)].filter(Boolean).join(" ");
    return h(
      "tr",
      { "data-id": id, "data-current": String(calibration.current) },
      h("td", {}, choose),
      h(
        "td",
        {},
        h("div", {}, when(calibration.created_at)),
        h("small", {}, id),
        h("div", { class: `verdict ${calibration.verdict ?? ""}` }, calibration.verdict ?? calibration.status, calibration.current ? h("strong", {}, " · served") : null),
        calibration.finished_at && calibration.verdict !== "accepted" && why ? h("p", { class: "reasons", "data-test": "reasons" }, why) : null,
        ...this.buttons(calibration),
      ),
      h("td", {}, h("div", {}, mm(result?.sigma_position_m)), h("div", {}, mrad(result?.sigma_rotation_rad))),
      h("td", {}, h("div", {}, mm(result?.residual_rms_m)), h("div", {}, percent(result?.coverage))),
    );
  }

  private buttons(calibration: Calibration): HTMLElement[] {
    const { result } = calibration;
    const heat = (kind: HeatKind): HTMLElement => this.heatButton(calibration, kind);
    const buttons = result?.links?.length ? [heat("coverage"), heat("residual")] : [];
    if (calibration.verdict === "accepted" && !calibration.current && this.context.state.may("calibrate")) {
      const back: HTMLButtonElement = h("button", { class: "small", "data-test": "rollback", click: () => void perform(this.context, back, () => activate(this.context, calibration.id)) }, "Serve…");
      buttons.push(back);
    }
    return buttons;
  }

  /** Paints the robot's links, and takes the paint off again. */
  private heatButton({ id, result }: Calibration, kind: HeatKind): HTMLElement {
    const name = `${kind} ${id}`;
    const press = (): void => {
      if (this.painted === name) this.paint("", null);
      else this.paint(name, heatOf(this.context, kind, result ?? null));
    };
    return h("button", { class: "small", "data-test": `heat-${kind}`, "data-paint": name, "aria-pressed": String(this.painted === name), click: press }, kind);
  }

  private paint(name: string, heat: Heat | null): void {
    this.painted = name;
    this.context.heat.value = heat;
    for (const button of this.rows.querySelectorAll<HTMLElement>("[data-paint]"))
      button.setAttribute("aria-pressed", String(button.dataset["paint"] === name));
  }

  /** Residuals are those of the newest frame, not of the one there was when the button was pressed. */
  private repaint(): void {
    const now = performance.now();
    if (this.context.heat.value?.kind !== "residual" || now - this.repaintedAt < REPAINT_MS) return;
    this.repaintedAt = now;
    this.context.heat.value = heatOf(this.context, "residual", null);
  }

  /** The two that were ticked last. */
  private async choose(id: string, box: HTMLInputElement): Promise<void> {
    const at = this.compared.indexOf(id);
    if (at >= 0) this.compared.splice(at, 1);
    if (box.checked) this.compared.push(id);
    while (this.compared.length > 2) this.untick(this.compared.shift() ?? "");
    const [first, second] = this.compared;
    if (!first || !second) return this.diff.replaceChildren();
    await perform(this.context, null, async () => {
      const diff = await this.context.client.get<CalibrationDiff>(`/api/v1/calibrations/${first}/diff/${second}`);
      if (this.compared[0] === first && this.compared[1] === second) this.diff.replaceChildren(...describe(diff));
    });
  }

  private untick(id: string): void {
    const box = this.rows.querySelector<HTMLInputElement>(`tr[data-id="${id}"] input`);
    if (box) box.checked = false;
  }
}

function describe(diff: CalibrationDiff): HTMLElement[] {
  const numbers = (values: number[]): string => values.map((value) => value.toFixed(2)).join(", ");
  const points = diff.workspace.map((point) => h("li", {}, `${point.name}: ${point.distance_mm.toFixed(2)} mm (${numbers(point.displacement_mm)})`));
  return [
    h("h3", {}, `From ${diff.a} to ${diff.b}`),
    h("p", {}, `Position ${diff.distance_mm.toFixed(2)} mm (x, y, z: ${numbers(diff.translation_mm)}), rotation ${diff.angle_mrad.toFixed(2)} mrad (about x, y, z: ${numbers(diff.rotation_mrad)}), axes of the base frame.`),
    ...(points.length ? [h("p", {}, "What that means where the robot works:"), h("ul", {}, ...points)] : []),
  ];
}
