// The examples of docs/records.md were written by the server's code; the page must read and write the same bytes.

import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import type { Setup } from '../src/core';
import * as protocol from '../src/protocol';

const DOCUMENT = readFileSync(new URL('../../docs/records.md', import.meta.url), 'utf8');

/** Bytes of the examples by the message's name. */
const EXAMPLES = new Map(
  [...DOCUMENT.matchAll(/^(\w+), \w+ to \w+, (\d+) bytes:\n\n```text\n([\s\S]*?)\n```$/gm)].map(
    ([, name, length, dump]) => {
      const hex =
        dump!
          .split('\n')
          .map((line) => line.slice(0, 47))
          .join(' ')
          .match(/\b[0-9a-f]{2}\b/g) ?? [];
      const bytes = Uint8Array.from(hex, (pair) => Number.parseInt(pair, 16));
      if (bytes.length !== Number(length))
        throw new Error(`the example ${name} has ${bytes.length} bytes, not ${length}`);
      return [name!, bytes];
    },
  ),
);

function example(name: string): Uint8Array {
  const bytes = EXAMPLES.get(name);
  if (bytes === undefined) throw new Error(`docs/records.md has no example of ${name}`);
  return bytes;
}

const hex = (bytes: Uint8Array, at: number) =>
  new DataView(bytes.buffer, bytes.byteOffset).getBigUint64(at, true).toString(16).padStart(16, '0');

describe('what the page says', () => {
  it('is Begin, byte by byte up to the setup, which may be written otherwise', () => {
    const bytes = example('Begin');
    const setupOf = (message: Uint8Array) => JSON.parse(new TextDecoder().decode(message.subarray(22))) as Setup;
    const key = Uint8Array.from({ length: 16 }, (_, i) => i);
    const written = protocol.begin(key, 40, setupOf(bytes));
    expect(written.subarray(0, 22)).toEqual(bytes.subarray(0, 22));
    expect(setupOf(written)).toEqual(setupOf(bytes));
  });

  it('is Chunk, byte by byte', () => {
    const bytes = example('Chunk');
    const piece = {
      from: 0,
      to: 30,
      events: bytes.slice(26),
      digests: { plant: hex(bytes, 10), decisions: hex(bytes, 18) },
    };
    expect(protocol.chunk(piece)).toEqual(bytes);
  });

  it('is End, byte by byte', () => {
    const bytes = example('End');
    const digests = { plant: hex(bytes, 7), decisions: hex(bytes, 15) };
    expect(protocol.end(30, 'abandoned', digests)).toEqual(bytes);
  });
});

describe('what the server says', () => {
  it.each([
    ['Welcome', { kind: 'welcome', about: { cohelm: '0.1.0', format: 1, learning: false, values: null } }],
    ['Begun', { kind: 'begun', episode: 7n, committed: 0 }],
    ['Ack', { kind: 'ack', committed: 30 }],
    ['Refused', { kind: 'refused', reason: 'the page flies another version' }],
    ['Finished', { kind: 'finished', episode: 7n }],
    [
      'NewModel',
      { kind: 'new-model', hash: Array.from({ length: 32 }, (_, i) => i.toString(16).padStart(2, '0')).join('') },
    ],
  ])('is %s', (name, message) => {
    expect(protocol.read(example(name))).toEqual(message);
  });

  it('is nothing this page knows when version or kind are others', () => {
    expect(protocol.read(Uint8Array.of(2, 131, 0, 0, 0, 0))).toBeNull();
    expect(protocol.read(Uint8Array.of(1, 99))).toBeNull();
    expect(protocol.read(new Uint8Array())).toBeNull();
  });
});
