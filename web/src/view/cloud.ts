// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { BufferAttribute, BufferGeometry, Color, DynamicDrawUsage, Points, ShaderMaterial, Sphere, Vector3 } from "three";
import type { Frame } from "../api/frames";
import type { Camera } from "../api/types";
import { pixelRays } from "./rays";

/** What the points of a cloud are and how they are coloured; the numbers are the shader's. */
export const LOOK = { depth: 0, residual: 1, class: 2, virtual: 3, robot: 4 } as const;
export type Look = (typeof LOOK)[keyof typeof LOOK];

/** Residuals are shown from minus to plus this. */
export const RESIDUAL_RANGE_M = 0.02;
export const DEPTH_RANGE_M: [number, number] = [0.5, 4];

/** Colours of the classes, in the order of PIXEL; told apart with any colour vision. */
export const CLASS_COLOURS = ["#000000", "#7d8790", "#2f8fe0", "#a58a63", "#e2336b"] as const;

// Depths become points on the graphics side: only what a frame holds is sent there, two bytes a pixel.
const VERTEX = /* glsl */ `
  attribute vec2 ray;
  attribute float depth, predicted, seen;
  uniform float scale, size, residualRange;
  uniform vec2 depthRange;
  uniform int look;
  uniform vec3 tint;
  uniform vec3 classes[5];
  varying vec3 colour;

  vec3 turbo(float t) { // A. Mikhailov's polynomial fit of the Turbo colour map
    const vec4 r4 = vec4(0.13572138, 4.61539260, -42.66032258, 132.13108234);
    const vec4 g4 = vec4(0.09140261, 2.19418839, 4.84296658, -14.18503333);
    const vec4 b4 = vec4(0.10667330, 12.64194608, -60.58204836, 110.36276771);
    const vec2 r2 = vec2(-152.94239396, 59.28637943);
    const vec2 g2 = vec2(4.27729857, 2.82956604);
    const vec2 b2 = vec2(-89.90310912, 27.34824973);
    vec4 v4 = vec4(1.0, t, t * t, t * t * t);
    vec2 v2 = v4.zw * v4.z;
    return vec3(dot(v4, r4) + dot(v2, r2), dot(v4, g4) + dot(v2, g2), dot(v4, b4) + dot(v2, b2));
  }
  vec3 diverging(float t) { // blue: nearer than predicted; white: as predicted; red: farther
    return t < 0.0 ? mix(vec3(0.95), vec3(0.13, 0.40, 0.90), -t) : mix(vec3(0.95), vec3(0.87, 0.17, 0.17), t);
  }
  void main() {
    bool isVirtual = look == 3;
    float raw = isVirtual ? predicted : depth;
    bool isOn = predicted > 0.0 && seen > 1.5 && seen < 2.5;
    bool isHidden = raw == 0.0 || ((look == 1 || look == 4) && !isOn);
    float z = raw * scale;
    vec4 eye = modelViewMatrix * vec4(ray * z, z, 1.0);
    gl_Position = isHidden ? vec4(2.0, 2.0, 2.0, 1.0) : projectionMatrix * eye;
    gl_PointSize = size;
    if (look == 0) colour = turbo(clamp((z - depthRange.x) / (depthRange.y - depthRange.x), 0.0, 1.0));
    else if (look == 1) colour = diverging(clamp((depth - predicted) * scale / residualRange, -1.0, 1.0));
    else if (look == 2) colour = classes[int(seen + 0.5)];
    else colour = tint;
  }
`;
const FRAGMENT = /* glsl */ `
  varying vec3 colour;
  void main() {
    gl_FragColor = vec4(colour, 1.0);
    #include <colorspace_fragment>
  }
`;

/** The pixels of one sensor as points. Several clouds of different looks share them. */
export class PixelPoints {
  readonly geometry = new BufferGeometry();
  private camera = "";
  scale = 0.001;

  take(frame: Frame): void {
    const camera = JSON.stringify(frame.camera);
    if (camera !== this.camera) this.setCamera(frame.camera);
    this.camera = camera;
    this.scale = frame.depth_scale_m;
    this.fill("depth", frame.depth);
    this.fill("predicted", frame.predicted);
    this.fill("seen", frame.seen);
  }

  private setCamera(camera: Camera): void {
    const count = camera.width * camera.height;
    this.geometry.dispose();
    this.geometry.setAttribute("ray", new BufferAttribute(pixelRays(camera), 2));
    // three.js takes the number of points from it; the shader makes the places itself.
    this.geometry.setAttribute("position", new BufferAttribute(new Float32Array(3 * count), 3));
    for (const name of ["depth", "predicted"]) this.setPlane(name, new Uint16Array(count));
    this.setPlane("seen", new Uint8Array(count));
    this.geometry.boundingSphere = new Sphere(new Vector3(0, 0, 2), 5);
  }

  private setPlane(name: string, values: Uint16Array | Uint8Array): void {
    this.geometry.setAttribute(name, new BufferAttribute(values, 1).setUsage(DynamicDrawUsage));
  }

  private fill(name: string, values: Uint16Array | Uint8Array): void {
    const attribute = this.geometry.getAttribute(name) as BufferAttribute;
    attribute.array.set(values);
    attribute.needsUpdate = true;
  }
}

/** One look at the pixels: its matrix is T_base_sensor. */
export class Cloud extends Points<BufferGeometry, ShaderMaterial> {
  constructor(
    private readonly pixels: PixelPoints,
    look: Look,
    tint = "#ffffff",
  ) {
    const uniforms = {
      scale: { value: 0.001 },
      size: { value: 2 },
      residualRange: { value: RESIDUAL_RANGE_M },
      depthRange: { value: DEPTH_RANGE_M },
      look: { value: look as number },
      tint: { value: new Color(tint) },
      classes: { value: CLASS_COLOURS.map((name) => new Color(name)) },
    };
    super(pixels.geometry, new ShaderMaterial({ vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms }));
    this.matrixAutoUpdate = false;
    this.frustumCulled = false;
    this.visible = false;
  }

  set look(look: Look) {
    this.uniform("look").value = look;
  }

  set tint(colour: Color) {
    (this.uniform("tint").value as Color).copy(colour);
  }

  refresh(): void {
    this.uniform("scale").value = this.pixels.scale;
  }

  private uniform(name: string): { value: unknown } {
    return this.material.uniforms[name] as { value: unknown };
  }
}
