// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import type { Calibration, Cell, Drift, Joints, Pose, Scope, Session } from "../api/types";
import { Signal } from "../ui/signal";

export type ConnectionState =
  | { kind: "connecting" }
  | { kind: "live" }
  | { kind: "token"; reason: string }
  | { kind: "lost"; since: number };

/** Answers of the daemon are a second old at most; older ones are shown as old. */
const STALE_MS = 2500;

/** What is known of one sensor, and when it was heard (performance.now()). */
export interface SensorState {
  pose: Pose;
  drift: Drift;
  job: Calibration | null;
  heardAt: number;
}

/** What the page shows. Written by live/connection.ts alone; what is old stays, and is shown as old. */
export class CellState {
  readonly connection = new Signal<ConnectionState>({ kind: "connecting" });
  readonly session = new Signal<Session | null>(null);
  readonly cell = new Signal<Cell | null>(null);
  readonly sensors = new Signal<ReadonlyMap<string, SensorState>>(new Map());
  readonly joints = new Signal<Joints | null>(null);
  /** Id of the sensor that is looked at. */
  readonly chosen = new Signal<string>("");
  /** Counts calibrations that have ended or taken over: the history has changed. */
  readonly historyVersion = new Signal<number>(0);

  get isLive(): boolean {
    return this.connection.value.kind === "live";
  }

  may(scope: Scope): boolean {
    const order: Scope[] = ["open", "read", "calibrate", "admin"];
    const granted = this.session.value?.scope;
    return granted !== undefined && order.indexOf(granted) >= order.indexOf(scope);
  }

  sensor(id: string): SensorState | undefined {
    return this.sensors.value.get(id);
  }

  /** What is known of it may hold no longer: nothing of it is shown as if it did, and no pose is offered. */
  isOld(id: string): boolean {
    const sensor = this.sensor(id);
    return !this.isLive || !sensor || performance.now() - sensor.heardAt > STALE_MS;
  }

  get chosenSensor(): SensorState | undefined {
    return this.sensor(this.chosen.value);
  }
}
