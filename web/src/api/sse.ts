// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Server-sent events read by fetch: a browser's own EventSource cannot send a token.
import type { Client } from "./client";

export interface ServerEvent {
  id: string;
  type: string;
  data: string;
}

/** WHATWG HTML, 9.2.6, as far as the daemon writes it: one line of data, lines end with LF. */
export function parseEvent(block: string): ServerEvent | null {
  const event: ServerEvent = { id: "", type: "message", data: "" };
  for (const line of block.split("\n")) {
    const colon = line.indexOf(":");
    if (colon <= 0) continue;
    const value = line.slice(colon + 1).trimStart();
    if (line.startsWith("id:")) event.id = value;
    else if (line.startsWith("event:")) event.type = value;
    else if (line.startsWith("data:")) event.data = value;
  }
  return event.data ? event : null;
}

export interface EventReader {
  lastId?: string;
  signal: AbortSignal;
  /** Something came, if only a comment. */
  onSign: () => void;
  onEvent: (event: ServerEvent) => void;
}

/** Reads events until the stream ends; throws when it breaks. */
export async function readEvents(client: Client, path: string, reader: EventReader): Promise<void> {
  const headers: Record<string, string> = reader.lastId ? { "Last-Event-ID": reader.lastId } : {};
  const response = await client.fetch(path, { headers, signal: reader.signal });
  const body = response.body?.pipeThrough(new TextDecoderStream()).getReader();
  if (!body) return;
  let text = "";
  for (;;) {
    const { done, value } = await body.read();
    if (done) return;
    reader.onSign();
    text += value;
    const blocks = text.split("\n\n");
    text = blocks.pop() ?? "";
    for (const block of blocks) {
      const event = parseEvent(block);
      if (event) reader.onEvent(event);
    }
  }
}
