// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { type Client, explain } from "../api/client";
import type { NextPosture } from "../api/types";
import type { Calibrations } from "../live/calibrations";
import type { FrameFeed } from "../live/frame_feed";
import type { CellState } from "../live/state";
import type { Notices } from "../ui/dialog";
import type { Signal } from "../ui/signal";
import type { Heat } from "./heat";

/** What every panel has at hand. */
export interface Context {
  client: Client;
  state: CellState;
  frames: FrameFeed;
  calibrations: Calibrations;
  notices: Notices;
  /** Where the robot should go, drawn as a ghost; null: nowhere. */
  suggestion: Signal<NextPosture | null>;
  /** What the robot is painted by; null: it has its own colour. */
  heat: Signal<Heat | null>;
}

/** Does what a button is for; while it does, the button cannot be pressed again. */
export async function perform(context: Context, button: HTMLButtonElement | null, action: () => Promise<void>): Promise<void> {
  if (!context.state.isLive) return context.notices.tell("The daemon does not answer: nothing can be done until it is back.", true);
  const hadFocus = button !== null && document.activeElement === button;
  if (button) button.disabled = true;
  try {
    await action();
  } catch (failure) {
    context.notices.tell(explain(failure), true);
  } finally {
    if (button) button.disabled = false;
    if (hadFocus && document.activeElement === document.body) button.focus(); // which a disabled one cannot keep
  }
}

export function sensorPath(context: Context): string {
  return `/api/v1/sensors/${encodeURIComponent(context.state.chosen.value)}`;
}
