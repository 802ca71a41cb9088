// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { explain } from "../api/client";
import type { Calibration } from "../api/types";
import { ask } from "../ui/dialog";
import { h, setAttribute, setText } from "../ui/dom";
import { type Context, perform, sensorPath } from "./context";

/** What can be done with the chosen sensor; what the token does not allow is not there. */
export function actionsPanel(context: Context): HTMLElement {
  const job = new JobLine(context);
  const candidate = h("div", { class: "candidate", hidden: true, "data-test": "candidate" });
  const buttons = h("div", { class: "buttons" });
  const panel = h("section", {}, job.element, candidate, buttons);
  let offered = "";
  const refresh = (): void => {
    const sensor = context.state.chosenSensor;
    job.show(sensor?.job ?? null);
    showCandidate(context, candidate, sensor?.drift.candidate ?? sensor?.pose.candidate ?? null);
    const key = `${context.state.session.value?.scope}`;
    if (key !== offered) buttons.replaceChildren(...offer(context));
    offered = key;
    for (const button of panel.querySelectorAll("button")) setAttribute(button, "aria-disabled", String(!context.state.isLive));
    buttons.querySelector("[data-test=calibrate]")?.toggleAttribute("disabled", !context.state.isLive || !!sensor?.pose.job);
  };
  context.state.sensors.follow(refresh);
  context.state.chosen.follow(refresh);
  context.state.session.follow(refresh);
  context.state.connection.follow(refresh);
  return panel;
}

function offer(context: Context): HTMLElement[] {
  const button = (name: string, title: string, action: (self: HTMLButtonElement) => Promise<void>, kind = ""): HTMLElement => {
    const self: HTMLButtonElement = h("button", { class: kind, "data-test": name, click: () => void perform(context, self, () => action(self)) }, title);
    return self;
  };
  if (!context.state.may("calibrate"))
    return [h("p", { class: "hint", "data-test": "read-only" }, "This token may look, and change nothing.")];
  const all = [
    button("calibrate", "Calibrate…", () => calibrate(context), "primary"),
    button("capture", "Record a capture…", () => capture(context)),
  ];
  if (context.state.may("admin"))
    all.push(button("bundle", "Support bundle", async () => {
      const name = await context.client.download("/api/v1/support_bundle");
      context.notices.tell(`Saved ${name}.`);
    }));
  return all;
}

async function calibrate(context: Context): Promise<void> {
  const postures = h("input", { type: "number", min: 1, max: 50, placeholder: "as configured", id: "postures" });
  const nothing = h("input", { type: "checkbox", id: "nothing" });
  const keep = h("input", { type: "checkbox", id: "keep" });
  const isWanted = await ask({
    title: `Calibrate ${context.state.chosen.value}`,
    text: "calibrd collects postures while the robot works and holds still. Only an accepted result replaces the pose.",
    action: "Start",
    fields: [
      h("label", { class: "field", for: "postures" }, "Postures", postures),
      h("label", { class: "check", for: "nothing" }, nothing, "Search from nothing, whatever is known of the pose"),
      h("label", { class: "check", for: "keep" }, keep, "Store an accepted result without serving it"),
    ],
  });
  if (!isWanted) return;
  const body: Record<string, unknown> = { activate: !keep.checked };
  if (postures.value) body["postures"] = Number(postures.value);
  if (nothing.checked) body["guess"] = null;
  const job = await context.client.send<Calibration>("POST", `${sensorPath(context)}/calibrations`, body);
  context.notices.tell(`Calibration ${job.id} has begun.`);
}

async function capture(context: Context): Promise<void> {
  const postures = h("input", { type: "number", min: 1, max: 50, value: 1, id: "capture-postures" });
  const isWanted = await ask({
    title: "Record a capture",
    text: "Depth images, joints and the robot's model as one folder, for calibrd calibrate. It waits until the robot holds still.",
    action: "Record",
    fields: [h("label", { class: "field", for: "capture-postures" }, "Postures", postures)],
  });
  if (!isWanted) return;
  const name = await context.client.download(`${sensorPath(context)}/captures`, {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify({ postures: Number(postures.value) || 1, timeout_s: 60 }),
  });
  context.notices.tell(`Saved ${name}.`);
}

const STAGES: Partial<Record<Calibration["status"], string>> = { queued: "Waiting for its turn", collecting: "Collecting:", running: "Computing" };

/** Whoever started it, here or elsewhere: how a calibration went that was shown as under way. */
async function tellEnd({ client, notices }: Context, id: string): Promise<void> {
  try {
    const { status, verdict, message, result } = await client.get<Calibration>(`/api/v1/calibrations/${id}`);
    const reasons = verdict === "accepted" ? [] : [message, ...(result?.reasons ?? []).map(({ text }) => text)];
    notices.tell([`Calibration ${id}: ${verdict ?? status}.`, ...reasons].filter(Boolean).join(" "));
  } catch (failure) {
    notices.tell(`How calibration ${id} ended is not known: ${explain(failure)}`);
  }
}

/** The calibration under way: stage, progress, cancel. */
class JobLine {
  private readonly stage = h("strong", { "data-test": "stage" });
  private readonly message = h("span", {});
  private readonly progress = h("progress", { max: 1, "aria-label": "Progress of the calibration" });
  private readonly cancel = h("button", { class: "small", "data-test": "cancel" }, "Cancel…");
  private job: Calibration | null = null;
  readonly element = h("div", { class: "job", hidden: true, "data-test": "job" }, h("div", {}, this.stage, " ", this.message), this.progress, this.cancel);

  constructor(private readonly context: Context) {
    this.cancel.addEventListener("click", () => void perform(context, this.cancel, () => this.stop()));
  }

  show(job: Calibration | null): void {
    const before = this.job;
    this.job = job;
    if (before && before.id !== job?.id && before.sensor === this.context.state.chosen.value) void tellEnd(this.context, before.id);
    this.element.hidden = job === null;
    if (!job) return;
    setText(this.stage, STAGES[job.status] ?? "");
    setText(this.message, job.message ?? "");
    this.progress.value = job.progress;
    this.cancel.hidden = !this.context.state.may("calibrate");
  }

  private async stop(): Promise<void> {
    const job = this.job;
    const text = "What has been collected is dropped. The pose being served stays what it is.";
    if (!job || !(await ask({ title: "Cancel this calibration?", text, action: "Cancel the calibration", isDestructive: true }))) return;
    await this.context.client.send("DELETE", `/api/v1/calibrations/${job.id}`);
  }
}

/** A calibration that was made after a move and waits for somebody to decide. */
function showCandidate(context: Context, place: HTMLElement, id: string | null): void {
  place.hidden = id === null;
  const isAllowed = context.state.may("calibrate"); // which a new token changes
  const key = `${id ?? ""} ${isAllowed}`;
  if (place.dataset["key"] === key) return;
  place.dataset["key"] = key;
  if (!id) return;
  const accept: HTMLButtonElement = h("button", { class: "primary", "data-test": "accept", click: () => void perform(context, accept, () => activate(context, id)) }, "Accept…");
  const reject: HTMLButtonElement = h("button", { class: "danger", "data-test": "reject", click: () => void perform(context, reject, () => decline(context, id)) }, "Reject…");
  place.replaceChildren(
    h("p", {}, `The sensor has moved. Calibration ${id} has found where it is now and waits to be accepted.`),
    ...(isAllowed ? [h("div", { class: "buttons" }, accept, reject)] : []),
  );
}

async function decline(context: Context, id: string): Promise<void> {
  const text = "The sensor stays without a valid pose; where it is now is sought again after a pause.";
  if (!(await ask({ title: "Reject this calibration?", text, action: "Reject it", isDestructive: true }))) return;
  await context.client.send("DELETE", `/api/v1/calibrations/${id}`);
  context.notices.tell(`${id} is not served.`);
}

/** Makes a calibration's pose the one being served, after asking. */
export async function activate(context: Context, id: string): Promise<void> {
  const isWanted = await ask({
    title: "Serve this pose?",
    text: `The pose of calibration ${id} replaces the one being served for sensor ${context.state.chosen.value}. It is unverified until a check against the live sensor agrees.`,
    action: "Serve it",
    isDestructive: true,
  });
  if (!isWanted) return;
  await context.client.send("POST", `/api/v1/calibrations/${id}/activate`);
  context.notices.tell(`The pose of ${id} is served.`);
}
