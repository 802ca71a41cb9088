// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { Matrix4, Quaternion, Vector3 } from "three";
import type { Matrix4 as Rows } from "../api/types";

/** Row-major rows, as the daemon writes them, as three.js has them. */
export function matrixOf(rows: Rows): Matrix4 {
  return new Matrix4().set(...(rows.flat() as Parameters<Matrix4["set"]>));
}

/** The pose at `share` of the way from `a` to `b`: straight, and turning about one axis. */
export function between(a: Matrix4, b: Matrix4, share: number): Matrix4 {
  const [p, q] = [new Vector3(), new Vector3()];
  const [r, s] = [new Quaternion(), new Quaternion()];
  const scale = new Vector3();
  a.decompose(p, r, scale);
  b.decompose(q, s, scale);
  return new Matrix4().compose(p.lerp(q, share), r.slerp(s, share), new Vector3(1, 1, 1));
}
