// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// The page against the real daemon and the simulated cell, by clicking.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { keep, Faults, openBrowser, openPage, part, seriousFaults } from "./lib/browser.mjs";
import { Cell, SENSOR, waitUntil } from "./lib/cell.mjs";

const faults = new Faults();
let cell, browser, page;

before(async () => {
  browser = await openBrowser();
  cell = await Cell.start("drift.healing=ask", "pose.max_unverified=20s");
  page = await openPage(browser, cell.url, faults);
});

after(async () => {
  await browser?.close();
  await cell?.end();
});

const text = (name) => part(page, name).first().textContent();
const state = (wanted) => waitUntil(`the page says ${wanted}`, async () => (await text("state")) === wanted, 60_000);

test("an empty cell is shown as one: live, robot drawn, no pose", async () => {
  await waitUntil("it is live", async () => (await text("connection")) === "live");
  await state("not valid · uncalibrated");
  await waitUntil("the robot is drawn", () => page.locator("canvas[data-robot=shown]").count());
  assert.match(await text("error"), /no pose yet/);
  await keep(page, "1-uncalibrated");
});

test("the first calibration, by clicking, ends with a valid pose", async () => {
  await part(page, "calibrate").click();
  await keep(page, "2-asked");
  await page.locator("dialog[open] button[value=go]").click();
  await part(page, "job").waitFor();
  await keep(page, "3-calibrating");
  await state("valid");
  assert.equal((await cell.api(`/api/v1/sensors/${SENSOR}/pose`)).valid, true);
  await waitUntil("the cloud is drawn", () => page.locator("canvas[data-cloud=shown]").count());
  await keep(page, "4-valid");
});

test("nothing of it is an error, goes to another host, or shuts somebody out", async () => {
  assert.deepEqual(await seriousFaults(page), []);
  assert.deepEqual(faults.errors, []);
  assert.deepEqual(faults.foreign, []);
});
