// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { ApiProblem, type Client, reportFault } from "../api/client";
import { readEvents, type ServerEvent } from "../api/sse";
import type { Calibration, Cell, Drift, Joints, Pose, Session } from "../api/types";
import type { CellState, SensorState } from "./state";

/** The joints come 30 times a second, robot or no robot: a daemon that is silent for so long is taken for lost. */
const SILENCE_MS = 1200;
const RETRY_MS = 500;
/** Ages, checks and the drift statistic change without an event. */
const REFRESH_MS = 1000;
/** Joints may come while nothing else does: other windows of this browser can hold all connections that it grants a host. */
const REFRESH_SILENCE_MS = 4000;

/** Keeps the state of the page in step with the daemon, and says when it cannot. */
export class Connection {
  private lastEventId = "";
  private lastSign = 0;
  private lastWatch = 0;
  private lastRefresh = 0;
  private isRefreshing = false;
  /** Of the connection there is. */
  private ending: AbortController | null = null;
  private wakeUp: () => void = () => undefined;
  private readonly refreshing = new Map<string, Promise<void>>();

  constructor(
    private readonly client: Client,
    private readonly state: CellState,
  ) {
    client.onTokenWanted = (problem) => {
      this.wantToken(problem.code === "token_unknown");
    };
    document.addEventListener("visibilitychange", () => this.wakeUp());
  }

  private wantToken(isUnknown: boolean): void {
    this.state.session.value = null;
    this.state.connection.value = { kind: "token", reason: isUnknown ? "The daemon does not know this token." : "" };
    this.ending?.abort(); // what was opened with the token that is gone
  }

  /** Never returns. */
  async run(): Promise<never> {
    for (;;) {
      try {
        await this.connectOnce();
      } catch (failure) {
        reportFault(failure);
        if (!(failure instanceof ApiProblem && failure.status === 401)) this.noteLoss();
      }
      const isToken = this.state.connection.value.kind === "token";
      await this.pause(isToken || document.hidden ? null : RETRY_MS);
    }
  }

  /** A token has been entered: try again. */
  retry(): void {
    this.state.connection.value = { kind: "connecting" }; // also for a connection that is about to end
    this.wakeUp();
  }

  private pause(milliseconds: number | null): Promise<void> {
    return new Promise((resolve) => {
      this.wakeUp = resolve;
      if (milliseconds !== null) setTimeout(resolve, milliseconds);
    });
  }

  private noteLoss(): void {
    const known = this.state.connection.value;
    if (known.kind === "token" || document.hidden) return;
    if (known.kind !== "lost") this.state.connection.value = { kind: "lost", since: Date.now() };
  }

  /** Returns, or throws, when the connection has ended. A tab that nobody sees holds none. */
  private async connectOnce(): Promise<void> {
    if (document.hidden) return;
    const ending = (this.ending = new AbortController());
    const session = await this.client.get<Session>("/api/v1/session", AbortSignal.timeout(SILENCE_MS));
    if (session.scope === "open") return this.wantToken(this.client.token !== "");
    this.state.session.value = session;
    await this.refreshAll(AbortSignal.timeout(5 * SILENCE_MS));
    this.lastSign = this.lastRefresh = performance.now();
    this.state.connection.value = { kind: "live" };
    const watch = setInterval(() => this.watch(ending), 100);
    const refresh = setInterval(() => void this.refreshInTime(ending.signal), REFRESH_MS);
    try {
      await this.followEvents(ending.signal);
    } finally {
      ending.abort();
      this.state.joints.value = null; // those of another run must not pass for new
      clearInterval(watch);
      clearInterval(refresh);
      if (document.hidden) this.state.connection.value = { kind: "connecting" }; // whoever follows the state lets go as well
      else this.noteLoss();
    }
  }

  private watch(ending: AbortController): void {
    const now = performance.now();
    if (now - this.lastWatch > SILENCE_MS / 2) this.lastSign = this.lastRefresh = now; // it is this tab that was held up: what has come is not read yet
    this.lastWatch = now;
    const isSilent = now - this.lastSign > SILENCE_MS || now - this.lastRefresh > REFRESH_SILENCE_MS;
    if (document.hidden || isSilent) ending.abort();
  }

  /** One at a time: of a daemon that does not answer, or a browser without a connection left for it, none must pile up. */
  private async refreshInTime(signal: AbortSignal): Promise<void> {
    if (this.isRefreshing) return;
    this.isRefreshing = true;
    try {
      await this.refreshAll(AbortSignal.any([signal, AbortSignal.timeout(REFRESH_SILENCE_MS)]));
      this.lastRefresh = performance.now();
    } catch (failure) {
      reportFault(failure); // what a refusal or silence means is for the watch to say
    } finally {
      this.isRefreshing = false;
    }
  }

  private followEvents(signal: AbortSignal): Promise<void> {
    return readEvents(this.client, "/api/v1/events?joints=true", {
      lastId: this.lastEventId,
      signal,
      onSign: () => (this.lastSign = performance.now()),
      onEvent: (event) => this.take(event, signal),
    });
  }

  /** An event tells that something has changed, not what to trust: that is asked for. */
  private take(event: ServerEvent, signal: AbortSignal): void {
    if (event.type === "joints") return void (this.state.joints.value = JSON.parse(event.data) as Joints);
    this.lastEventId = event.id || this.lastEventId;
    if (event.type === "reset") return;
    const about = JSON.parse(event.data) as { sensor?: string; status?: string };
    if (about.sensor) void this.refreshSensor(about.sensor, signal).catch(reportFault);
    const hasEnded = event.type === "calibration" && about.status !== "collecting" && about.status !== "running";
    if (hasEnded || event.type === "pose") this.state.historyVersion.value += 1;
  }

  private async refreshAll(signal: AbortSignal): Promise<void> {
    const cell = await this.client.get<Cell>("/api/v1/cell", signal);
    await Promise.all(cell.sensors.map((sensor) => this.refreshSensor(sensor.id, signal)));
    this.dropOthers(cell);
    this.state.cell.value = cell;
    if (!cell.sensors.some((sensor) => sensor.id === this.state.chosen.value))
      this.state.chosen.value = cell.sensors[0]?.id ?? "";
  }

  /** Reloads the page where the daemon that answers is another one than the page was made for; forgets sensors that are gone. */
  private dropOthers(cell: Cell): void {
    const before = this.state.cell.value;
    if (before && identityOf(before) !== identityOf(cell)) return location.reload();
    const ids = new Set(cell.sensors.map((sensor) => sensor.id));
    const sensors = this.state.sensors.value;
    if ([...sensors.keys()].some((id) => !ids.has(id))) this.state.sensors.value = new Map([...sensors].filter(([id]) => ids.has(id)));
  }

  /** One at a time for each sensor: answers that overtake each other would show the past. */
  private refreshSensor(id: string, signal: AbortSignal): Promise<void> {
    const before = this.refreshing.get(id) ?? Promise.resolve();
    const mine = before.catch(() => undefined).then(() => this.fetchSensor(id, signal));
    this.refreshing.set(id, mine);
    return mine;
  }

  private async fetchSensor(id: string, signal: AbortSignal): Promise<void> {
    const path = `/api/v1/sensors/${encodeURIComponent(id)}`;
    const [pose, drift] = await Promise.all([
      this.fetchPose(`${path}/pose`, signal),
      this.client.get<Drift>(`${path}/drift`, signal),
    ]);
    const job = pose.job ? await this.client.get<Calibration>(`/api/v1/calibrations/${pose.job}`, signal) : null;
    const entry: SensorState = { pose, drift, job, heardAt: performance.now() };
    this.state.sensors.value = new Map(this.state.sensors.value).set(id, entry);
  }

  private async fetchPose(path: string, signal: AbortSignal): Promise<Pose> {
    const response = await this.client.fetch(path, { signal });
    const pose = (await response.json()) as Pose;
    pose.calibrated_age_s = numberOf(response.headers.get("Calibrd-Calibrated-Age-S"));
    pose.passed_check_age_s = numberOf(response.headers.get("Calibrd-Passed-Check-Age-S"));
    return pose;
  }
}

/** What the page has taken from the cell once and for all. */
function identityOf({ version, robot, sensors }: Cell): string {
  return JSON.stringify([version, robot.model, robot.base_frame, robot.joint_names, sensors.map(({ id, camera }) => [id, camera])]);
}

function numberOf(header: string | null): number | null {
  return header === null ? null : Number(header);
}
