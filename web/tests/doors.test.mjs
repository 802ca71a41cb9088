// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// The page where the daemon, a right or WebGL is missing. Each test goes on where the one before it ended.
import assert from "node:assert/strict";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { Faults, helpers, openBrowser, openPage, part } from "./lib/browser.mjs";
import { Cell, SENSOR, waitUntil } from "./lib/cell.mjs";

let cell, browser, page;
const { text, says, show, tab, unfair } = helpers(() => page);

before(async () => {
  browser = await openBrowser();
  cell = await Cell.start("drift.healing=ask", "pose.max_unverified=20s");
  page = await openPage(browser, cell.url, new Faults());
  for (let count = 1; count <= 2; ++count) {
    // The one before is told as accepted a moment before its job ends.
    await waitUntil(`calibration ${count} begins`, () => cell.send("POST", `/api/v1/sensors/${SENSOR}/calibrations`));
    await waitUntil(`calibration ${count} is served`, async () => (await cell.accepted()) === count, 240_000);
  }
  await says("state", "valid");
});

after(async () => {
  await browser?.close();
  await cell?.end();
});

test("a lost daemon is shown within 2 s, what is old is called so, and the page comes back by itself", async () => {
  await cell.daemon.end("SIGKILL");
  const lost = performance.now();
  await waitUntil("it is shown", async () => /lost/.test(await text("connection")), 5000, 20);
  const afterMs = performance.now() - lost;
  console.log(`a killed daemon is shown after ${Math.round(afterMs)} ms`);
  assert.ok(afterMs < 2000, `${afterMs} ms`);
  await says("state", /as of .* ago/, 5000);
  assert.ok(await part(page, "copy").evaluate((button) => button.disabled), "a pose is offered");
  assert.ok(await part(page, "pose").evaluate((place) => place.hidden), "an old pose is shown");
  await tab("drift");
  await says("drift-meaning", /silent/, 5000);
  await show("13-lost");
  await tab("act");
  await cell.serve();
  await says("connection", "live", 10_000);
  await says("state", "valid");
});

test("a daemon that hangs is shown within 2 s as well", async () => {
  cell.daemon.process.kill("SIGSTOP");
  const lost = performance.now();
  try {
    await waitUntil("it is shown", async () => /lost/.test(await text("connection")), 5000, 20);
  } finally {
    cell.daemon.process.kill("SIGCONT");
  }
  const afterMs = performance.now() - lost;
  console.log(`a hanging daemon is shown after ${Math.round(afterMs)} ms`);
  assert.ok(afterMs < 2000, `${afterMs} ms`);
  await says("connection", "live", 10_000);
  await says("state", "valid");
});

test("two windows of the same browser live side by side", async () => {
  const second = await page.context().newPage();
  const windows = [page, second];
  await second.goto(`${cell.url}/`);
  await waitUntil("both are live", async () => (await Promise.all(windows.map((window) => part(window, "state").textContent()))).every((state) => state === "valid"));
  assert.deepEqual(await Promise.all(windows.map((window) => window.evaluate(() => document.hidden))), [false, false]);
  const seen = new Set();
  const end = performance.now() + 15_000;
  while (performance.now() < end)
    for (const window of windows) for (const name of ["connection", "state"]) seen.add(await part(window, name).textContent());
  await second.close();
  assert.deepEqual([...seen].sort(), ["live", "valid"]);
});

test("with a token, what it does not allow is not offered", async () => {
  const file = join(cell.folder, "tokens.json");
  const [token, operator] = [Cell.token(file, "screen", "read"), Cell.token(file, "operator", "calibrate")];
  await cell.daemon.end();
  cell.settings.push(`server.tokens_file=${file}`);
  await cell.serve();
  const guarded = new Faults();
  const guest = await openPage(browser, cell.url, guarded);
  const enter = async (shown, word) => {
    await part(shown, "token").fill(word);
    await shown.keyboard.press("Enter");
  };
  await enter(guest, "calibrd_wrong");
  await waitUntil("it is refused", async () => /not know/.test(await guest.locator("dialog[open] .error").textContent()));
  await show("14-token", guest);
  await enter(guest, token);
  await waitUntil("it is live", async () => (await part(guest, "connection").textContent()) === "live");
  assert.equal(await part(guest, "who").textContent(), "screen (read)");
  assert.equal(await part(guest, "read-only").count(), 1);
  await guest.locator("tr[data-id]").nth(1).waitFor({ state: "attached" }); // what could be gone back to has come
  for (const name of ["calibrate", "capture", "bundle", "rollback"]) assert.equal(await part(guest, name).count(), 0, name);
  await show("15-read-only", guest);
  const allowed = await openPage(browser, cell.url, guarded);
  await enter(allowed, operator);
  await part(allowed, "rollback").first().waitFor({ state: "attached" });
  for (const name of ["calibrate", "capture"]) assert.equal(await part(allowed, name).count(), 1, name);
  assert.equal(await part(allowed, "bundle").count(), 0);
  await cell.knock();
  await part(guest, "candidate").waitFor({ timeout: 240_000 });
  for (const name of ["accept", "reject"]) assert.equal(await part(guest, name).count(), 0, name);
  await part(allowed, "accept").click();
  await allowed.locator("dialog[open] button[value=go]").click();
  await waitUntil("the pose is valid", async () => (await part(guest, "state").textContent()) === "valid", 120_000);
  assert.deepEqual(guarded.errors, []);
});

test("without WebGL all but the 3D view works, and says so", async () => {
  cell.settings.pop();
  await cell.daemon.end();
  await cell.serve();
  const plain = await openBrowser("--disable-3d-apis");
  try {
    const flat = await openPage(plain, cell.url, new Faults());
    await waitUntil("it is live", async () => (await part(flat, "connection").textContent()) === "live");
    assert.match(await part(flat, "no-webgl").textContent(), /no 3D view/);
    await waitUntil("the eye draws", () => flat.locator("canvas.eye[data-drawn=yes]").count());
    await flat.locator("#tab-history").click();
    await flat.locator("[data-test=rollback]").first().waitFor();
    await flat.locator("#tab-pose").click();
    await waitUntil("the pose can be taken", () => part(flat, "copy").isEnabled());
    await flat.locator("#tab-act").click();
    assert.equal(await part(flat, "calibrate").isEnabled(), true);
    await show("16-without-webgl", flat);
  } finally {
    await plain.close();
  }
});

test("the interface is told offline: every operation, and where each is found", async () => {
  const seen = new Faults();
  const docs = await openPage(browser, cell.url, seen);
  await docs.goto(`${cell.url}/docs`);
  const { paths } = await cell.api("/openapi.json");
  const operations = Object.values(paths).flatMap((path) => ["get", "post", "put", "patch", "delete"].flatMap((method) => path[method]?.operationId ?? []));
  assert.ok(operations.length > 20);
  await docs.locator(`#${operations.at(-1)}`).waitFor();
  for (const id of operations) assert.equal(await docs.locator(`section#${id}`).count(), 1, id);
  await docs.locator(`nav a[href="#${operations.at(-1)}"]`).click();
  assert.match(docs.url(), new RegExp(`#${operations.at(-1)}$`));
  await show("17-docs", docs);
  assert.deepEqual([seen.errors, seen.foreign], [[], []]);
});

test("nobody is shut out of any of these states", () => assert.deepEqual([...unfair], []));
