// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import uPlot from "uplot";
import { h } from "./dom";

export interface Line {
  label: string;
  colour: string;
  dash?: number[];
  /** Points without a line between. */
  isPoints?: boolean;
}

export interface ChartSettings {
  title: string;
  /** What the horizontal axis counts, with its unit. */
  across: string;
  /** Unit of the values. */
  unit: string;
  lines: Line[];
  /** Whole numbers across: calibrations, not seconds. */
  isCounted?: boolean;
}

const HEIGHT = 150;

/** A chart in the page's colours, as wide as its place. */
export class Chart {
  readonly element: HTMLElement;
  private readonly place = h("div", { class: "plot" });
  private readonly plot: uPlot;

  constructor(settings: ChartSettings) {
    const title = `${settings.title} (${settings.unit})`;
    this.element = h("figure", { class: "chart", role: "img", "aria-label": title }, h("figcaption", {}, title), this.place);
    const colour = (): string => getComputedStyle(this.element).color;
    const axis: uPlot.Axis = { stroke: colour, grid: { stroke: "#80808040", width: 1 }, ticks: { stroke: "#80808040" }, font: "11px system-ui" };
    const whole = (_: uPlot, values: number[]): string[] => values.map((value) => (Number.isInteger(value) ? String(value) : ""));
    this.plot = new uPlot(
      {
        width: 360,
        height: HEIGHT,
        scales: { x: { time: false } },
        legend: { live: false },
        cursor: { drag: { x: false, y: false } },
        axes: [{ ...axis, label: settings.across, labelSize: 16, size: 28, labelFont: "11px system-ui", ...(settings.isCounted ? { values: whole } : {}) }, { ...axis, size: 46 }],
        series: [{}, ...settings.lines.map(seriesOf)],
      },
      [[], ...settings.lines.map(() => [])] as uPlot.AlignedData,
      this.place,
    );
    new ResizeObserver(() => this.resize()).observe(this.place);
  }

  /** `across` and one list of values for each line; null: none. */
  show(across: number[], values: (number | null)[][]): void {
    this.plot.setData([across, ...values] as uPlot.AlignedData);
  }

  resize(): void {
    if (this.place.clientWidth > 0) this.plot.setSize({ width: this.place.clientWidth, height: HEIGHT });
  }
}

function seriesOf({ label, colour, dash, isPoints }: Line): uPlot.Series {
  return { label, stroke: colour, width: isPoints ? 0 : 1.5, ...(dash ? { dash } : {}), points: { show: !!isPoints, size: 6, fill: colour } };
}
