// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { BareBrowser } from "./bare_browser.mjs";
import { sleep, waitUntil } from "./cell.mjs";

/** The charts of drift go back ten minutes: until they are full what the page holds grows. */
const CHARTS_MINUTES = 10;

/** Of script objects and what they hold (arrays, elements), after collecting what is garbage, MB: the least of some moments,
 * for a frame that just comes is no growth. */
async function heap(browser) {
  const moments = [];
  for (let moment = 0; moment < 9; ++moment) {
    await browser.send("HeapProfiler.collectGarbage");
    const { usedSize, backingStorageSize = 0, embedderHeapUsedSize = 0 } = await browser.send("Runtime.getHeapUsage");
    moments.push((usedSize + backingStorageSize + embedderHeapUsedSize) / 1e6);
    await sleep(130);
  }
  return Math.min(...moments);
}

/** The cell has a valid pose: all points are shown, from the sensor's eye. */
async function showAllPoints(browser) {
  const shown = () => browser.evaluate(`document.querySelector("[data-test=state]")?.textContent`);
  await waitUntil("the pose is valid", async () => (await shown()) === "valid");
  await browser.evaluate(`{
    const density = document.querySelector("[data-test=density]");
    density.value = "1";
    density.dispatchEvent(new Event("change", { bubbles: true }));
    [...document.querySelectorAll("button")].find((button) => button.textContent === "From the sensor").click();
  }`);
  await waitUntil("all points are shown", () => browser.evaluate(`document.querySelector("canvas.cell").dataset.points > 100000`));
}

/** One sample a minute, MB, once the charts are full; for few minutes that is not waited for. */
export async function heapOver(url, minutes) {
  const browser = await BareBrowser.open(`${url}/`);
  try {
    await showAllPoints(browser);
    await sleep(60_000 * Math.min(CHARTS_MINUTES + 1, minutes / 3));
    const samples = [await heap(browser)];
    for (let minute = 1; minute <= minutes; ++minute) {
      await sleep(60_000);
      samples.push(await heap(browser));
      console.error(`minute ${minute}: ${samples.at(-1).toFixed(2)} MB`);
    }
    return samples;
  } finally {
    await browser.close();
  }
}

/** Of a line through samples, one a minute, and its standard error: kB/min. */
export function slope(samples) {
  const middle = (samples.length - 1) / 2;
  const total = (of) => samples.reduce((sum, value, at) => sum + of(value, at - middle), 0);
  const squares = total((_, x) => x * x) || 1;
  const mean = total((value) => value) / samples.length;
  const rise = total((value, x) => value * x) / squares;
  const left = total((value, x) => (value - mean - rise * x) ** 2);
  const error = Math.sqrt(left / Math.max(1, samples.length - 2) / squares);
  return `${(1000 * rise).toFixed(0)} ± ${(1000 * error).toFixed(0)} kB/min`;
}
