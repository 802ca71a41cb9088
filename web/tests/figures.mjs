// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Prints the page's figures: scripts/page.sh figures [MINUTES]
import { readdirSync, statSync } from "node:fs";
import { loadavg } from "node:os";
import { join } from "node:path";
import { Faults, keep, openBrowser, openPage, part, seriousFaults } from "./lib/browser.mjs";
import { BUILD, Cell, SENSOR, sleep, waitUntil } from "./lib/cell.mjs";

const minutes = Number(process.argv[2] ?? 1);
const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1];

function scriptKilobytes() {
  const assets = join(BUILD, "share/calibrd/web/assets");
  const scripts = readdirSync(assets).filter((name) => name.endsWith(".js.gz"));
  return scripts.reduce((total, name) => total + statSync(join(assets, name)).size, 0) / 1000;
}

/** From the page's being asked for to the live state in words and the robot drawn, nothing in the cache, ms. */
async function firstView(browser, url) {
  const faults = new Faults();
  const page = await openPage(browser, url, faults);
  await page.waitForFunction(() => document.querySelector("canvas[data-robot=shown]")?.drawn > 0 && document.querySelector("[data-connection=live]"), null, { polling: 20 });
  const took = await page.evaluate(() => performance.now()); // since the navigation began
  await page.context().close();
  return took;
}

/** Pictures drawn a second while frames and joints come and the view is turned. */
async function framesPerSecond(page, seconds) {
  const canvas = part(page, "cell");
  const drawn = () => canvas.evaluate((element) => element.drawn);
  const box = await canvas.boundingBox();
  await page.mouse.move(box.x + 300, box.y + 200);
  await page.mouse.down();
  const [before, start] = [await drawn(), performance.now()];
  while (performance.now() - start < seconds * 1000)
    await page.mouse.move(box.x + 300 + 150 * Math.sin(performance.now() / 500), box.y + 200);
  const [after, end] = [await drawn(), performance.now()];
  await page.mouse.up();
  return (1000 * (after - before)) / (end - start);
}

/** Of script objects and what they hold (arrays, elements), after collecting what is garbage, MB: the least of some moments,
 * for a frame that just comes is no growth. */
async function heap(session) {
  const moments = [];
  for (let moment = 0; moment < 9; ++moment) {
    await session.send("HeapProfiler.collectGarbage");
    const { usedSize, backingStorageSize = 0, embedderHeapUsedSize = 0 } = await session.send("Runtime.getHeapUsage");
    moments.push((usedSize + backingStorageSize + embedderHeapUsedSize) / 1e6);
    await sleep(130);
  }
  return Math.min(...moments);
}

/** Of a line through samples, one a minute, and its standard error: kB/min. */
function slope(samples) {
  const middle = (samples.length - 1) / 2;
  const total = (of) => samples.reduce((sum, value, at) => sum + of(value, at - middle), 0);
  const squares = total((_, x) => x * x) || 1;
  const mean = total((value) => value) / samples.length;
  const rise = total((value, x) => value * x) / squares;
  const left = total((value, x) => (value - mean - rise * x) ** 2);
  const error = Math.sqrt(left / Math.max(1, samples.length - 2) / squares);
  return `${(1000 * rise).toFixed(0)} ± ${(1000 * error).toFixed(0)} kB/min`;
}

async function heapOver(page) {
  const session = await page.context().newCDPSession(page);
  await sleep(10_000); // the history and the charts have been fetched
  const samples = [await heap(session)];
  for (let minute = 0; minute < minutes; ++minute) {
    await sleep(60_000);
    samples.push(await heap(session));
    console.error(`minute ${minute + 1}: ${samples.at(-1).toFixed(2)} MB`);
  }
  return samples;
}

async function measure(cell, browser) {
  const row = (what, value, wanted) => console.log(`${what.padEnd(58)} ${value.padEnd(44)} ${wanted}`);
  row("processes waiting for a processor (load average)", loadavg().map((load) => load.toFixed(1)).join(", "), "");
  row("script, gzip", `${scriptKilobytes().toFixed(0)} kB`, "<= 300 kB");
  const views = [];
  for (let turn = 0; turn < 5; ++turn) views.push(await firstView(browser, cell.url));
  row("first view, median of 5", `${median(views).toFixed(0)} ms (most ${Math.max(...views).toFixed(0)})`, "<= 1500 ms");
  const faults = new Faults();
  const page = await openPage(browser, cell.url, faults);
  await part(page, "calibrate").click();
  await page.locator("dialog[open] button[value=go]").click();
  await waitUntil("the pose is valid", async () => (await part(page, "state").textContent()) === "valid", 180_000);
  await part(page, "density").selectOption("1");
  await page.getByRole("button", { name: "From the sensor" }).click(); // all points are in the picture
  await page.waitForFunction(() => Number(document.querySelector("canvas.cell").dataset.points) > 100_000);
  const points = await part(page, "cell").getAttribute("data-points");
  row(`3D view, 1280x720, software GL, ${points} points`, `${(await framesPerSecond(page, 10)).toFixed(1)} frames/s`, ">= 20");
  await keep(page, "figures");
  const samples = await heapOver(page);
  row(`script memory over ${minutes} min, first to last`, `${samples[0].toFixed(1)} to ${samples.at(-1).toFixed(1)} MB (most ${Math.max(...samples).toFixed(1)}), ${slope(samples)}`, "flat");
  row("serious faults of accessibility (axe-core)", String((await seriousFaults(page)).length), "0");
  row("console errors", String(faults.errors.length), "0");
  row("requests to other hosts", String(faults.foreign.length), "0");
}

const browser = await openBrowser();
const cell = await Cell.start(`sensors.${SENSOR}.workspace.tray=[0.5,0.0,0.1]`);
try {
  await measure(cell, browser);
} finally {
  await browser.close();
  await cell.end();
}
