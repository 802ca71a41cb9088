// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { Vector3 } from "three";
import { explain } from "../api/client";
import { h } from "../ui/dom";
import { Cloud, type Look, SHADE } from "../view/cloud";
import { CloudPicture } from "../view/cloud_picture";
import { DIVERGING, rgbOf, TURBO } from "../view/colours";
import { Frustum } from "../view/frustum";
import { between, matrixOf } from "../view/matrix";
import { RobotView } from "../view/robot";
import { CellScene } from "../view/scene";
import type { Comparison } from "../view/comparison";
import type { Context } from "./context";

const TRUST_COLOURS = { valid: "#1fa971", doubtful: "#e0a100", wrong: "#d6334a" } as const;
const VIRTUAL = rgbOf("#c04bd8");
const BEFORE = rgbOf("#f0852d");
const AFTER = rgbOf("#1fa971");

/** A model that could not be shown is asked for again after so long. */
const RELOAD_MS = 30_000;

/** The cell in three dimensions. */
export class CellView {
  private readonly measured = new Cloud("depth");
  private readonly predicted = new Cloud("virtual");
  private readonly compared = new Cloud("robot");
  private readonly clouds = [this.measured, this.predicted, this.compared];
  private readonly points = new CloudPicture(this.clouds);
  private readonly frusta = new Map<string, Frustum>();
  private robot: RobotView | null = null;
  private ghost: RobotView | null = null;
  private isLoading = false;
  private nextLoad = 0;
  private comparison: Comparison | null = null;
  private share = 1;

  /** Throws where there is no WebGL. */
  constructor(
    private readonly context: Context,
    private readonly canvas: HTMLCanvasElement,
    private readonly picture = new CellScene(canvas),
  ) {
    picture.scene.add(this.points);
    this.points.paint(SHADE.virtual, VIRTUAL);
    picture.beforeDraw = (camera, width, height) => {
      this.points.refresh(camera, width, height);
      canvas.dataset["points"] = String(this.points.drawn);
    };
    this.follow();
  }

  /** Pictures drawn so far, for who measures. */
  get drawn(): number {
    return this.picture.drawn;
  }

  set look(look: Look) {
    this.measured.look = look;
    this.points.ramp = look === "residual" ? DIVERGING : TURBO;
    this.drawClouds();
  }

  show(what: "measured" | "predicted", isShown: boolean): void {
    this[what].visible = isShown;
    this.drawClouds();
  }

  /** Before (0) and after (1) a calibration; null: neither. */
  compare(comparison: Comparison | null, share: number): void {
    this.comparison = comparison;
    this.share = share;
    this.placeClouds();
  }

  fit(): void {
    this.picture.fit([...(this.robot ? [this.robot.group] : []), ...this.frusta.values()]);
  }

  lookFrom(side: "front" | "side" | "top"): void {
    const from = { front: new Vector3(3, 0, 0.8), side: new Vector3(0.2, -3, 0.8), top: new Vector3(0.2, -0.001, 3.6) }[side];
    this.picture.look(from, new Vector3(0.2, 0, 0.4));
  }

  /** From where the sensor is, up as its pictures have it. */
  lookFromSensor(): void {
    const T_base_sensor = this.context.frames.frame.value?.T_base_sensor;
    if (!T_base_sensor) return;
    const matrix = matrixOf(T_base_sensor);
    const up = new Vector3(0, -1, 0).transformDirection(matrix);
    this.picture.look(new Vector3(0, 0, 0).applyMatrix4(matrix), new Vector3(0, 0, 1.2).applyMatrix4(matrix), up);
  }

  private follow(): void {
    const { state, frames, suggestion, heat } = this.context;
    state.cell.follow(() => void this.loadRobot());
    state.joints.follow(() => this.placeRobot());
    state.connection.follow(() => this.placeRobot());
    state.sensors.follow(() => this.placeFrusta());
    setInterval(() => this.placeFrusta(), 1000); // silence, too, is news
    frames.frame.follow(() => this.takeFrame());
    suggestion.follow(() => this.placeGhost());
    heat.follow((paint) => {
      this.robot?.paint(paint?.colours);
      this.paintRobot();
    });
  }

  private async loadRobot(): Promise<void> {
    const robot = this.context.state.cell.value?.robot;
    if (!robot || this.robot || this.isLoading || performance.now() < this.nextLoad) return;
    this.isLoading = true;
    this.nextLoad = performance.now() + RELOAD_MS;
    try {
      this.robot = await RobotView.load(this.context.client, robot.base_frame, robot.joint_names);
      if (this.picture.isSoftware) this.robot.leaveToProcessor();
      this.robot.paint(this.context.heat.value?.colours);
      this.paintRobot();
      this.picture.scene.add(this.robot.group);
      this.placeRobot();
      this.fit();
      this.canvas.dataset["robot"] = "shown";
    } catch (failure) {
      this.context.notices.tell(`The robot's model could not be shown: ${explain(failure)}`, true);
    }
    this.isLoading = false;
  }

  private placeRobot(): void {
    const { joints, isLive } = { joints: this.context.state.joints.value, isLive: this.context.state.isLive };
    if (!this.robot) return;
    if (joints?.positions_rad) this.robot.setJoints(joints.positions_rad);
    this.robot.setStale(!isLive || !joints?.positions_rad || joints.stale || joints.frozen);
    this.drawRobot();
  }

  private drawRobot(): void {
    this.points.solids = this.robot?.solids ?? [];
    this.points.touchSolids();
    this.picture.draw();
  }

  private paintRobot(): void {
    for (const [solid, colour] of this.robot?.solidColours ?? []) this.points.paintSolid(solid, colour);
    this.picture.draw();
  }

  private placeGhost(): void {
    const posture = this.context.suggestion.value;
    if (this.ghost) this.picture.scene.remove(this.ghost.group);
    this.ghost = posture && this.robot ? this.robot.ghost() : null;
    if (posture && this.ghost) {
      this.ghost.setJoints(posture.positions_rad);
      this.picture.scene.add(this.ghost.group);
    }
    this.picture.draw();
  }

  private placeFrusta(): void {
    for (const [id, frustum] of this.frusta) frustum.visible &&= !!this.context.state.sensor(id);
    for (const sensor of this.context.state.cell.value?.sensors ?? []) {
      const pose = this.context.state.sensor(sensor.id)?.pose;
      const known = pose?.valid ? pose : pose?.last_known;
      let frustum = this.frusta.get(sensor.id);
      if (frustum) frustum.visible = !!known?.T_base_sensor;
      if (!pose || !known?.T_base_sensor) continue;
      if (!frustum) {
        frustum = new Frustum(sensor.camera);
        this.frusta.set(sensor.id, frustum);
        this.picture.scene.add(frustum);
      }
      const trust = pose.valid && !this.context.state.isOld(sensor.id) ? "valid" : pose.state === "drifted" ? "wrong" : "doubtful";
      frustum.place(known.T_base_sensor, TRUST_COLOURS[trust]);
    }
    this.picture.draw();
  }

  private takeFrame(): void {
    const frame = this.context.frames.frame.value;
    if (!frame) return this.placeClouds();
    for (const cloud of this.clouds) cloud.take(frame);
    this.placeClouds();
  }

  private drawClouds(): void {
    this.points.touch();
    this.picture.draw();
  }

  /** Without a pose there is no place in the cell where the points could be shown. */
  private placeClouds(): void {
    const pose = this.context.frames.frame.value?.T_base_sensor;
    const compared = this.comparison;
    this.compared.visible = !!compared && !!pose;
    if (compared) {
      const place = between(matrixOf(compared.before), matrixOf(compared.after), this.share);
      this.compared.matrix.copy(place);
      const mixed = BEFORE.map((part, at) => part + this.share * ((AFTER[at] ?? 0) - part)) as [number, number, number];
      this.points.paint(SHADE.robot, mixed);
    }
    for (const cloud of [this.measured, this.predicted]) if (pose) cloud.matrix.copy(matrixOf(pose));
    if (!pose) this.measured.visible = this.predicted.visible = false;
    this.drawClouds();
  }
}

/** Where there is no WebGL: everything but this view works. */
export function withoutView(failure: unknown): HTMLElement {
  return h(
    "p",
    { class: "no-webgl", "data-test": "no-webgl" },
    `This browser shows no 3D view (${explain(failure)}). Everything else works: the sensor's eye, trust, actions, history and poses.`,
  );
}
