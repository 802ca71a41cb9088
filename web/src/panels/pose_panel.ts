// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { explain } from "../api/client";
import { h, setText } from "../ui/dom";
import { type Context, perform, sensorPath } from "./context";
import { axesPicture } from "./axes_picture";

/** As docs/pose_formats.md lists them. */
const FORMATS = ["matrix", "quaternion", "rotvec", "ros2", "ros1", "urdf", "kuka", "fanuc", "yaskawa", "mitsubishi", "kawasaki", "abb", "ur", "halcon", "opencv"];

const PATIENCE_MS = 2000;

/** The pose as a robot controller or a library takes it, to be copied. Only a valid pose can be taken. */
export function posePanel(context: Context): HTMLElement {
  const format = h("select", { "aria-label": "Format", "data-test": "format" }, ...FORMATS.map((name) => h("option", { value: name }, name)));
  const text = h("pre", { class: "pose", tabindex: 0, "aria-label": "The pose", "data-test": "pose" });
  const refusal = h("p", { class: "error", role: "status", "data-test": "pose-refusal" });
  const frames = h("div", { class: "frames" });
  const copy: HTMLButtonElement = h("button", { class: "primary", "data-test": "copy", click: () => void perform(context, copy, () => copyText(context, text.textContent ?? "")) }, "Copy");
  const panel = h("section", {}, h("div", { class: "buttons" }, format, copy), refusal, text, frames);
  let wanted = "";
  const fetchPose = async (): Promise<void> => {
    const { state } = context;
    const sensor = state.chosenSensor;
    const key = [state.chosen.value, format.value, sensor?.pose.calibration, sensor?.pose.valid, state.isOld(state.chosen.value)].join();
    if (!sensor || key === wanted) return;
    wanted = key;
    copy.disabled = text.hidden = true; // what stands there is of another sensor, format or calibration
    const answer = await takePose(context, format.value);
    if (key !== wanted) return; // another one has been asked for meanwhile
    setText(text, answer.text);
    setText(refusal, answer.refusal);
    copy.disabled = text.hidden = !answer.text;
    if (answer.isFailure) wanted = ""; // it is asked for again with the next news of the sensor
    frames.replaceChildren(...spellOut(context, format.value));
  };
  format.addEventListener("change", () => void fetchPose());
  context.state.sensors.follow(() => void fetchPose());
  context.state.chosen.follow(() => void fetchPose());
  context.state.connection.follow(() => void fetchPose());
  setInterval(() => void fetchPose(), 500); // silence, too, is news
  return panel;
}

/** The daemon's own bytes: what is copied is what cell software would get. */
async function takePose(context: Context, format: string): Promise<{ text: string; refusal: string; isFailure?: boolean }> {
  if (context.state.isOld(context.state.chosen.value)) return { text: "", refusal: "The daemon is silent: no pose can be taken." };
  const pose = context.state.chosenSensor?.pose;
  if (!pose?.valid) return { text: "", refusal: `No pose to take: it is not valid. ${pose?.reason ?? ""}` };
  try {
    const response = await context.client.fetch(`${sensorPath(context)}/pose?format=${format}`, { signal: AbortSignal.timeout(PATIENCE_MS) });
    return { text: await response.text(), refusal: "" };
  } catch (failure) {
    return { text: "", refusal: explain(failure), isFailure: true };
  }
}

async function copyText(context: Context, text: string): Promise<void> {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    // Browsers allow it on https and on this machine alone.
    throw new Error("The browser does not allow copying here: select the text and copy it yourself.");
  }
  context.notices.tell("Copied.");
}

function spellOut(context: Context, format: string): HTMLElement[] {
  const { base_frame, sensor_frame } = context.state.chosenSensor?.pose ?? { base_frame: "", sensor_frame: "" };
  const controller = context.state.cell.value?.robot.controller_frame;
  const isController = ["kuka", "fanuc", "yaskawa", "mitsubishi", "kawasaki", "abb", "ur"].includes(format);
  const to = isController ? `${controller ?? "robot.controller_frame"} (what the controller calls its base)` : base_frame;
  const meaning = format === "opencv" ? `maps points of ${base_frame} to ${sensor_frame}: the inverse` : `maps points of ${sensor_frame} to ${to}`;
  return [
    h("p", {}, `It ${meaning}. Units stand beside the numbers.`),
    h(
      "div",
      { class: "axes" },
      h("figure", {}, axesPicture("base"), h("figcaption", {}, `${base_frame}: x red, y green, z blue, up`)),
      h("figure", {}, axesPicture("sensor"), h("figcaption", {}, `${sensor_frame}: x right, y down, z forward, into the picture`)),
    ),
  ];
}
