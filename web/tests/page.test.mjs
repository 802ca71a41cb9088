// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// The page against the real daemon and the simulated cell, by clicking. Each test goes on where the one before it ended.
import assert from "node:assert/strict";
import { statSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { Faults, keep, openBrowser, openPage, part, seriousFaults } from "./lib/browser.mjs";
import { Cell, SENSOR, sleep, waitUntil } from "./lib/cell.mjs";

const faults = new Faults();
const unfair = [];
let cell, browser, page, first;

before(async () => {
  browser = await openBrowser();
  cell = await Cell.start("drift.healing=ask", "pose.max_unverified=20s", `sensors.${SENSOR}.workspace.tray=[0.5,0.0,0.1]`);
  page = await openPage(browser, cell.url, faults);
});

after(async () => {
  await browser?.close();
  await cell?.end();
});

const text = (name) => part(page, name).first().textContent();
/** Patient: on a busy machine a calibration takes minutes. */
const says = (name, wanted, timeoutMs = 240_000) =>
  waitUntil(`"${name}" says ${wanted}`, async () => (wanted instanceof RegExp ? wanted.test(await text(name)) : (await text(name)) === wanted), timeoutMs);
const tab = (name) => page.locator(`#tab-${name}`).click();
const confirm = () => page.locator("dialog[open] button[value=go]").click();
const pose = () => cell.api(`/api/v1/sensors/${SENSOR}/pose`);
/** A check that disagrees, as one of a pose from few postures now and then does, takes it away for a moment. */
const validPose = () =>
  waitUntil("the pose is valid", async () => {
    const found = await pose();
    return found.valid && found;
  }, 60_000);
/** Keeps a picture of the state, and what would shut somebody out in it. */
const show = async (name, shown = page) => {
  await keep(shown, name);
  unfair.push(...(await seriousFaults(shown)).map((fault) => `${name}: ${fault}`));
};
/** The file that a button saves, and its size. */
const saved = async (press) => {
  const [download] = await Promise.all([page.waitForEvent("download", { timeout: 90_000 }), press()]);
  return { name: download.suggestedFilename(), size: statSync(await download.path()).size };
};

test("an empty cell is shown as one: live, robot drawn, no pose to take", async () => {
  await says("connection", "live");
  await says("state", "not valid · uncalibrated");
  await waitUntil("the robot is drawn", () => page.locator("canvas[data-robot=shown]").count());
  assert.match(await text("error"), /no pose yet/);
  await tab("pose");
  assert.match(await text("pose-refusal"), /not valid/);
  assert.equal(await part(page, "copy").isDisabled(), true);
  await tab("act");
  await show("1-uncalibrated");
});

test("a calibration that has begun is shown, and can be cancelled", async () => {
  await part(page, "calibrate").click();
  await show("2-asked");
  await confirm();
  await says("job", /^Collecting: [1-5] of 5 postures/);
  assert.equal(await part(page, "calibrate").isDisabled(), true);
  await show("3-calibrating");
  await part(page, "cancel").click();
  await confirm();
  await part(page, "job").waitFor({ state: "hidden" });
  assert.equal((await pose()).job, null);
  assert.equal(await text("state"), "not valid · uncalibrated");
});

test("the first calibration, by clicking, ends with a valid pose", async () => {
  await part(page, "calibrate").click();
  await confirm();
  await says("stage", "Computing");
  await says("state", "valid");
  first = await validPose();
  assert.equal(first.valid, true);
  await waitUntil("the cloud is drawn", async () => Number(await part(page, "cell").getAttribute("data-points")) > 20_000);
  await says("error", /tray .*mm \(1σ\)/);
  await show("4-valid");
});

test("a copied pose is what the interface gives", async () => {
  await tab("pose");
  for (const format of ["ros2", "abb", "kuka"]) {
    await part(page, "format").selectOption(format);
    const given = await (await fetch(`${cell.url}/api/v1/sensors/${SENSOR}/pose?format=${format}`)).text();
    await waitUntil(`${format} is shown`, async () => (await text("pose")) === given);
    await part(page, "copy").click();
    await waitUntil("it is on the clipboard", async () => (await page.evaluate(() => navigator.clipboard.readText())) === given);
  }
  await show("5-pose");
  await tab("act");
});

test("the sensor's eye shows depth and outline, in every colouring", async () => {
  await part(page, "by-eye").click();
  await waitUntil("the eye draws", () => page.locator("canvas.eye[data-drawn=yes]").count());
  for (const colouring of ["residual", "class", "depth"]) {
    await part(page, "colouring").selectOption(colouring);
    await sleep(300);
    await show(`6-eye-${colouring}`);
  }
  await part(page, "by-space").click();
});

test("where to move the robot is drawn and told; a capture and a support bundle are saved", async () => {
  await part(page, "suggest").click();
  await says("suggestion", /Then \d+\.\d+.mm/);
  await show("7-suggestion");
  await part(page, "suggestion").getByRole("button").click();
  await part(page, "capture").click();
  const capture = await saved(confirm);
  assert.match(capture.name, /\.tar$/);
  assert.ok(capture.size > 100_000, `${capture.size} bytes`);
  const bundle = await saved(() => part(page, "bundle").click());
  assert.ok(bundle.size > 1000, `${bundle.name}: ${bundle.size} bytes`);
});

test("what healing finds can be rejected: the pose stays what it is, and a calibration mends it", async () => {
  await cell.knock();
  await part(page, "reject").waitFor({ timeout: 240_000 });
  await part(page, "reject").click();
  await confirm();
  await part(page, "candidate").waitFor({ state: "hidden" });
  const left = await pose();
  assert.equal(left.valid, false);
  assert.equal(left.last_known.calibration, first.calibration);
  await part(page, "calibrate").click();
  await confirm();
  await says("state", "valid");
  first = await validPose();
});

test("a knock is shown as drift, and what healing finds waits to be accepted", async () => {
  await page.evaluate(() => {
    const stage = document.querySelector("[data-test=stage]");
    globalThis.stages = [];
    new MutationObserver(() => globalThis.stages.push(stage.textContent)).observe(stage, { childList: true });
  });
  await cell.knock();
  await says("state", "not valid · drifted");
  assert.match(await text("verdict"), /sensor moved/);
  await show("8-drifted");
  await tab("drift");
  await says("drift-events", /sensor moved/);
  await show("8-drift");
  await tab("act");
  await part(page, "accept").waitFor({ timeout: 240_000 });
  assert.match((await page.evaluate(() => globalThis.stages)).join(), /Computing/, "healing was shown while it was under way");
  await show("9-candidate");
  assert.equal((await pose()).valid, false);
  await part(page, "accept").click();
  await confirm();
  await says("state", "valid");
  const healed = await validPose();
  assert.notEqual(healed.calibration, first.calibration);
  assert.ok(Math.hypot(...healed.translation_m.map((part, axis) => part - first.translation_m[axis])) > 0.01, "it has moved with the sensor");
});

test("rolled back to a pose that the sensor no longer has, the page does not call it valid", async () => {
  const second = (await validPose()).calibration;
  await tab("history");
  const row = (id) => page.locator(`tr[data-id="${id}"]`);
  for (const id of [first.calibration, second]) await row(id).locator("input").check();
  await says("diff", /Position \d+\.\d+ mm/);
  await show("10-history");
  await row(first.calibration).locator("[data-test=rollback]").click();
  await confirm();
  await waitUntil("the first one is served", () => row(first.calibration).getAttribute("data-current").then((is) => is === "true"));
  await says("state", /^not valid · (unverified|drifted)$/);
  await show("11-rolled-back");
  await row(second).locator("[data-test=rollback]").click();
  await confirm();
  await says("state", "valid");
  await tab("act");
  await part(page, "job").waitFor({ state: "hidden" });
  assert.equal(await part(page, "candidate").isHidden(), true, "what healing of the other pose has found is not offered");
});

test("light and dark, on a screen and on a tablet: all of it is there", async () => {
  for (const colorScheme of ["light", "dark"])
    for (const [width, height] of [[1280, 720], [820, 1180]])
      for (const name of ["act", "history", "drift", "pose"]) {
        await page.emulateMedia({ colorScheme });
        await page.setViewportSize({ width, height });
        await tab(name);
        await sleep(200);
        assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), `${name}: nothing hangs over`);
        await show(`12-${colorScheme}-${width}-${name}`);
      }
  await page.setViewportSize({ width: 1280, height: 720 });
  await tab("act");
});

test("tabs are reached and changed by keyboard", async () => {
  await page.locator("#tab-act").focus();
  await page.keyboard.press("ArrowRight");
  assert.equal(await page.locator("#tab-history").getAttribute("aria-selected"), "true");
  await page.keyboard.press("ArrowLeft");
});

test("nothing so far is an error, or goes to another host", () => {
  assert.deepEqual(faults.errors, []);
  assert.deepEqual(faults.foreign, []);
});

test("a lost daemon is shown within 2 s, what is old is called so, and the page comes back by itself", async () => {
  await cell.daemon.end("SIGKILL");
  const lost = performance.now();
  await waitUntil("it is shown", async () => /lost/.test(await text("connection")), 5000, 20);
  const afterMs = performance.now() - lost;
  console.log(`a killed daemon is shown after ${Math.round(afterMs)} ms`);
  assert.ok(afterMs < 2000, `${afterMs} ms`);
  await says("state", /as of .* ago/, 5000);
  await show("13-lost");
  await cell.serve();
  await says("connection", "live", 10_000);
  await says("state", "valid");
});

test("with a token that may only read, nothing else is offered", async () => {
  const file = join(cell.folder, "tokens.json");
  const token = Cell.token(file, "screen", "read");
  await cell.daemon.end();
  cell.settings.push(`server.tokens_file=${file}`);
  await cell.serve();
  const guarded = new Faults();
  const guest = await openPage(browser, cell.url, guarded);
  const enter = async (word) => {
    await part(guest, "token").fill(word);
    await guest.keyboard.press("Enter");
  };
  await enter("calibrd_wrong");
  await waitUntil("it is refused", async () => /not know/.test(await guest.locator("dialog[open] .error").textContent()));
  await show("14-token", guest);
  await enter(token);
  await waitUntil("it is live", async () => (await part(guest, "connection").textContent()) === "live");
  assert.equal(await part(guest, "who").textContent(), "screen (read)");
  assert.equal(await part(guest, "read-only").count(), 1);
  for (const name of ["calibrate", "capture", "bundle", "rollback", "accept"]) assert.equal(await part(guest, name).count(), 0, name);
  await show("15-read-only", guest);
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

test("nobody is shut out of any of these states", () => assert.deepEqual([...new Set(unfair)], []));
