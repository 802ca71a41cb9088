// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import type { Client } from "../api/client";
import type { Calibration } from "../api/types";

interface Page {
  calibrations: Calibration[];
  next: string | null;
}

/** So many are asked for at once. */
const PAGE = 20;

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

  /** The newest `count`, newest first, with their results. */
  async history(sensor: string, count: number): Promise<Calibration[]> {
    let path: string | null = `/api/v1/sensors/${encodeURIComponent(sensor)}/calibrations?limit=${Math.min(count, PAGE)}`;
    const summaries: Calibration[] = [];
    while (path !== null && summaries.length < count) {
      const page: Page = await this.client.get<Page>(path);
      summaries.push(...page.calibrations);
      path = page.next;
    }
    return Promise.all(
      summaries.slice(0, count).map(async (summary) => {
        if (!summary.finished_at) return summary;
        const whole = await this.find(summary.id);
        return { ...summary, result: whole.result ?? null };
      }),
    );
  }
}
