// What a watched page said to the server, as the server passes it on: docs/records.md, "The protocol", says what each
// byte is.

import type { Ending, Setup } from '../core';
import { toHex, type Piece } from '../protocol';

const VERSION = 1;
const ENDINGS: Ending[] = ['goal', 'elsewhere', 'crash', 'out-of-bounds', 'time-limit', 'abandoned'];

export type FromPage =
  | { kind: 'begin'; key: string; ageMs: number; setup: Setup }
  | { kind: 'chunk'; piece: Piece }
  | { kind: 'end'; ticks: number; ending: Ending };

/** What the page said; null for a message of another version, or of a kind that this page does not know. */
export function readFromPage(bytes: Uint8Array): FromPage | null {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (bytes.length < 2 || view.getUint8(0) !== VERSION) return null;
  const digest = (at: number) => view.getBigUint64(at, true).toString(16).padStart(16, '0');
  switch (view.getUint8(1)) {
    case 1:
      return {
        kind: 'begin',
        key: toHex(bytes.subarray(2, 18)),
        ageMs: view.getUint32(18, true),
        setup: JSON.parse(new TextDecoder().decode(bytes.subarray(22))) as Setup,
      };
    case 2:
      return {
        kind: 'chunk',
        piece: {
          from: view.getUint32(2, true),
          to: view.getUint32(6, true),
          digests: { plant: digest(10), decisions: digest(18) },
          events: bytes.slice(26),
        },
      };
    case 3:
      return { kind: 'end', ticks: view.getUint32(2, true), ending: ENDINGS[view.getUint8(6)] ?? 'abandoned' };
    default:
      return null;
  }
}

/** A change to the controls, and before which tick it takes effect. */
export type LoggedKey = { tick: number; atMs: number } & (
  { kind: 'down' | 'up' | 'release-all'; control: number } | { kind: 'stick'; axes: [number, number, number, number] }
);

/** The events of a key log. */
export function readKeys(log: Uint8Array): LoggedKey[] {
  const view = new DataView(log.buffer, log.byteOffset, log.byteLength);
  const keys: LoggedKey[] = [];
  for (let at = 0; at + 10 <= log.length;) {
    const when = { tick: view.getUint32(at, true), atMs: view.getFloat32(at + 4, true) };
    const kind = view.getUint8(at + 8);
    if (kind === 3) {
      const axis = (i: number) => view.getInt16(at + 10 + 2 * i, true);
      keys.push({ ...when, kind: 'stick', axes: [axis(0), axis(1), axis(2), axis(3)] });
      at += 18;
    } else {
      const name = (['down', 'up', 'release-all'] as const)[kind];
      if (name !== undefined) keys.push({ ...when, kind: name, control: view.getUint8(at + 9) });
      at += 10;
    }
  }
  return keys;
}
