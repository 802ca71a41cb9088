// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Starts the simulated cell and the daemon, in a folder of their own, and ends them.
import { execFileSync, spawn } from "node:child_process";
import { existsSync, mkdtempSync, openSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

const SOURCE = fileURLToPath(new URL("../../..", import.meta.url));
export const BUILD = process.env.CALIBRD_BUILD ?? join(SOURCE, "build/release");
const ROBOTS = join(BUILD, "share/calibrd/robots");
const URDF = join(ROBOTS, "demo_arm7/urdf/demo_arm7.urdf");
export const SENSOR = "kinect2";

export const sleep = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds));

/** The first answer of `condition` that is true; what it throws counts as not yet. */
export async function waitUntil(what, condition, timeoutMs = 30_000, periodMs = 100) {
  const deadline = performance.now() + timeoutMs;
  let last;
  while (performance.now() < deadline) {
    last = await Promise.resolve().then(condition).catch((failure) => (last = failure, null));
    if (last) return last;
    await sleep(periodMs);
  }
  throw new Error(`waited ${timeoutMs / 1000} s for: ${what}; last answer: ${last}`);
}

function freePort() {
  return new Promise((found) => {
    const server = createServer().listen(0, "127.0.0.1", () => {
      const { port } = server.address();
      server.close(() => found(port));
    });
  });
}

/** A running program; its log lies in the cell's folder. */
class Program {
  constructor(folder, name, args, env = {}) {
    this.log = join(folder, `${name}.log`);
    const log = openSync(this.log, "a");
    this.process = spawn(join(BUILD, "bin", name), args, { cwd: folder, stdio: ["ignore", log, log], env: { ...process.env, ...env } });
    this.ended = new Promise((done) => this.process.once("exit", done));
  }

  async end(signal = "SIGTERM") {
    this.process.kill(signal);
    await this.ended;
  }

  tail() {
    return readFileSync(this.log, "utf8").slice(-2500);
  }
}

const DEMO = JSON.parse(readFileSync(join(SOURCE, "config/demo_cell/world.json"), "utf8"));

/** What the configuration says of the sensor that the simulator shows as its `at`-th. */
function ofSensor(name, at) {
  const { camera } = DEMO.sensors[0];
  const lens = ["fx", "fy", "cx", "cy", "distortion"].map((key) => `${key}=${JSON.stringify(camera[key])}`);
  return [`uri="calibrd-sim://${at}"`, `driver_directory=${join(BUILD, "lib/calibrd-sim-openni")}`, "latency=20ms", ...lens].map((setting) => `sensors.${name}.${setting}`);
}

export class Cell {
  folder = mkdtempSync(join(tmpdir(), "calibrd-page-"));
  daemon = null;

  constructor(sensors) {
    this.sensors = sensors;
  }

  /** `settings`: section.key=value. */
  static start(...settings) {
    return Cell.startWith([SENSOR], ...settings);
  }

  /** The same with several sensors of these names, where the demo has its one. */
  static async startWith(sensors, ...settings) {
    const cell = new Cell(sensors);
    try {
      await cell.begin(settings);
    } catch (failure) {
      console.error(cell.daemon?.tail() ?? "");
      await cell.end(); // a program that is left over would keep the test from ending
      throw failure;
    }
    return cell;
  }

  async begin(settings) {
    const ready = join(this.folder, "simulator.ready");
    this.world = join(this.folder, "world");
    const described = join(this.folder, "world.json");
    writeFileSync(described, JSON.stringify({ ...DEMO, sensors: this.sensors.map((id) => ({ ...DEMO.sensors[0], id })) }));
    this.simulator = new Program(this.folder, "calibrd-sim", ["run", "--world", described, "--urdf", URDF, "--models", ROBOTS, "--world-file", this.world, "--controller-port", "0", "--control-port", "0", "--ready-file", ready]);
    await waitUntil("the simulator is ready", () => existsSync(ready));
    const ports = Object.fromEntries(readFileSync(ready, "utf8").trim().split(" ").slice(1).map((word) => word.split("=")));
    this.controllerPort = ports.controller.split(":")[1];
    this.control = `http://${ports.control}`;
    await this.hurry();
    this.port = await freePort();
    this.settings = settings;
    await this.serve();
  }

  get url() {
    return `http://127.0.0.1:${this.port}`;
  }

  /** Starts the daemon, again if need be: at the same address, with the same storage. */
  async serve() {
    const settings = [`server.port=${this.port}`, `robot.port=${this.controllerPort}`, `storage.path=${join(this.folder, "calibrd.db")}`, `robot.urdf=${URDF}`, ...this.sensors.flatMap(ofSensor), ...this.settings];
    this.daemon = new Program(this.folder, "calibrd", ["serve", "--config", join(SOURCE, "config/demo.toml"), ...settings.flatMap((setting) => ["--set", setting])], { CALIBRD_SIM_WORLD: this.world });
    await waitUntil("robot and sensor are up", async () => (await fetch(`${this.url}/readyz`)).ok, 120_000);
  }

  async api(path, token = "") {
    const response = await fetch(this.url + path, token ? { headers: { Authorization: `Bearer ${token}` } } : {});
    if (!response.ok) throw new Error(`${path}: ${response.status} ${await response.text()}`);
    return response.json();
  }

  async send(method, path, body = {}) {
    const response = await fetch(this.url + path, { method, headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) });
    if (!response.ok) throw new Error(`${path}: ${response.status} ${await response.text()}`);
    return response.json();
  }

  /** Number of accepted calibrations. */
  async accepted() {
    const { calibrations } = await this.api(`/api/v1/sensors/${SENSOR}/calibrations`);
    return calibrations.filter(({ verdict }) => verdict === "accepted").length;
  }

  /** Tells the simulator. */
  async tell(method, path, body) {
    const response = await fetch(this.control + path, { method, body: JSON.stringify(body) });
    if (!response.ok) throw new Error(`${path}: ${response.status} ${await response.text()}`);
  }

  /** The robot goes from posture to posture faster than the demo's does. */
  hurry() {
    return this.tell("PUT", "/motion", { mode: "run", seed: 11, count: 12, speed_rad_s: 2.0, hold_s: 0.8 });
  }

  knock() {
    return this.tell("POST", `/sensors/${SENSOR}/knock`, { shift_m: [0.02, 0.0, 0.01], turn_deg: [0.0, 2.0, 0.0] });
  }

  /** A token of that scope, in the file that the setting server.tokens_file names. */
  static token(file, name, scope) {
    return execFileSync(join(BUILD, "bin/calibrd"), ["token", "create", name, "--scope", scope, "--tokens-file", file], { encoding: "utf8" }).trim();
  }

  static revoke(file, name) {
    execFileSync(join(BUILD, "bin/calibrd"), ["token", "revoke", name, "--tokens-file", file]);
  }

  async end() {
    for (const program of [this.daemon, this.simulator]) if (program?.process.exitCode === null) await program.end("SIGKILL");
    rmSync(this.folder, { recursive: true, force: true });
  }
}
