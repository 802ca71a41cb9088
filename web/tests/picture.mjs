// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Makes the picture of the page that the README shows: a calibrated cell with a box that was not there before.
import { Faults, keep, openBrowser, openPage, part } from "./lib/browser.mjs";
import { Cell, SENSOR, sleep, waitUntil } from "./lib/cell.mjs";

const browser = await openBrowser();
const cell = await Cell.start(`sensors.${SENSOR}.workspace.tray=[0.5,0.0,0.1]`, `sensors.${SENSOR}.workspace.gripper=[0.4,-0.2,0.3]`);
try {
  const page = await openPage(browser, cell.url, new Faults(), { colorScheme: "dark" });
  await part(page, "calibrate").click();
  await page.locator("dialog[open] button[value=go]").click();
  await waitUntil("the pose is valid", async () => (await part(page, "state").textContent()) === "valid", 180_000);
  await part(page, "density").selectOption("1");
  await page.getByRole("button", { name: "Fit" }).click();
  await sleep(12_000); // notices are gone
  await keep(page, "picture");
} finally {
  await browser.close();
  await cell.end();
}
