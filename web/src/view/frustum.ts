// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { AxesHelper, BufferGeometry, Color, Float32BufferAttribute, Group, LineBasicMaterial, LineSegments } from "three";
import type { Camera, Matrix4 as Rows } from "../api/types";
import { matrixOf } from "./matrix";

/** How far in front of the sensor its field of view is drawn, m. */
const LENGTH_M = 0.6;

/** What a sensor sees, as a pyramid at its pose, with the axes of its frame. */
export class Frustum extends Group {
  private readonly lines: LineSegments<BufferGeometry, LineBasicMaterial>;

  constructor(camera: Camera) {
    super();
    this.lines = new LineSegments(edges(camera), new LineBasicMaterial());
    this.add(this.lines, new AxesHelper(0.15));
    this.matrixAutoUpdate = false;
  }

  place(T_base_sensor: Rows, colour: string): void {
    this.matrix.copy(matrixOf(T_base_sensor));
    this.matrixWorldNeedsUpdate = true;
    this.lines.material.color = new Color(colour);
  }
}

function edges(camera: Camera): BufferGeometry {
  const corner = (u: number, v: number): number[] => [
    ((u - camera.cx) / camera.fx) * LENGTH_M,
    ((v - camera.cy) / camera.fy) * LENGTH_M,
    LENGTH_M,
  ];
  const { width, height } = camera;
  const corners = [corner(0, 0), corner(width, 0), corner(width, height), corner(0, height)];
  const places: number[] = [];
  corners.forEach((from, index) => {
    places.push(0, 0, 0, ...from, ...from, ...(corners[(index + 1) % corners.length] ?? from));
  });
  return new BufferGeometry().setAttribute("position", new Float32BufferAttribute(places, 3));
}
