// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { AmbientLight, AxesHelper, Box3, Color, DirectionalLight, GridHelper, Object3D, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { LIGHT } from "./light";

/** Opaque: where there is no graphics card, blending a picture that hides all behind it takes 5 ms of each. */
function contextOf(canvas: HTMLCanvasElement): WebGL2RenderingContext {
  const context = canvas.getContext("webgl2", { alpha: false, antialias: false, powerPreference: "high-performance" });
  if (!context) throw new Error("no WebGL 2");
  return context;
}

/** The 3D picture: base frame, z up, metres. Drawn only when something has changed. */
export class CellScene {
  readonly scene = new Scene();
  readonly controls: OrbitControls;
  private readonly renderer: WebGLRenderer;
  private readonly camera = new PerspectiveCamera(45, 1, 0.05, 50);
  private isDue = false;
  /** Called before a picture is drawn, with its size in CSS pixels. */
  beforeDraw: (camera: PerspectiveCamera, width: number, height: number) => void = () => undefined;
  /** Pictures drawn since the page was opened. */
  drawn = 0;

  /** Throws where there is no WebGL. */
  constructor(private readonly canvas: HTMLCanvasElement) {
    Object3D.DEFAULT_UP.set(0, 0, 1);
    this.renderer = new WebGLRenderer({ canvas, context: contextOf(canvas) });
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(2.4, -2.4, 1.8);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.target.set(0.2, 0, 0.4);
    this.controls.addEventListener("change", () => this.draw());
    this.controls.listenToKeyEvents(canvas); // arrows move, with shift they turn
    canvas.addEventListener("keydown", (event) => this.zoomBy(event.key));
    canvas.addEventListener("webglcontextrestored", () => this.draw());
    this.controls.update();
    this.addSurroundings();
    new ResizeObserver(() => this.resize()).observe(canvas);
    window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
    this.resize();
  }

  /** There is no graphics card: WebGL is a program that the processor runs. */
  get isSoftware(): boolean {
    const context = this.renderer.getContext();
    const named = context.getExtension("WEBGL_debug_renderer_info");
    const name = String(context.getParameter(named?.UNMASKED_RENDERER_WEBGL ?? context.RENDERER));
    return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
  }

  /** Soon, and once for all that changes meanwhile. */
  draw(): void {
    if (this.isDue) return;
    this.isDue = true;
    requestAnimationFrame(() => {
      this.isDue = false;
      this.scene.background = new Color(getComputedStyle(this.canvas).backgroundColor);
      this.camera.updateMatrixWorld();
      this.beforeDraw(this.camera, Math.max(1, this.canvas.clientWidth), Math.max(1, this.canvas.clientHeight));
      this.renderer.render(this.scene, this.camera);
      this.drawn += 1;
    });
  }

  /** Looks at all of `objects`, from where it looks now. */
  fit(objects: readonly Object3D[]): void {
    const box = new Box3();
    for (const object of objects) box.expandByObject(object);
    if (box.isEmpty()) return;
    const middle = box.getCenter(new Vector3());
    const radius = box.getSize(new Vector3()).length() / 2;
    const direction = this.camera.position.clone().sub(this.controls.target).normalize();
    const distance = radius / Math.sin((this.camera.fov * Math.PI) / 360);
    this.look(middle.clone().addScaledVector(direction, distance), middle);
  }

  look(from: Vector3, at: Vector3, up = new Vector3(0, 0, 1)): void {
    this.camera.up.copy(up);
    this.camera.position.copy(from);
    this.controls.target.copy(at);
    this.controls.update();
    this.draw();
  }

  private zoomBy(key: string): void {
    const factor = { "+": 0.9, "-": 1 / 0.9 }[key];
    if (factor === undefined) return;
    const { target } = this.controls;
    this.look(this.camera.position.clone().sub(target).multiplyScalar(factor).add(target), target.clone(), this.camera.up.clone());
  }

  private addSurroundings(): void {
    const grid = new GridHelper(4, 16, "#7b8794", "#7b8794");
    grid.rotation.x = Math.PI / 2; // three.js lays it out with y up
    for (const material of [grid.material].flat()) Object.assign(material, { transparent: true, opacity: 0.35 });
    const sun = new DirectionalLight("#ffffff", LIGHT.sun);
    sun.position.copy(LIGHT.towardsSun);
    this.scene.add(grid, new AxesHelper(0.3), new AmbientLight("#ffffff", LIGHT.ambient), sun);
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }
}
