// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// The page against the real daemon and the simulated cell, by clicking. Each test goes on where the one before it ended.
import assert from "node:assert/strict";
import { statSync } from "node:fs";
import { after, before, beforeEach, test } from "node:test";
import { Faults, helpers, openBrowser, openPage, part } from "./lib/browser.mjs";
import { Cell, SENSOR, sleep, waitUntil } from "./lib/cell.mjs";
import { load } from "./lib/modules.mjs";
import { countPixels } from "./lib/picture.mjs";

const faults = new Faults();
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

const { text, says, tab, show, unfair } = helpers(() => page);
/** So that one that fails does not take all that follow with it. */
beforeEach(() => tab("act"));
const confirm = () => page.locator("dialog[open] button[value=go]").click();
const pose = () => cell.api(`/api/v1/sensors/${SENSOR}/pose`);
/** A check that disagrees, as one of a pose from few postures now and then does, takes it away for a moment. */
const validPose = () =>
  waitUntil("the pose is valid", async () => {
    const found = await pose();
    return found.valid && found;
  }, 60_000);
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
  await says("notices", /Calibration \S+: cancelled\./, 20_000);
  await tab("history");
  await says("reasons", /./, 20_000);
  await tab("act");
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
});

test("the sensor's eye shows depth and outline, in every colouring", async () => {
  await part(page, "by-eye").click();
  await waitUntil("the eye draws", () => page.locator("canvas.eye[data-drawn=yes]").count());
  const isColour = (...wanted) => (...rgb) => rgb.every((value, at) => Math.abs(value - wanted[at]) < 12);
  const shows = (what, is, least) => waitUntil(what, async () => (await countPixels(page, part(page, "eye"), is)) > least);
  for (const colouring of ["residual", "class", "depth"]) {
    await part(page, "colouring").selectOption(colouring);
    if (colouring === "residual") await shows("what is not robot is grey", isColour(52, 58, 64), 30_000);
    if (colouring === "class") await shows("the robot is blue", isColour(0x2f, 0x8f, 0xe0), 3000);
    if (colouring === "class") await shows("the background is brown", isColour(0xa5, 0x8a, 0x63), 30_000);
    if (colouring === "depth") await shows("depth is in colours", isPainted, 50_000);
    await show(`6-eye-${colouring}`);
  }
  await part(page, "colouring").selectOption("class");
  await shows("the robot's outline is white inside", isColour(255, 255, 255), 500);
  await shows("and black outside", (r, g, b) => r + g + b === 0, 500);
  await part(page, "colouring").selectOption("depth");
  await part(page, "by-space").click();
});

/** Of the 3D view, where the measured points are left out: red, green and blue of what else is drawn. */
const seen = (is) => countPixels(page, part(page, "cell"), is);
const isGhost = (r, g, b) => g > r + 18 && g > b + 4;
const isPainted = (r, g, b) => Math.max(r, g, b) - Math.min(r, g, b) > 60;
const isOrange = (r, g, b) => r > g + 60 && g > b + 30;
const isGreen = (r, g, b) => g > r + 60 && g > b + 30;

test("the robot's links are painted by coverage and by residual, and cleaned again", async () => {
  const { LIGHT_LEVELS, lit, METAL } = await load("view/light", "view/solid", "view/colours");
  const metal = new Set(Array.from({ length: LIGHT_LEVELS }, (_, level) => lit(METAL, level / (LIGHT_LEVELS - 1)).join()));
  const isMetal = (...rgb) => metal.has(rgb.join());
  await page.locator("#show-measured").uncheck();
  await tab("history");
  const heat = (kind) => part(page, `heat-${kind}`).first();
  await waitUntil("the robot is of metal, and nothing painted but lines", async () => (await seen(isMetal)) > 10_000 && (await seen(isPainted)) < 1500);
  await heat("coverage").click();
  await waitUntil("links are painted by coverage", async () => (await seen(isPainted)) > 3000);
  await waitUntil("the colours are told", async () => /100 %.*seen where it was predicted/.test(await page.locator(".legend").textContent()));
  await show("7-coverage");
  await heat("residual").click();
  await waitUntil("links are painted by residual, which here is small", async () => (await seen(isPainted)) < 1500 && (await seen(isMetal)) < 1000);
  assert.equal(await heat("residual").getAttribute("aria-pressed"), "true");
  await show("7-residual");
  await heat("residual").click();
  await waitUntil("they are of metal", async () => (await seen(isMetal)) > 10_000);
  await page.locator("#show-measured").check();
});

test("where to move the robot is drawn and told; a capture and a support bundle are saved", async () => {
  await page.locator("#show-measured").uncheck();
  await waitUntil("nothing is green yet but lines", async () => (await seen(isGhost)) < 1500);
  await part(page, "suggest").click();
  await says("suggestion", /Then \d+\.\d+.mm/);
  await waitUntil("the posture is drawn", async () => (await seen(isGhost)) > 3000);
  await show("7-suggestion");
  await part(page, "suggestion").getByRole("button").click();
  await waitUntil("it is gone", async () => (await seen(isGhost)) < 1500);
  await page.locator("#show-measured").check();
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
  assert.match((await page.evaluate(() => globalThis.stages)).join(), /Collecting|Computing/, "healing was shown while it was under way");
  await show("9-candidate");
  assert.equal((await pose()).valid, false);
  await part(page, "accept").click();
  await confirm();
  await says("state", "valid");
  const healed = await validPose();
  assert.notEqual(healed.calibration, first.calibration);
  assert.ok(Math.hypot(...healed.translation_m.map((part, axis) => part - first.translation_m[axis])) > 0.01, "it has moved with the sensor");
});

test("what the last calibration did is drawn: before it in orange, after it in green", async () => {
  await page.locator("#show-measured").uncheck();
  await page.getByRole("button", { name: "From the sensor" }).click(); // whatever it stands like, what it sees of the robot is in the picture
  await part(page, "compare").check();
  const slide = (share) => part(page, "slider").fill(String(share));
  await slide(0);
  await waitUntil("the robot's points are where they were seen before, in orange", async () => (await seen(isOrange)) > 3000);
  assert.ok((await seen(isGreen)) < 1500);
  await show("4-before");
  await slide(1);
  await waitUntil("and after, in green", async () => (await seen(isGreen)) > 3000);
  assert.ok((await seen(isOrange)) < 300);
  await show("4-after");
  await part(page, "compare").uncheck();
  await waitUntil("they are gone", async () => (await seen(isGreen)) < 1500);
  await page.getByRole("button", { name: "Front" }).click();
  await page.locator("#show-measured").check();
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

test("the focus stays where it is while the history is drawn anew", async () => {
  await tab("history");
  const row = page.locator(`tr[data-id="${first.calibration}"]`);
  const focused = () => page.evaluate(() => [document.activeElement?.dataset.test, document.activeElement?.closest("[data-id]")?.dataset.id]);
  for (const name of ["compare-row", "rollback"]) {
    await row.locator(`[data-test=${name}]`).focus();
    const drawn = await row.elementHandle();
    const { id } = await waitUntil("a calibration begins", () => cell.send("POST", `/api/v1/sensors/${SENSOR}/calibrations`));
    await cell.send("DELETE", `/api/v1/calibrations/${id}`);
    await waitUntil("the row is another element", () => drawn.evaluate((old) => !old.isConnected));
    assert.deepEqual(await focused(), [name, first.calibration]);
  }
});

test("light and dark, on a screen and on a tablet: all of it is there", async () => {
  for (const colorScheme of ["light", "dark"])
    for (const [width, height] of [[1280, 720], [820, 1180]])
      for (const name of ["act", "history", "drift", "pose"]) {
        await page.emulateMedia({ colorScheme });
        await page.setViewportSize({ width, height });
        await tab(name);
        await sleep(200);
        const over = await page.evaluate(() => {
          const parts = [...document.querySelectorAll("html, main, .side, [role=tabpanel]:not([hidden]), .sensor")];
          return parts.filter((part) => part.scrollWidth > part.clientWidth + 1).map((part) => `${part.tagName}.${part.className}: ${part.scrollWidth} of ${part.clientWidth}`);
        });
        assert.deepEqual(over, [], `${name} at ${width}: nothing hangs over`);
        await show(`12-${colorScheme}-${width}-${name}`);
      }
  await page.setViewportSize({ width: 1280, height: 720 });
});

test("the 3D view is turned, moved and neared by keyboard", async () => {
  const view = part(page, "cell");
  const ground = async () => (await view.screenshot()).toString("base64");
  await page.locator("#show-measured").uncheck();
  await view.focus();
  for (const key of ["ArrowLeft", "Shift+ArrowLeft", "+"]) {
    const before = await ground();
    await page.keyboard.press(key);
    await waitUntil(`${key} has another picture drawn`, async () => (await ground()) !== before);
  }
  await page.locator("#show-measured").check();
});

test("nothing so far is an error, or goes to another host", () => {
  assert.deepEqual(faults.errors, []);
  assert.deepEqual(faults.foreign, []);
});

test("nobody is shut out of any of these states", () => assert.deepEqual([...unfair], []));
