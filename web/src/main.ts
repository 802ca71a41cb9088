// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import "uplot/dist/uPlot.min.css";
import "./style.css";
import { Client } from "./api/client";
import type { NextPosture } from "./api/types";
import { Calibrations } from "./live/calibrations";
import { Connection } from "./live/connection";
import { FrameFeed } from "./live/frame_feed";
import { CellState } from "./live/state";
import { actionsPanel } from "./panels/actions";
import type { Context } from "./panels/context";
import { heading } from "./panels/heading";
import { DriftPanel } from "./panels/drift_panel";
import type { Heat } from "./panels/heat";
import { HistoryPanel } from "./panels/history";
import { followTokens } from "./panels/login";
import { posePanel } from "./panels/pose_panel";
import { suggestionPanel } from "./panels/suggestion";
import { trustPanel } from "./panels/trust";
import { viewPanel } from "./panels/view_panel";
import { Notices } from "./ui/dialog";
import { h } from "./ui/dom";
import { Signal } from "./ui/signal";
import { tabs } from "./ui/tabs";

function start(place: HTMLElement): void {
  const client = new Client();
  const state = new CellState();
  const connection = new Connection(client, state);
  const context: Context = {
    client,
    state,
    frames: new FrameFeed(client, state),
    calibrations: new Calibrations(client),
    notices: new Notices(),
    suggestion: new Signal<NextPosture | null>(null),
    heat: new Signal<Heat | null>(null),
  };
  const side = h("aside", { class: "side", "aria-label": "Sensors and what can be done" }, trustPanel(context), suggestionPanel(context), panels(context));
  place.append(heading(client, state), h("main", {}, viewPanel(context), side), context.notices.element);
  followTokens(client, state, connection);
  void connection.run();
}

function panels(context: Context): HTMLElement {
  const drift = new DriftPanel(context);
  const history = new HistoryPanel(context);
  return tabs("What can be done", [
    { id: "act", title: "Act", panel: actionsPanel(context) },
    { id: "history", title: "History", panel: history.element, onShow: () => history.resize() },
    { id: "drift", title: "Drift", panel: drift.element, onShow: () => drift.resize() },
    { id: "pose", title: "Take the pose", panel: posePanel(context) },
  ]);
}

const place = document.getElementById("app");
if (place) start(place);
