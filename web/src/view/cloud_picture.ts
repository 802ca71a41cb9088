// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { type Camera, DataTexture, GLSL3, IntType, Matrix4, Mesh, PlaneGeometry, RedIntegerFormat, ShaderMaterial } from "three";
import { CLASS_COLOURS, type Cloud, SHADE } from "./cloud";
import { type Ramp, rgbOf } from "./colours";
import { DEPTH_STEPS, EMPTY, splat } from "./splat";

const VERTEX = /* glsl */ `
  out vec2 place;
  void main() {
    place = uv;
    gl_Position = vec4(position.xy, 0.0, 1.0);
  }
`;
const FRAGMENT = /* glsl */ `
  uniform highp isampler2D points;
  uniform sampler2D palette;
  in vec2 place;
  out vec4 colour;
  void main() {
    int value = texelFetch(points, ivec2(place * vec2(textureSize(points, 0))), 0).r;
    if (value == ${EMPTY}) discard;
    gl_FragDepth = float(value >> 8) / ${DEPTH_STEPS}.0;
    colour = vec4(texelFetch(palette, ivec2(value & 255, 0), 0).rgb, 1.0);
  }
`;

/**
 * The clouds, drawn into one picture that lies in the scene with the depth of each of its points.
 *
 * The points are placed by the processor: without a graphics card, which cells often have none of, WebGL takes 0.5 µs for
 * every point, this a twentieth of it (docs/figures.md), and with one it makes no difference that is seen.
 */
export class CloudPicture extends Mesh<PlaneGeometry, ShaderMaterial> {
  /** Points in the picture. */
  drawn = 0;
  private points = pointsTexture(1, 1);
  private readonly colours = new Uint8Array(4 * 256);
  private readonly palette = new DataTexture(this.colours, 256, 1);
  private readonly T_clip_base = new Matrix4();
  private isDue = true;

  constructor(private readonly clouds: readonly Cloud[]) {
    super(new PlaneGeometry(2, 2), new ShaderMaterial({ vertexShader: VERTEX, fragmentShader: FRAGMENT, glslVersion: GLSL3, uniforms: { points: { value: null }, palette: { value: null } } }));
    this.frustumCulled = false;
    this.renderOrder = -1;
    this.uniform("palette").value = this.palette;
    CLASS_COLOURS.forEach((colour, index) => this.paint(SHADE.classes + index, rgbOf(colour)));
  }

  /** The colours of depth or residual. */
  set ramp(ramp: Ramp) {
    for (let shade = SHADE.ramp as number; shade <= SHADE.rampLast; ++shade) {
      const at = 3 * Math.round((255 * (shade - SHADE.ramp)) / (SHADE.rampLast - SHADE.ramp));
      this.paint(shade, [ramp[at] ?? 0, ramp[at + 1] ?? 0, ramp[at + 2] ?? 0]);
    }
  }

  paint(shade: number, [r, g, b]: readonly [number, number, number]): void {
    this.colours.set([r, g, b, 255], 4 * shade);
    this.palette.needsUpdate = true;
  }

  /** A cloud has changed. */
  touch(): void {
    this.isDue = true;
  }

  /** Before the scene is drawn. While neither the clouds nor the view have changed, as when only the robot moves, it does nothing. */
  refresh(camera: Camera, width: number, height: number): void {
    const T_clip_base = new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
    const { image } = this.points;
    const isSame = image.width === width && image.height === height && T_clip_base.equals(this.T_clip_base);
    if (isSame && !this.isDue) return;
    this.isDue = false;
    this.T_clip_base.copy(T_clip_base);
    if (image.width !== width || image.height !== height) {
      this.points.dispose();
      this.points = pointsTexture(width, height);
    }
    this.drawClouds(width, height);
  }

  private drawClouds(width: number, height: number): void {
    const pixels = this.points.image.data as unknown as Int32Array;
    pixels.fill(EMPTY);
    this.drawn = 0;
    for (const cloud of this.clouds) {
      const splats = cloud.splats;
      if (splats) this.drawn += splat({ width, height, pixels }, splats, this.T_clip_base);
    }
    this.points.needsUpdate = true;
    this.uniform("points").value = this.points;
    this.visible = this.drawn > 0;
  }

  private uniform(name: string): { value: unknown } {
    return this.material.uniforms[name] as { value: unknown };
  }
}

function pointsTexture(width: number, height: number): DataTexture {
  const texture = new DataTexture(new Int32Array(width * height), width, height, RedIntegerFormat, IntType);
  texture.internalFormat = "R32I";
  return texture;
}
