// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Working at the page: several sensors, the keyboard, a long history, a hidden tab, another token. Each test goes on where the one before
// it ended; no calibration has to end well for any of them.
import assert from "node:assert/strict";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { Faults, helpers, openBrowser, openPage, part } from "./lib/browser.mjs";
import { Cell, SENSOR, waitUntil } from "./lib/cell.mjs";

const [LEFT, RIGHT] = [SENSOR, "right"];
const faults = new Faults();
let cell, browser, page;
const { text, says, tab } = helpers(() => page);
const row = (id) => page.locator(`tr[data-id="${id}"]`);
const rows = () => page.locator("tr[data-id]").count();
const focused = () => page.evaluate(() => [document.activeElement?.dataset.test ?? document.activeElement?.tagName, document.activeElement?.closest("[data-id]")?.dataset.id ?? ""]);

/** One that ended as cancelled. */
async function cancelled(sensor) {
  const { id } = await waitUntil("one begins", () => cell.send("POST", `/api/v1/sensors/${sensor}/calibrations`));
  await cell.send("DELETE", `/api/v1/calibrations/${id}`);
  await waitUntil("it has ended", async () => (await cell.api(`/api/v1/calibrations/${id}`)).finished_at);
  return id;
}

before(async () => {
  browser = await openBrowser();
  cell = await Cell.startWith([LEFT, RIGHT]);
  page = await openPage(browser, cell.url, faults);
  await says("connection", "live");
});

after(async () => {
  await browser?.close();
  await cell?.end();
});

test("what is shown is of the sensor that was chosen", async () => {
  const name = (sensor) => page.locator(`article[data-sensor="${sensor}"] button.name`);
  await waitUntil("both have a line", async () => (await page.locator("article.sensor").count()) === 2);
  const id = await cancelled(RIGHT);
  await tab("history");
  await name(RIGHT).click();
  await row(id).waitFor();
  const asked = page.waitForRequest((request) => request.url().includes(`/sensors/${LEFT}/frame`));
  await name(LEFT).click();
  await asked;
  await row(id).waitFor({ state: "detached" });
  assert.equal(await rows(), 0);
  assert.equal(await name(LEFT).getAttribute("aria-pressed"), "true");
});

test("a question is answered by keyboard alone, and the focus comes back", async () => {
  await tab("act");
  const button = part(page, "calibrate");
  await button.focus();
  await page.keyboard.press("Enter");
  const dialog = page.locator("dialog[open]");
  await dialog.waitFor();
  for (let presses = 0; presses < 12; ++presses) {
    const isInside = await page.evaluate(() => document.activeElement === document.body || document.querySelector("dialog[open]").contains(document.activeElement));
    assert.ok(isInside, `after ${presses} presses of Tab`);
    await page.keyboard.press("Tab");
  }
  await page.keyboard.press("Escape");
  await dialog.waitFor({ state: "detached" });
  await waitUntil("the button has the focus again", async () => (await focused())[0] === "calibrate");
  assert.deepEqual((await cell.api(`/api/v1/sensors/${LEFT}/calibrations`)).calibrations, []);
  await page.keyboard.press("Enter");
  await page.keyboard.press("Enter"); // "Start", which has the focus
  await part(page, "job").waitFor();
  await part(page, "cancel").focus();
  await page.keyboard.press("Enter");
  await dialog.waitFor();
  assert.notEqual(await page.evaluate(() => document.activeElement.value), "go", "what takes something away is not what Enter does");
  await page.locator("dialog[open] button[value=go]").focus();
  await page.keyboard.press("Enter");
  await part(page, "job").waitFor({ state: "hidden" });
});

test("tabs are reached and changed by keyboard", async () => {
  await page.locator("#tab-act").focus();
  await page.keyboard.press("ArrowRight");
  assert.equal(await page.locator("#tab-history").getAttribute("aria-selected"), "true");
  await page.keyboard.press("ArrowLeft");
  await page.keyboard.press("End");
  assert.equal(await page.locator("#tab-pose").getAttribute("aria-selected"), "true");
  await page.keyboard.press("Home");
  assert.equal(await page.locator("#tab-act").getAttribute("aria-selected"), "true");
});

test("of a long history the newest are shown, and older ones when they are asked for", async () => {
  const ids = [];
  for (let count = 0; count < 24; ++count) ids.push(await cancelled(LEFT));
  await tab("history");
  await row(ids.at(-1)).waitFor();
  assert.equal(await rows(), 20);
  assert.equal(await row(ids[0]).count(), 0);
  await part(page, "older").click();
  await row(ids[0]).waitFor();
  assert.equal(await rows(), 25, "those and the one before them");
  assert.equal(await part(page, "older").isVisible(), false);
});

test("a tab that nobody sees holds no connection, and is live again when it is looked at", async () => {
  const listeners = async () => Number(/^calibrd_event_subscribers (\d+)$/m.exec(await (await fetch(`${cell.url}/metrics`)).text())[1]);
  const hide = (isHidden) =>
    page.evaluate((value) => {
      Object.defineProperty(document, "hidden", { configurable: true, get: () => value });
      document.dispatchEvent(new Event("visibilitychange"));
    }, isHidden);
  assert.equal(await listeners(), 1);
  await hide(true);
  await waitUntil("nothing is held", async () => (await listeners()) === 0, 10_000);
  assert.notEqual(await text("connection"), "live");
  await hide(false);
  await says("connection", "live", 5000);
  assert.equal(await listeners(), 1);
});

test("a token that is taken away ends the page's look, and another one gives what it allows", async () => {
  const file = join(cell.folder, "tokens.json");
  const reader = Cell.token(file, "screen", "read");
  await cell.daemon.end();
  cell.settings.push(`server.tokens_file=${file}`);
  await cell.serve();
  const enter = async (token) => {
    await part(page, "token").waitFor();
    await part(page, "token").fill(token);
    await page.keyboard.press("Enter");
  };
  await enter(reader);
  await says("who", "screen (read)");
  await says("connection", "live");
  const operator = Cell.token(file, "operator", "calibrate");
  Cell.revoke(file, "screen");
  cell.daemon.process.kill("SIGHUP");
  await waitUntil("it asks for another one", async () => /not know/.test(await page.locator("dialog[open] .error").textContent()));
  assert.equal(await part(page, "calibrate").count(), 0);
  await enter(operator);
  await says("who", "operator (calibrate)");
  await says("connection", "live");
  await part(page, "calibrate").waitFor({ state: "attached" });
  await page.getByRole("button", { name: "Forget the token" }).click();
  await part(page, "token").waitFor();
});

test("nothing of it is a fault of the page, or goes to another host", () => {
  assert.deepEqual(faults.errors.filter((error) => !/401|503|ERR_CONNECTION_REFUSED|ERR_INCOMPLETE/.test(error)), []);
  assert.deepEqual(faults.foreign, []);
});
