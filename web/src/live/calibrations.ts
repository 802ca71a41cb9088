// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import type { Client } from "../api/client";
import type { Calibration } from "../api/types";

/** Calibrations that have ended never change but for being current: their results are fetched once. */
export class Calibrations {
  private readonly ended = new Map<string, Calibration>();

  constructor(private readonly client: Client) {}

  async find(id: string): Promise<Calibration> {
    const known = this.ended.get(id);
    if (known) return known;
    const found = await this.client.get<Calibration>(`/api/v1/calibrations/${id}`);
    if (found.finished_at) this.ended.set(id, found);
    return found;
  }

  /** Newest first, with their results. */
  async history(sensor: string, limit: number): Promise<Calibration[]> {
    const path = `/api/v1/sensors/${encodeURIComponent(sensor)}/calibrations?limit=${limit}`;
    const page = await this.client.get<{ calibrations: Calibration[] }>(path);
    return Promise.all(
      page.calibrations.map(async (summary) => {
        if (!summary.finished_at) return summary;
        const whole = await this.find(summary.id);
        return { ...summary, result: whole.result ?? null };
      }),
    );
  }
}
