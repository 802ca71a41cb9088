// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { type Camera, DataTexture, GLSL3, IntType, Matrix4, Mesh, PlaneGeometry, RedIntegerFormat, ShaderMaterial, Vector3 } from "three";
import { CLASS_COLOURS, type Cloud, SHADE } from "./cloud";
import { type Ramp, rgbOf } from "./colours";
import { lit } from "./light";
import { drawSolid, LIGHT_LEVELS, type Solid } from "./solid";
import { DEPTH_STEPS, EMPTY, SHADE_BITS, SHADES, splat } from "./splat";

const VERTEX = /* glsl */ `
  out vec2 place;
  void main() {
    place = uv;
    gl_Position = vec4(position.xy, 0.0, 1.0);
  }
`;
const FRAGMENT = /* glsl */ `
  uniform highp isampler2D pixels;
  uniform sampler2D palette;
  in vec2 place;
  out vec4 colour;
  void main() {
    int value = texelFetch(pixels, ivec2(place * vec2(textureSize(pixels, 0))), 0).r;
    if (value == ${EMPTY}) discard;
    gl_FragDepth = float(value >> ${SHADE_BITS}) / ${DEPTH_STEPS}.0;
    colour = vec4(texelFetch(palette, ivec2(value & ${SHADES - 1}, 0), 0).rgb, 1.0);
  }
`;

/**
 * The clouds, and where there is no graphics card the robot's surfaces too, drawn into one picture that lies in the scene with
 * the depth of each of its pixels.
 *
 * The processor draws it: without a graphics card, which cells often have none of, WebGL takes 0.5 µs for every point and
 * 0.7 µs for every triangle, this a twentieth of it (docs/figures.md), and with one it makes no difference for points that is seen.
 */
export class CloudPicture extends Mesh<PlaneGeometry, ShaderMaterial> {
  /** Points in the picture. */
  drawn = 0;
  /** What is drawn beside the clouds. */
  solids: readonly Solid[] = [];
  /** The clouds alone, kept for while only the robot moves. */
  private points = new Int32Array();
  private pixels = pixelTexture(1, 1);
  private readonly colours = new Uint8Array(4 * SHADES);
  private readonly palette = new DataTexture(this.colours, SHADES, 1);
  private readonly T_clip_base = new Matrix4();
  private areCloudsDue = true;
  private areSolidsDue = true;

  constructor(private readonly clouds: readonly Cloud[]) {
    super(new PlaneGeometry(2, 2), new ShaderMaterial({ vertexShader: VERTEX, fragmentShader: FRAGMENT, glslVersion: GLSL3, uniforms: { pixels: { value: null }, palette: { value: null } } }));
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

  paintSolid({ firstShade }: Solid, colour: string): void {
    for (let level = 0; level < LIGHT_LEVELS; ++level) this.paint(firstShade + level, lit(colour, level / (LIGHT_LEVELS - 1)));
  }

  /** A cloud has changed. */
  touch(): void {
    this.areCloudsDue = true;
  }

  /** A solid has been moved, or others are to be drawn. */
  touchSolids(): void {
    this.areSolidsDue = true;
  }

  /** Before the scene is drawn: draws again what has changed. */
  refresh(camera: Camera, width: number, height: number): void {
    const T_clip_base = new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
    const { image } = this.pixels;
    const isSame = image.width === width && image.height === height && T_clip_base.equals(this.T_clip_base);
    if (isSame && !this.areCloudsDue && !this.areSolidsDue) return;
    this.T_clip_base.copy(T_clip_base);
    if (image.width !== width || image.height !== height) this.resize(width, height);
    if (!isSame || this.areCloudsDue) this.drawClouds(width, height);
    this.drawSolids(new Vector3().setFromMatrixPosition(camera.matrixWorld), width, height);
    this.areCloudsDue = this.areSolidsDue = false;
  }

  private resize(width: number, height: number): void {
    this.pixels.dispose();
    this.pixels = pixelTexture(width, height);
    this.uniform("pixels").value = this.pixels;
    this.points = new Int32Array(width * height);
  }

  private drawClouds(width: number, height: number): void {
    this.points.fill(EMPTY);
    this.drawn = 0;
    for (const cloud of this.clouds) {
      const splats = cloud.splats;
      if (splats) this.drawn += splat({ width, height, pixels: this.points }, splats, this.T_clip_base);
    }
  }

  private drawSolids(eye: Vector3, width: number, height: number): void {
    const pixels = this.pixels.image.data as unknown as Int32Array;
    pixels.set(this.points);
    for (const solid of this.solids) drawSolid({ width, height, pixels }, solid, this.T_clip_base, eye);
    this.pixels.needsUpdate = true;
    this.visible = this.drawn > 0 || this.solids.length > 0;
  }

  private uniform(name: string): { value: unknown } {
    return this.material.uniforms[name] as { value: unknown };
  }
}

function pixelTexture(width: number, height: number): DataTexture {
  const texture = new DataTexture(new Int32Array(width * height), width, height, RedIntegerFormat, IntType);
  texture.internalFormat = "R32I";
  return texture;
}
