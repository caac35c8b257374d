// The messages between page and server: docs/records.md, "The protocol", says what each byte is.

import type { Ending, Setup } from './core';

const VERSION = 1;
const ENDINGS: Ending[] = ['goal', 'elsewhere', 'crash', 'out-of-bounds', 'time-limit', 'abandoned'];

/** A piece of a key log: the events with `from` ≤ tick < `to`, and the digests after `to` ticks. */
export interface Piece {
  from: number;
  to: number;
  events: Uint8Array;
  digests: { plant: string; decisions: string };
}

/** What the server says of itself. */
export interface Welcome {
  cohelm: string;
  format: number;
  learning: boolean;
  /** Hash of the values that learn. */
  values: string | null;
}

export type FromServer =
  | { kind: 'welcome'; about: Welcome }
  | { kind: 'begun'; episode: bigint; committed: number }
  | { kind: 'ack'; committed: number }
  | { kind: 'refused'; reason: string }
  | { kind: 'finished'; episode: bigint }
  | { kind: 'new-model'; hash: string };

export function begin(key: Uint8Array, ageMs: number, setup: Setup): Uint8Array {
  const json = new TextEncoder().encode(JSON.stringify(setup));
  const [bytes, view] = message(1, 20 + json.length);
  bytes.set(key, 2);
  view.setUint32(18, Math.min(ageMs, 0xffff_ffff), true);
  bytes.set(json, 22);
  return bytes;
}

export function chunk(piece: Piece): Uint8Array {
  const [bytes, view] = message(2, 24 + piece.events.length);
  view.setUint32(2, piece.from, true);
  view.setUint32(6, piece.to, true);
  view.setBigUint64(10, hex(piece.digests.plant), true);
  view.setBigUint64(18, hex(piece.digests.decisions), true);
  bytes.set(piece.events, 26);
  return bytes;
}

export function end(ticks: number, ending: Ending, digests: { plant: string; decisions: string }): Uint8Array {
  const [bytes, view] = message(3, 21);
  view.setUint32(2, ticks, true);
  view.setUint8(6, ENDINGS.indexOf(ending));
  view.setBigUint64(7, hex(digests.plant), true);
  view.setBigUint64(15, hex(digests.decisions), true);
  return bytes;
}

/** What the server said; null for a message of another version, or of a kind this page does not know. */
export function read(bytes: Uint8Array): FromServer | null {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (bytes.length < 2 || view.getUint8(0) !== VERSION) return null;
  const rest = bytes.subarray(2);
  const text = () => new TextDecoder().decode(rest);
  switch (view.getUint8(1)) {
    case 129:
      return { kind: 'welcome', about: JSON.parse(text()) };
    case 130:
      return { kind: 'begun', episode: view.getBigInt64(2, true), committed: view.getUint32(10, true) };
    case 131:
      return { kind: 'ack', committed: view.getUint32(2, true) };
    case 132:
      return { kind: 'refused', reason: text() };
    case 133:
      return { kind: 'finished', episode: view.getBigInt64(2, true) };
    case 134:
      return { kind: 'new-model', hash: toHex(rest) };
    default:
      return null;
  }
}

/** Bytes as hexadecimal digits. */
export function toHex(bytes: Uint8Array): string {
  return [...bytes].map((byte) => byte.toString(16).padStart(2, '0')).join('');
}

function message(kind: number, length: number): [Uint8Array, DataView] {
  const bytes = new Uint8Array(2 + length);
  bytes[0] = VERSION;
  bytes[1] = kind;
  return [bytes, new DataView(bytes.buffer)];
}

function hex(digits: string): bigint {
  return BigInt(`0x${digits}`);
}
