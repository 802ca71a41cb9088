// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// What is in a picture of a page.
import { inflateSync } from "node:zlib";

/** How many pixels of an element `is(red, green, blue)` holds for, each 0 to 255, without what lies over it. */
export async function countPixels(page, element, is) {
  const cover = (visibility) => page.locator(".legend, .frame-status").evaluateAll((all, value) => all.forEach((one) => (one.style.visibility = value)), visibility);
  await cover("hidden");
  const { rows, channels } = decode(await element.screenshot());
  await cover("");
  let count = 0;
  for (const row of rows) for (let at = 0; at < row.length; at += channels) if (is(row[at], row[at + 1], row[at + 2])) ++count;
  return count;
}

/** Of a PNG as Chromium writes it: 8 bits of RGB or RGBA, not interlaced. (A browser's own decoder would need a tab, and ours would go to sleep behind it.) */
export function decode(png) {
  const chunks = [];
  for (let at = 8; at < png.length; at += 12 + png.readUInt32BE(at))
    if (png.toString("latin1", at + 4, at + 8) === "IDAT") chunks.push(png.subarray(at + 8, at + 8 + png.readUInt32BE(at)));
  const width = png.readUInt32BE(16);
  const channels = { 2: 3, 6: 4 }[png[25]];
  const bytes = inflateSync(Buffer.concat(chunks));
  const rows = [];
  for (let at = 0; at < bytes.length; at += 1 + channels * width)
    rows.push(unfilter(bytes[at], bytes.subarray(at + 1, at + 1 + channels * width), rows.at(-1), channels));
  return { rows, channels };
}

/** PNG specification, 9: each byte is told by its difference to what is left of it, above it, or both. */
function unfilter(filter, row, above, channels) {
  for (let at = 0; at < row.length; ++at) {
    const left = at < channels ? 0 : row[at - channels];
    const up = above?.[at] ?? 0;
    const corner = at < channels ? 0 : (above?.[at - channels] ?? 0);
    row[at] += [0, left, up, (left + up) >> 1, filter === 4 ? paeth(left, up, corner) : 0][filter];
  }
  return row;
}

function paeth(left, up, corner) {
  const [toLeft, toUp, toCorner] = [Math.abs(up - corner), Math.abs(left - corner), Math.abs(left + up - 2 * corner)];
  if (toLeft <= toUp && toLeft <= toCorner) return left;
  return toUp <= toCorner ? up : corner;
}
