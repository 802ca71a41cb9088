// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { type Client, reportFault } from "../api/client";
import { type Frame, type NoFrame, readFrames } from "../api/frames";
import { Signal } from "../ui/signal";
import type { CellState } from "./state";

const RETRY_MS = 700;

export interface FrameSettings {
  /** Every step-th pixel in both directions. */
  step: number;
  rate_hz: number;
}

/** The frames of the chosen sensor, while somebody looks. */
export class FrameFeed {
  readonly frame = new Signal<Frame | null>(null);
  /** Why there is no frame; null while there is one. */
  readonly absence = new Signal<NoFrame | null>(null);
  /** performance.now() of the newest frame. */
  heardAt = 0;
  private ending: AbortController | null = null;
  private settings: FrameSettings = { step: 2, rate_hz: 10 };

  constructor(
    private readonly client: Client,
    private readonly state: CellState,
  ) {
    state.connection.follow(() => this.restart());
    state.chosen.follow(() => {
      this.frame.value = null;
      this.absence.value = null;
      this.restart();
    });
  }

  configure(settings: FrameSettings): void {
    this.settings = settings;
    this.restart();
  }

  private restart(): void {
    this.ending?.abort();
    this.ending = null;
    const sensor = this.state.chosen.value;
    if (!this.state.isLive || !sensor) return;
    this.ending = new AbortController();
    void this.follow(sensor, this.ending.signal);
  }

  private async follow(sensor: string, signal: AbortSignal): Promise<void> {
    while (!signal.aborted) {
      try {
        await readFrames(this.client, { sensor, ...this.settings }, signal, (frame) => this.take(frame));
      } catch (failure) {
        reportFault(failure); // whether the daemon is there is for the connection to say
      }
      await new Promise((resolve) => setTimeout(resolve, RETRY_MS));
    }
  }

  private take(frame: Frame | NoFrame): void {
    const isThere = !("code" in frame);
    this.absence.value = isThere ? null : frame;
    if (!isThere) return;
    this.heardAt = performance.now();
    this.frame.value = frame;
  }
}
