// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// What the page computes itself, without a browser and a daemon.
import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./lib/modules.mjs";

const page = await load("view/splat", "view/solid", "view/light", "view/comparison", "view/rays", "api/frames", "panels/heat", "ui/one_at_a_time");
const { DEPTH_STEPS, EMPTY, LIGHT_LEVELS, Matrix4, PerspectiveCamera, SHADE_BITS, SHADES, Vector3 } = page;

const [WIDTH, HEIGHT] = [90, 60];
const picture = () => ({ width: WIDTH, height: HEIGHT, pixels: new Int32Array(WIDTH * HEIGHT).fill(EMPTY) });
const shadeAt = ({ pixels }, u, v) => pixels[v * WIDTH + u] & (SHADES - 1);
const depthAt = ({ pixels }, u, v) => (pixels[v * WIDTH + u] >> SHADE_BITS) / DEPTH_STEPS;

/** From `eye` at the middle of the base frame, z up. */
function view(eye) {
  const camera = new PerspectiveCamera(45, WIDTH / HEIGHT, 0.05, 50);
  camera.up.set(0, 0, 1);
  camera.position.copy(eye);
  camera.lookAt(0, 0, 0);
  camera.updateMatrixWorld();
  return new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
}

/** A square plate of 1 m in the plane x = `x`, seen from where x is larger. */
function plate(x, firstShade) {
  const corners = new Float32Array([x, -0.5, -0.5, x, 0.5, -0.5, x, 0.5, 0.5, x, -0.5, -0.5, x, 0.5, 0.5, x, -0.5, 0.5]);
  return { corners, normals: page.normalsOf(corners), firstShade, T_base_link: new Matrix4() };
}

/** One point on the x axis. */
const point = (x, shade) => ({ rays: new Float32Array(2), depth: Uint16Array.of(1000), scale: 0.001, shades: Uint8Array.of(shade), matrix: new Matrix4().makeTranslation(x, 0, -1) });

const EYE = new Vector3(3, 0, 0);
const [MIDDLE_U, MIDDLE_V] = [WIDTH / 2, HEIGHT / 2];

test("a surface is drawn where it is, as bright as the light that falls on it, and not from behind", () => {
  const front = picture();
  page.drawSolid(front, { ...plate(0, 300), T_base_link: new Matrix4().makeRotationX(0.4) }, view(EYE), EYE);
  const toSun = page.LIGHT.towardsSun.x;
  assert.equal(shadeAt(front, MIDDLE_U, MIDDLE_V), 300 + Math.round(toSun * (LIGHT_LEVELS - 1)));
  const side = (HEIGHT / 2 / Math.tan(Math.PI / 8)) / 3; // of a metre that is 3 m away, in pixels
  const covered = front.pixels.filter((value) => value !== EMPTY).length;
  assert.ok(Math.abs(covered - side ** 2) < 2 * side, `${covered} pixels, about ${side ** 2} expected: no gap, nothing twice`);
  const back = picture();
  page.drawSolid(back, plate(0, 300), view(new Vector3(-3, 0, 0)), new Vector3(-3, 0, 0));
  assert.ok(back.pixels.every((value) => value === EMPTY));
});

test("a surface that has been turned is lit from where the sun is, not from where it was", () => {
  const turned = { ...plate(0, 300), T_base_link: new Matrix4().makeRotationZ(Math.PI / 2) };
  const eye = new Vector3(0, 3, 0);
  const drawn = picture();
  page.drawSolid(drawn, turned, view(eye), eye);
  assert.equal(shadeAt(drawn, MIDDLE_U, MIDDLE_V), 300, "the sun stands at y < 0: this side is dark");
});

test("of points and surfaces the nearest is seen, whichever is drawn first; points that lie on a surface are, too", () => {
  for (const [x, wanted] of [[0.3, 4], [-0.3, 0], [0.005, 4], [-0.005, 4], [-0.02, 0]])
    for (const order of [[0, 1], [1, 0]]) {
      const drawn = picture();
      const draw = [() => page.splat(drawn, point(x, 7), view(EYE)), () => page.drawSolid(drawn, plate(0, 300), view(EYE), EYE)];
      for (const step of order) draw[step]();
      const ofPoint = drawn.pixels.filter((value) => (value & (SHADES - 1)) === 7).length;
      assert.equal(ofPoint, wanted, `pixels of a point at ${x} m`);
    }
});

test("the depth of a slanted surface is that of its points, and a little more", () => {
  const slanted = { ...plate(0, 300), T_base_link: new Matrix4().makeRotationZ(0.6).multiply(new Matrix4().makeRotationY(0.4)) };
  const drawn = picture();
  page.drawSolid(drawn, slanted, view(EYE), EYE);
  const at = new Vector3(0, 0.3, -0.2).applyMatrix4(slanted.T_base_link).add(new Vector3(-page.BEHIND_M, 0, 0)).applyMatrix4(view(EYE));
  const [u, v] = [Math.floor((at.x + 1) * 0.5 * WIDTH), Math.floor((at.y + 1) * 0.5 * HEIGHT)];
  assert.ok(Math.abs(depthAt(drawn, u, v) - (at.z + 1) / 2) < 2e-4);
});

test("what is behind whoever looks, or beside the picture, is not drawn", () => {
  const drawn = picture();
  page.drawSolid(drawn, { ...plate(-5, 300), T_base_link: new Matrix4().makeRotationZ(Math.PI) }, view(EYE), EYE); // at 5 m, facing this way
  assert.equal(page.splat(drawn, point(5, 7), view(EYE)), 0);
  const reachesBehind = new Matrix4().makeRotationZ(0.2).multiply(new Matrix4().makeRotationY(-Math.PI / 2)).setPosition(2.7, 0, -0.2); // a floor
  page.drawSolid(drawn, { ...plate(0, 300), T_base_link: reachesBehind }, view(EYE), EYE);
  assert.ok(drawn.pixels.every((value) => value === EMPTY));
});

test("the normal of a triangle points to where its corners run counter-clockwise", () => {
  assert.deepEqual([...plate(0, 300).normals], [1, 0, 0, 1, 0, 0]);
});

/** A frame of 2 × 1 pixels as the daemon writes it. */
function frameBytes(header, pixels) {
  const text = new TextEncoder().encode(JSON.stringify(header));
  const bytes = new Uint8Array(8 + text.length + pixels.length);
  const lengths = new DataView(bytes.buffer);
  lengths.setUint32(0, text.length, true);
  bytes.set(text, 4);
  lengths.setUint32(4 + text.length, pixels.length, true);
  bytes.set(pixels, 8 + text.length);
  return bytes;
}

test("frames are the same however the network cuts them", async () => {
  const header = { camera: { width: 2, height: 1 }, links: ["a"] };
  const all = [1, 2, 3].flatMap((n) => [...frameBytes(header, [n, 0, 2, 0, 3, 0, 4, 0, 0, 255, 2, 3]), ...frameBytes({ code: "no_frame" }, [])]);
  for (let size = 1; size <= all.length; ++size) {
    const body = new ReadableStream({
      start(stream) {
        for (let at = 0; at < all.length; at += size) stream.enqueue(Uint8Array.from(all.slice(at, at + size)));
        stream.close();
      },
    });
    const found = [];
    await page.readFrames({ fetch: async () => ({ body }) }, { sensor: "s", step: 1, rate_hz: 1 }, null, (frame) => found.push(frame));
    assert.deepEqual(found.map((frame) => frame.code ?? frame.depth[0]), [1, "no_frame", 2, "no_frame", 3, "no_frame"], `pieces of ${size} bytes`);
    assert.deepEqual([found[0].depth[1], found[0].predicted[0], found[0].predicted[1], found[0].link[1], found[0].seen[0]], [2, 3, 4, 255, 2]);
  }
});

test("the residual of a link is the median over its own measured pixels, and of few pixels nothing is said", () => {
  const [count, few] = [81, 5];
  const link = new Uint8Array(count + few).fill(0, 0, count).fill(1, count);
  const seen = new Uint8Array(count + few).fill(page.PIXEL.robot);
  seen.fill(page.PIXEL.unexpected, 0, 40);
  const predicted = new Uint16Array(count + few).fill(1000);
  const depth = predicted.map((value, pixel) => value + (pixel % 3) + 3);
  depth.fill(9999, 0, 40);
  const found = page.residuals({ link, seen, predicted, depth, links: ["arm", "hand"], depth_scale_m: 0.001 });
  assert.deepEqual([...found], [["arm", 0.004]]);
});

test("before and after are those of the newest accepted calibration and the one before it", () => {
  const calibration = (id, verdict) => ({ id, verdict, result: { T_base_sensor: id } });
  const history = [calibration("d", "rejected"), calibration("c", "accepted"), calibration("b", "uncertain"), calibration("a", "accepted")];
  const { before, after } = page.lastComparison(history);
  assert.deepEqual([before, after], ["a", "c"]);
  assert.equal(page.lastComparison(history.slice(2)), null, "one is no comparison");
});

test("a ray of a lens that distorts is the one that the lens puts on its pixel", () => {
  const camera = { width: 40, height: 30, fx: 30, fy: 31, cx: 19, cy: 15, distortion: [0.08, -0.2, 0.001, -0.002, 0.06] };
  const [k1, k2, p1, p2, k3] = camera.distortion;
  const rays = page.raysOf(camera);
  for (const [u, v] of [[2, 3], [19, 15], [36, 27]]) {
    const [x, y] = rays.subarray(2 * (v * camera.width + u));
    const r2 = x * x + y * y;
    const radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    const seenAt = [camera.fx * (x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)) + camera.cx, camera.fy * (y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y) + camera.cy];
    assert.ok(Math.hypot(seenAt[0] - u, seenAt[1] - v) < 0.01, `pixel ${u}, ${v}: ${seenAt}`);
  }
});

test("what is asked for while it is done is done once more, and never twice at once", async () => {
  const answers = [];
  let [begun, underWay, most] = [0, 0, 0];
  const ask = page.oneAtATime(async () => {
    begun += 1;
    most = Math.max(most, ++underWay);
    await new Promise((resolve) => answers.push(resolve));
    underWay -= 1;
  });
  const all = [ask(), ask(), ask()];
  assert.equal(begun, 1);
  answers.shift()();
  await Promise.resolve().then(() => undefined).then(() => undefined);
  assert.deepEqual([begun, most], [2, 1]);
  answers.shift()();
  await Promise.all(all);
  assert.deepEqual([begun, underWay], [2, 0]);
});
