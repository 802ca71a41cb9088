// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import type { Client } from "../api/client";
import type { CellState } from "../live/state";
import { h, setAttribute, setText } from "../ui/dom";
import { duration } from "../ui/format";

/** The line on top: which cell, is the daemon there, who looks. */
export function heading(client: Client, state: CellState): HTMLElement {
  const cellName = h("span", { class: "cell-name" });
  const link = h("span", { class: "link", role: "status", "data-test": "connection" });
  const robot = h("span", { class: "robot", "data-test": "robot" });
  const who = h("span", { class: "who", "data-test": "who" });
  const leave = h("button", {
    class: "small",
    click: () => {
      client.token = "";
      location.reload();
    },
  }, "Forget the token");
  const refresh = (): void => {
    const { session, cell } = { session: state.session.value, cell: state.cell.value };
    setText(cellName, cell ? `${cell.robot.model} · calibrd ${cell.version}` : "");
    setText(who, session ? `${session.caller} (${session.scope})` : "");
    leave.hidden = !client.token;
    showConnection(state, link);
    showRobot(state, robot);
  };
  for (const signal of [state.connection, state.session, state.cell]) signal.follow(refresh);
  setInterval(refresh, 500);
  return h("header", { class: "top" }, h("h1", {}, "calibrd"), cellName, link, robot, h("span", { class: "gap" }), who, leave, h("a", { href: "/docs" }, "HTTP interface"));
}

function showConnection(state: CellState, place: HTMLElement): void {
  const { value } = state.connection;
  const isLost = value.kind === "lost";
  setAttribute(place, "data-connection", value.kind);
  setAttribute(document.documentElement, "data-connection", value.kind);
  setText(place, isLost ? `daemon lost ${duration((Date.now() - value.since) / 1000)} ago · trying again` : { connecting: "connecting …", live: "live", token: "token wanted", lost: "" }[value.kind]);
}

function showRobot(state: CellState, place: HTMLElement): void {
  const robot = state.cell.value?.robot;
  const joints = state.joints.value;
  const isStale = !state.isLive || !joints || joints.stale || joints.frozen;
  setAttribute(place, "data-stale", String(isStale));
  if (!robot) return setText(place, "");
  const word = joints?.frozen ? "joints frozen" : isStale ? `joints stale (${duration(joints?.age_s)})` : joints.still ? "still" : "moving";
  setText(place, `robot: ${robot.link.state === "streaming" ? word : `${robot.link.state} · ${word}`}`);
  place.title = robot.link.reason ?? "";
}
