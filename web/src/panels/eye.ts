// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { h } from "../ui/dom";
import { drawEye } from "../view/eye_picture";
import type { Context } from "./context";
import type { Colouring } from "./view_panel";

/** What the sensor sees, with the outline of the robot where calibrd expects it. Needs no WebGL. */
export class Eye {
  readonly element = h("canvas", { class: "eye", role: "img", "aria-label": "Depth image of the sensor with the robot's predicted outline", "data-test": "eye" });
  private coloured: Colouring = "depth";
  private shown = false;

  constructor(private readonly context: Context) {
    context.frames.frame.follow(() => this.draw());
  }

  set colouring(colouring: Colouring) {
    this.coloured = colouring;
    this.draw();
  }

  set isShown(isShown: boolean) {
    this.shown = isShown;
    this.draw();
  }

  private draw(): void {
    const frame = this.context.frames.frame.value;
    const drawing = this.element.getContext("2d");
    if (!frame || !drawing || !this.shown) return;
    const { width, height } = frame.camera;
    if (this.element.width !== width || this.element.height !== height) Object.assign(this.element, { width, height });
    const picture = drawing.createImageData(width, height);
    drawEye(frame, this.coloured, picture);
    drawing.putImageData(picture, 0, 0);
    this.element.dataset["drawn"] = "yes";
  }
}
