// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Prints the page's figures: scripts/page.sh figures [MINUTES]
import { readdirSync, statSync } from "node:fs";
import { loadavg } from "node:os";
import { join } from "node:path";
import { Faults, keep, openBrowser, openPage, part, seriousFaults } from "./lib/browser.mjs";
import { BUILD, Cell, SENSOR, waitUntil } from "./lib/cell.mjs";
import { heapOver, slope } from "./lib/memory.mjs";

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
  row("serious faults of accessibility (axe-core)", String((await seriousFaults(page)).length), "0");
  row("console errors", String(faults.errors.length), "0");
  row("requests to other hosts", String(faults.foreign.length), "0");
  await page.context().close();
  const samples = await heapOver(cell.url, minutes);
  row(`script memory over ${minutes} min, first to last`, `${samples[0].toFixed(1)} to ${samples.at(-1).toFixed(1)} MB (most ${Math.max(...samples).toFixed(1)}), ${slope(samples)}`, "flat");
}

const browser = await openBrowser();
const cell = await Cell.start(`sensors.${SENSOR}.workspace.tray=[0.5,0.0,0.1]`);
try {
  await measure(cell, browser);
} finally {
  await browser.close();
  await cell.end();
}
