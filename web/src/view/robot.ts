// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { Color, Group, Matrix4, Mesh, MeshLambertMaterial } from "three";
import { STLLoader } from "three/addons/loaders/STLLoader.js";
import URDFLoader, { type URDFRobot } from "urdf-loader";
import type { Client } from "../api/client";
import { SHADE } from "./cloud";
import { METAL } from "./colours";
import { LIGHT_LEVELS, normalsOf, type Solid } from "./solid";
import { SHADES } from "./splat";

const UNNAMED = "#59626a";
/** As BEHIND_M, about 2 m away; in steps of a depth buffer of 24 bits. */
const BEHIND = { polygonOffset: true, polygonOffsetUnits: 2000 };
const GHOST = "#35c08a";

/** The robot as the daemon has it: its URDF, and of each link the surface that calibrd compares with. */
export class RobotView {
  /** In the base frame. */
  readonly group = new Group();
  /** To the processor, and of which link they are. */
  private readonly left = new Map<Solid, string>();
  private colours: ReadonlyMap<string, string> = new Map();
  private isStale = false;

  private constructor(
    private readonly robot: URDFRobot,
    private readonly jointNames: readonly string[],
    private readonly meshes: ReadonlyMap<string, Mesh>,
  ) {
    this.group.add(robot);
  }

  static async load(client: Client, base: string, jointNames: readonly string[]): Promise<RobotView> {
    const loader = new URDFLoader();
    loader.parseVisual = false; // the daemon's surfaces come instead: nothing of the URDF's paths is fetched
    loader.parseCollision = false;
    const robot = loader.parse(await (await client.fetch("/api/v1/robot/urdf")).text());
    unlimited(robot);
    const meshes = new Map<string, Mesh>();
    await Promise.all(Object.keys(robot.links).map((name) => addSurface(client, robot, name, meshes)));
    robot.updateMatrixWorld(true);
    const T_root_base = robot.links[base]?.matrixWorld ?? new Matrix4();
    const view = new RobotView(robot, jointNames, meshes);
    view.group.applyMatrix4(T_root_base.clone().invert());
    return view;
  }

  setJoints(positions: readonly number[]): void {
    this.jointNames.forEach((name, index) => this.robot.setJointValue(name, positions[index] ?? 0));
  }

  /** Each link that is named; the others are grey. Nothing named: all of them are of metal. */
  paint(colours: ReadonlyMap<string, string> = new Map()): void {
    this.colours = colours;
    for (const [name, mesh] of this.meshes) (mesh.material as MeshLambertMaterial).color = new Color(this.colourOf(name));
  }

  /** Old joints are shown as what they are. */
  setStale(isStale: boolean): void {
    if (isStale === this.isStale) return;
    this.isStale = isStale;
    this.setOpacity(isStale ? 0.35 : 1);
    for (const name of this.left.values()) this.show(name, isStale);
  }

  /** From now on the processor draws the links, as long as there are shades for them and nothing is to be seen through. */
  leaveToProcessor(): void {
    let firstShade: number = SHADE.solids;
    for (const [name, mesh] of this.meshes) {
      if (firstShade + LIGHT_LEVELS > SHADES) return;
      const corners = mesh.geometry.getAttribute("position").array as Float32Array;
      this.left.set({ corners, normals: normalsOf(corners), firstShade, T_base_link: mesh.matrixWorld }, name);
      this.show(name, this.isStale);
      firstShade += LIGHT_LEVELS;
    }
  }

  /** What the processor is to draw now. */
  get solids(): Solid[] {
    if (this.isStale) return [];
    this.group.updateMatrixWorld();
    return [...this.left.keys()];
  }

  /** Of everything that the processor draws when it is not stale. */
  get solidColours(): [Solid, string][] {
    return [...this.left].map(([solid, name]) => [solid, this.colourOf(name)]);
  }

  /** A second one, to show where the robot could be. */
  ghost(): RobotView {
    const robot = unlimited(this.robot.clone() as URDFRobot);
    const meshes = new Map<string, Mesh>();
    for (const name of this.meshes.keys()) {
      const mesh = robot.links[name]?.children.find((child): child is Mesh => child instanceof Mesh);
      if (!mesh) continue;
      mesh.material = new MeshLambertMaterial({ color: GHOST });
      mesh.visible = true; // it is seen through, which WebGL alone draws
      meshes.set(name, mesh);
    }
    const view = new RobotView(robot, this.jointNames, meshes);
    view.group.applyMatrix4(this.group.matrix);
    view.setOpacity(0.3);
    return view;
  }

  private colourOf(link: string): string {
    return this.colours.get(link) ?? (this.colours.size ? UNNAMED : METAL);
  }

  private show(link: string, isShown: boolean): void {
    const mesh = this.meshes.get(link);
    if (mesh) mesh.visible = isShown;
  }

  private setOpacity(opacity: number): void {
    for (const mesh of this.meshes.values()) {
      const material = mesh.material as MeshLambertMaterial;
      material.transparent = opacity < 1;
      material.opacity = opacity;
      material.depthWrite = opacity === 1;
      material.needsUpdate = true;
    }
  }
}

/** A joint beyond the limits of its URDF is shown where it is, as the daemon has it. */
function unlimited(robot: URDFRobot): URDFRobot {
  for (const joint of Object.values(robot.joints)) joint.ignoreLimits = true;
  return robot;
}

async function addSurface(client: Client, robot: URDFRobot, name: string, meshes: Map<string, Mesh>): Promise<void> {
  const response = await client.fetch(`/api/v1/robot/links/${encodeURIComponent(name)}/mesh`);
  const geometry = new STLLoader().parse(await response.arrayBuffer());
  if (geometry.getAttribute("position").count === 0) return;
  const mesh = new Mesh(geometry, new MeshLambertMaterial({ color: METAL, ...BEHIND }));
  robot.links[name]?.add(mesh);
  meshes.set(name, mesh);
}
