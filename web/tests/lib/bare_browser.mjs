// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// A Chromium with one page, spoken to in its own protocol (Chrome DevTools Protocol over a pipe) and watched by nothing: what
// Playwright sees of a page it has Chromium write down, some 200 bytes for every request and never less, in the heap of that page.
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { EXECUTABLE, FLAGS } from "./browser.mjs";

export class BareBrowser {
  #folder = mkdtempSync(join(tmpdir(), "calibrd-chromium-"));
  #asked = new Map();
  #unread = "";
  #session;

  /** Opens the page and waits for nothing. */
  static async open(url) {
    const browser = new BareBrowser();
    try {
      const { targetId } = await browser.send("Target.createTarget", { url });
      const { sessionId } = await browser.send("Target.attachToTarget", { targetId, flatten: true });
      browser.#session = sessionId;
      return browser;
    } catch (failure) {
      await browser.close();
      throw failure;
    }
  }

  constructor() {
    const flags = [...FLAGS, "--headless=new", "--remote-debugging-pipe", `--user-data-dir=${this.#folder}`, "--window-size=1280,720"];
    this.process = spawn(EXECUTABLE, flags, { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
    this.ended = new Promise((done) => this.process.once("exit", done));
    this.process.stdio[4].setEncoding("utf8").on("data", (piece) => this.#take(piece));
  }

  /** To the page, once there is one. */
  send(method, params = {}) {
    const id = this.#asked.size + 1;
    this.process.stdio[3].write(`${JSON.stringify({ id, method, params, sessionId: this.#session })}\0`);
    return new Promise((answered, failed) => this.#asked.set(id, { method, answered, failed }));
  }

  async evaluate(expression) {
    const { result, exceptionDetails } = await this.send("Runtime.evaluate", { expression, awaitPromise: true, returnByValue: true });
    if (exceptionDetails) throw new Error(`${expression}: ${exceptionDetails.exception?.description ?? exceptionDetails.text}`);
    return result.value;
  }

  async close() {
    this.process.kill("SIGKILL");
    await this.ended;
    rmSync(this.#folder, { recursive: true, force: true, maxRetries: 10, retryDelay: 100 }); // its helpers go after it
  }

  #take(piece) {
    const messages = (this.#unread + piece).split("\0");
    this.#unread = messages.pop();
    for (const { id, result, error } of messages.map((message) => JSON.parse(message))) {
      const { method, answered, failed } = this.#asked.get(id) ?? {};
      if (error) failed?.(new Error(`${method}: ${error.message}`));
      else answered?.(result);
    }
  }
}
