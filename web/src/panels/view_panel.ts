// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { h, setText } from "../ui/dom";
import { duration } from "../ui/format";
import { type Comparison, lastComparison } from "../view/comparison";
import { CellView, withoutView } from "./cell_view";
import type { Context } from "./context";
import { Eye } from "./eye";
import { heatLegend, legend } from "./legend";

export type Colouring = "depth" | "residual" | "class";

/** The large picture, in three dimensions or by the sensor's eye, and what is shown in it. */
export function viewPanel(context: Context): HTMLElement {
  const canvas = h("canvas", { class: "cell", "aria-label": "The cell in three dimensions. Arrow keys move it, with shift they turn it, plus and minus go nearer and away.", role: "img", tabindex: 0, "data-test": "cell" });
  const eye = new Eye(context);
  const status = h("p", { class: "frame-status", role: "status", "data-test": "frame-status" });
  const legendPlace = h("div", { class: "legend" });
  const stage = h("div", { class: "stage" }, canvas, eye.element, legendPlace, status);
  const controls = h("div", { class: "toolbar", role: "toolbar", "aria-label": "View" });
  const panel = h("section", { class: "view", "aria-label": "Cell view" }, controls, stage);
  // The stage has its size only once the page is laid out.
  requestAnimationFrame(() => {
    const view = makeView(context, canvas);
    canvas.addEventListener("webglcontextlost", () => context.notices.tell("The browser has taken the 3D view its memory: it is drawn again when that is given back, or when the page is loaded again.", true));
    controls.append(...viewControls(context, view, eye, stage, legendPlace));
    if (view) controls.append(comparisonControls(context, view));
  });
  const refresh = (): void => showFrameStatus(context, status);
  for (const signal of [context.frames.frame, context.frames.absence, context.state.connection]) signal.follow(refresh);
  setInterval(refresh, 500);
  return panel;
}

function makeView(context: Context, canvas: HTMLCanvasElement): CellView | null {
  try {
    const view = new CellView(context, canvas);
    Object.defineProperty(canvas, "drawn", { get: () => view.drawn });
    return view;
  } catch (failure) {
    canvas.replaceWith(withoutView(failure));
    return null;
  }
}

function viewControls(context: Context, view: CellView | null, eye: Eye, stage: HTMLElement, legendPlace: HTMLElement): HTMLElement[] {
  const isByEye = (): boolean => stage.classList.contains("by-eye");
  const choose = (byEye: boolean): void => {
    stage.classList.toggle("by-eye", byEye);
    eye.isShown = byEye;
    space.setAttribute("aria-pressed", String(!byEye));
    look.setAttribute("aria-pressed", String(byEye));
  };
  const space = h("button", { click: () => choose(false), disabled: !view, "data-test": "by-space" }, "3D");
  const look = h("button", { click: () => choose(true), "data-test": "by-eye" }, "Sensor's eye");
  const colouring = h("select", { "aria-label": "Colour of the points", "data-test": "colouring" }, ...(["depth", "residual", "class"] as const).map((name) => h("option", { value: name }, `by ${name}`)));
  const recolour = (): void => {
    const name = colouring.value as Colouring;
    if (view) view.look = name;
    eye.colouring = name;
    showLegend();
  };
  const showLegend = (): void => {
    const heat = context.heat.value;
    legendPlace.replaceChildren(legend(colouring.value as Colouring), ...(heat ? [heatLegend(heat.kind)] : []));
  };
  context.heat.follow(showLegend);
  colouring.addEventListener("change", recolour);
  const controls = [h("span", { class: "group" }, space, look), colouring, densityControl(context)];
  if (view) {
    const box = (name: "measured" | "predicted", title: string, isOn: boolean): HTMLElement => {
      const self = h("input", { type: "checkbox", checked: isOn, id: `show-${name}` });
      const apply = (): void => view.show(name, self.checked && !!context.frames.frame.value?.T_base_sensor);
      self.addEventListener("change", apply);
      context.frames.frame.follow(apply);
      return h("label", { class: "check", for: `show-${name}` }, self, title);
    };
    const from = (title: string, action: () => void): HTMLElement => h("button", { class: "small", click: action }, title);
    controls.push(
      box("measured", "measured", true),
      box("predicted", "virtual", false),
      h("span", { class: "group" }, from("Fit", () => view.fit()), from("Front", () => view.lookFrom("front")), from("Side", () => view.lookFrom("side")), from("Top", () => view.lookFrom("top")), from("From the sensor", () => view.lookFromSensor())),
    );
  }
  recolour();
  choose(!view || isByEye());
  return controls;
}

/** How many of the sensor's pixels are fetched and drawn. */
function densityControl(context: Context): HTMLElement {
  const steps = { 1: "every pixel", 2: "every 2nd pixel", 4: "every 4th pixel" };
  const density = h("select", { "aria-label": "Density of the points", "data-test": "density" }, ...Object.entries(steps).map(([step, title]) => h("option", { value: step, selected: step === "2" }, title)));
  density.addEventListener("change", () => context.frames.configure({ step: Number(density.value), rate_hz: 10 }));
  return density;
}

/** The slider between before (orange) and after (green). */
function comparisonControls(context: Context, view: CellView): HTMLElement {
  const slider = h("input", { type: "range", min: 0, max: 1, step: 0.01, value: 1, "aria-label": "Before to after the last calibration", "data-test": "slider" });
  const isOn = h("input", { type: "checkbox", id: "compare", "data-test": "compare" });
  const group = h("span", { class: "compare", hidden: true }, h("label", { class: "check", for: "compare" }, isOn, "last calibration:"), h("span", { class: "before" }, "before"), slider, h("span", { class: "after" }, "after"));
  let comparison: Comparison | null = null;
  const apply = (): void => view.compare(isOn.checked ? comparison : null, Number(slider.value));
  const fetchIt = async (): Promise<void> => {
    const { chosen, isLive } = { chosen: context.state.chosen.value, isLive: context.state.isLive };
    if (!chosen || !isLive) return;
    const found = lastComparison(await context.calibrations.history(chosen, 10).catch(() => []));
    if (chosen !== context.state.chosen.value) return; // another sensor is looked at by now
    comparison = found;
    group.hidden = comparison === null;
    group.title = comparison ? `before: ${comparison.meaning}` : "";
    apply();
  };
  isOn.addEventListener("change", apply);
  slider.addEventListener("input", apply);
  for (const signal of [context.state.historyVersion, context.state.chosen, context.state.connection]) signal.follow(() => void fetchIt());
  return group;
}

/** Says how old the picture is, and why there is none. */
function showFrameStatus(context: Context, place: HTMLElement): void {
  const { frames, state } = context;
  const frame = frames.frame.value;
  const age_s = (performance.now() - frames.heardAt) / 1000;
  const isOld = !state.isLive || age_s > 1.5;
  place.classList.toggle("old", isOld);
  if (frames.absence.value && state.isLive) setText(place, `${frames.absence.value.title} ${frames.absence.value.detail}`);
  else if (!frame) setText(place, "No frame yet.");
  else if (isOld) setText(place, `This picture is ${duration(age_s)} old.`);
  else if (!frame.T_base_sensor) setText(place, "No pose is known: the points cannot be placed in the cell. See the sensor's eye.");
  else setText(place, frame.pose_valid ? "" : "The pose is not valid: the points may lie in the wrong place.");
}
