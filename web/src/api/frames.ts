// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// The stream of frames: docs/api.md says how its bytes lie.
import type { Client } from "./client";
import type { Camera, Matrix4 } from "./types";

export interface Frame {
  camera: Camera;
  depth_scale_m: number;
  age_s: number;
  joint_positions_rad: number[];
  T_base_sensor: Matrix4 | null;
  pose_valid: boolean;
  links: string[];
  /** In units of depth_scale_m; 0: none. Row-major, as all that follow. */
  depth: Uint16Array;
  /** What the robot would be measured at. */
  predicted: Uint16Array;
  /** Index into `links`; NO_LINK: no robot is predicted there. */
  link: Uint8Array;
  /** Values of PIXEL. */
  seen: Uint8Array;
}

export const NO_LINK = 255;
export const PIXEL = { nothing: 0, unknown: 1, robot: 2, background: 3, unexpected: 4 } as const;

/** No frame now, and why. */
export interface NoFrame {
  code: string;
  title: string;
  detail: string;
}

/** Bytes that come in pieces, as the parts they are made of: a length (4 bytes, little-endian) and so many bytes. */
class Parts {
  private pieces: Uint8Array[] = [];
  private size = 0;
  /** So many bytes must have come before there can be more parts: pieces are joined once, not with every one that comes. */
  private wanted = 4;

  push(piece: Uint8Array): void {
    this.pieces.push(piece);
    this.size += piece.length;
  }

  /** The next two parts; null until both are there. */
  nextPair(): [Uint8Array, Uint8Array] | null {
    if (this.size < this.wanted) return null;
    const bytes = this.joined();
    const lengths = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    const first = lengths.getUint32(0, true);
    this.wanted = 8 + first;
    if (bytes.length < this.wanted) return null;
    const end = this.wanted + lengths.getUint32(4 + first, true);
    this.wanted = end;
    if (bytes.length < end) return null;
    this.pieces = [bytes.subarray(end)];
    this.size = bytes.length - end;
    this.wanted = 4;
    return [bytes.subarray(4, 4 + first), bytes.slice(8 + first, end)];
  }

  private joined(): Uint8Array {
    const [only, ...others] = this.pieces;
    if (only && others.length === 0) return only;
    const bytes = new Uint8Array(this.size);
    let at = 0;
    for (const piece of this.pieces) {
      bytes.set(piece, at);
      at += piece.length;
    }
    this.pieces = [bytes];
    return bytes;
  }
}

/** `pixels` starts at an even address: it is a copy of its own. */
function frameOf(header: Uint8Array, pixels: Uint8Array): Frame | NoFrame {
  const told = JSON.parse(new TextDecoder().decode(header)) as Frame | NoFrame;
  if ("code" in told) return told;
  const count = told.camera.width * told.camera.height;
  if (pixels.length !== 6 * count) throw new Error(`a frame of ${pixels.length} bytes, ${6 * count} expected`);
  told.depth = new Uint16Array(pixels.buffer, 0, count);
  told.predicted = new Uint16Array(pixels.buffer, 2 * count, count);
  told.link = pixels.subarray(4 * count, 5 * count);
  told.seen = pixels.subarray(5 * count);
  return told;
}

export interface FramesWanted {
  sensor: string;
  step: number;
  rate_hz: number;
}

/** Reads frames until aborted; throws when the stream breaks. */
export async function readFrames(
  client: Client,
  wanted: FramesWanted,
  signal: AbortSignal,
  onFrame: (frame: Frame | NoFrame) => void,
): Promise<void> {
  const path = `/api/v1/sensors/${encodeURIComponent(wanted.sensor)}/frames?step=${wanted.step}&rate_hz=${wanted.rate_hz}`;
  const body = (await client.fetch(path, { signal })).body?.getReader();
  const parts = new Parts();
  while (body) {
    const { done, value } = await body.read();
    if (done) return;
    parts.push(value);
    for (let pair = parts.nextPair(); pair; pair = parts.nextPair()) onFrame(frameOf(...pair));
  }
}
