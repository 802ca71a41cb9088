// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// A real Chromium, without a screen and without a graphics card.
import { mkdirSync } from "node:fs";
import { join } from "node:path";
import axe from "axe-core";
import { chromium } from "playwright-core";
import { waitUntil } from "./cell.mjs";

const OUT = process.env.CALIBRD_PAGE_OUT ?? "/tmp/calibrd-page";
export const EXECUTABLE = process.env.CALIBRD_CHROMIUM ?? "/usr/bin/chromium";
export const FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];

/** The browser reports every 4xx; a pose may end between the page's hearing of it and asking for it in a format. */
const isOfAPoseThatEnds = (message) => /409/.test(message.text()) && /\/pose\?format=/.test(message.location().url);

/** What went wrong in a page, or left its host. */
export class Faults {
  errors = [];
  foreign = [];

  watch(page, url) {
    page.on("console", (message) => message.type() === "error" && !isOfAPoseThatEnds(message) && this.errors.push(message.text()));
    page.on("pageerror", (error) => this.errors.push(String(error)));
    page.on("request", (request) => {
      const asked = request.url();
      if (!asked.startsWith(`${url}/`) && !/^(blob|data):/.test(asked)) this.foreign.push(asked);
    });
  }
}

export async function openBrowser(...flags) {
  return chromium.launch({ executablePath: EXECUTABLE, args: [...FLAGS, ...flags] });
}

/** A page of its own, with a session storage of its own. */
export async function openPage(browser, url, faults, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 720 }, ...options });
  await context.grantPermissions(["clipboard-read", "clipboard-write"], { origin: url });
  const page = await context.newPage();
  page.setDefaultTimeout(60_000);
  faults.watch(page, url);
  await page.goto(`${url}/`);
  return page;
}

/** Keeps a picture as output of the test. */
export async function keep(page, name) {
  mkdirSync(OUT, { recursive: true });
  await page.screenshot({ path: join(OUT, `${name}.png`) });
}

/** Faults that axe-core calls serious or critical: "rule: selector". */
export async function seriousFaults(page) {
  // Not as a script element, which the page's policy forbids.
  await page.evaluate(axe.source);
  const { violations } = await page.evaluate(() => globalThis.axe.run(document, { resultTypes: ["violations"] }));
  return violations
    .filter(({ impact }) => impact === "serious" || impact === "critical")
    .flatMap(({ id, nodes }) => nodes.map((node) => `${id}: ${node.target.join(" ")} ${node.any[0]?.message ?? ""}`));
}

export const part = (page, name) => page.locator(`[data-test=${name}]`);

/** What tests do with the page that `current` returns. */
export function helpers(current) {
  const text = (name) => part(current(), name).first().textContent();
  const unfair = new Set();
  return {
    text,
    unfair,
    /** Patient: on a busy machine a calibration takes minutes. */
    says: (name, wanted, timeoutMs = 240_000) =>
      waitUntil(`"${name}" says ${wanted}`, async () => (wanted instanceof RegExp ? wanted.test(await text(name)) : (await text(name)) === wanted), timeoutMs),
    tab: (name) => current().locator(`#tab-${name}`).click(),
    /** Keeps a picture of the state, and what would shut somebody out in it. */
    show: async (name, shown = current()) => {
      await keep(shown, name);
      for (const fault of await seriousFaults(shown)) unfair.add(`${name}: ${fault}`);
    },
  };
}
