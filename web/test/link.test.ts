// The way to the server, against a socket that does what docs/records.md says.

import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import type { Setup } from '../src/core';
import { Link, type LinkEvents } from '../src/link';

const SETUP: Setup = {
  task: { plant: 'point', options: {} },
  plant_version: 1,
  seed: 5,
  rule: { rule: 'hic' },
  inference: 'nearest',
  time_scale: 1,
  values: null,
  intent: null,
  pilot: 'person',
};
const DIGESTS = { plant: '00000000000000aa', decisions: '00000000000000bb' };

class Socket extends EventTarget {
  static readonly OPEN = 1;
  static made: Socket[] = [];
  binaryType = '';
  readyState = 0;
  sent: Uint8Array[] = [];

  constructor(readonly address: string) {
    super();
    Socket.made.push(this);
  }

  static get last(): Socket {
    return Socket.made.at(-1)!;
  }

  send(bytes: Uint8Array): void {
    this.sent.push(bytes);
  }

  close(): void {}

  open(): void {
    this.readyState = 1;
    this.dispatchEvent(new Event('open'));
  }

  break(code = 1006, reason = ''): void {
    this.readyState = 3;
    this.dispatchEvent(Object.assign(new Event('close'), { code, reason }));
  }

  say(kind: number, ...fields: (number | bigint | string)[]): void {
    const bytes = fields.flatMap((field) => {
      if (typeof field === 'string') return [...new TextEncoder().encode(field)];
      const view = new DataView(new ArrayBuffer(typeof field === 'bigint' ? 8 : 4));
      if (typeof field === 'bigint') view.setBigInt64(0, field, true);
      else view.setUint32(0, field, true);
      return [...new Uint8Array(view.buffer)];
    });
    this.dispatchEvent(Object.assign(new Event('message'), { data: Uint8Array.of(1, kind, ...bytes).buffer }));
  }

  begun = (episode: bigint, committed: number) => this.say(130, episode, committed);
  refused = (reason: string) => this.say(132, reason);
  finished = (episode: bigint) => this.say(133, episode);

  /** The kinds of what was sent, and of chunks the ticks. */
  get told(): string[] {
    return this.sent.map((bytes) => {
      const view = new DataView(bytes.buffer);
      return {
        1: 'begin',
        2: `${view.getUint32(2, true)}-${view.getUint32(6, true)}`,
        3: `end ${view.getUint32(2, true)}`,
      }[bytes[1]!]!;
    });
  }

  get key(): string {
    return String(this.sent[0]!.subarray(2, 18));
  }
}

function start(more: Partial<LinkEvents> = {}, ...place: [null?]) {
  const heard: string[] = [];
  const events: LinkEvents = {
    state: (connected, waiting) => heard.push(`${connected ? 'on' : 'off'} ${waiting}`),
    trouble: (text) => heard.push(text),
    welcome: (about) => heard.push(`welcome ${about.values}`),
    newModel: (hash) => heard.push(`model ${hash.slice(0, 4)}`),
    stored: (episode) => heard.push(`stored ${episode}`),
    ...more,
  };
  return { link: new Link('ws://here/ws', events, ...place), heard };
}

/** A flight of so many pieces of fifty ticks. */
function fly(link: Link, pieces: number): void {
  link.begin(SETUP);
  for (let i = 0; i < pieces; i += 1) link.chunk(50 * i, 50 * (i + 1), new Uint8Array(), DIGESTS);
  link.end('crash');
}

beforeEach(() => {
  vi.useFakeTimers();
  Socket.made = [];
  const kept = new Map<string, string>();
  vi.stubGlobal('WebSocket', Socket);
  vi.stubGlobal('localStorage', {
    getItem: (name: string) => kept.get(name) ?? null,
    setItem: (name: string, value: string) => kept.set(name, value),
    removeItem: (name: string) => kept.delete(name),
  });
});

afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

describe('the link', () => {
  it('waits with the log until the server has begun, then sends it in order', () => {
    const { link, heard } = start();
    Socket.last.open();
    link.begin(SETUP);
    link.chunk(0, 50, new Uint8Array(), DIGESTS);
    expect(Socket.last.told).toEqual(['begin']);
    Socket.last.begun(7n, 0);
    link.chunk(50, 80, new Uint8Array(), DIGESTS);
    link.end('crash');
    expect(Socket.last.told).toEqual(['begin', '0-50', '50-80', 'end 80']);
    Socket.last.finished(7n);
    expect(heard.at(-1)).toBe('stored 7');
  });

  it('keeps flights of a time without a connection, and delivers them one after the other', () => {
    const { link, heard } = start();
    fly(link, 1);
    fly(link, 2);
    expect(heard.at(-1)).toBe('off 2');
    Socket.last.open();
    Socket.last.begun(1n, 0);
    expect(Socket.last.told).toEqual(['begin', '0-50', 'end 50']);
    Socket.last.finished(1n);
    Socket.last.begun(2n, 0);
    expect(Socket.last.told.slice(3)).toEqual(['begin', '0-50', '50-100', 'end 100']);
    Socket.last.finished(2n);
    expect(heard).toContain('on 0');
  });

  it('comes again after a lost connection, with the same key, from what is committed', () => {
    const { link } = start();
    Socket.last.open();
    fly(link, 3);
    Socket.last.begun(1n, 0);
    const { key } = Socket.last;
    Socket.last.break();
    vi.advanceTimersByTime(500);
    Socket.last.open();
    expect(Socket.made.length).toBe(2);
    expect(Socket.last.key).toBe(key);
    Socket.last.begun(1n, 100);
    expect(Socket.last.told).toEqual(['begin', '100-150', 'end 150']);
  });

  it('waits longer and longer between attempts, but not for ever', () => {
    start();
    for (const wait of [500, 1000, 2000, 4000, 8000, 8000]) {
      const { length } = Socket.made;
      Socket.last.break();
      vi.advanceTimersByTime(wait - 1);
      expect(Socket.made.length).toBe(length);
      vi.advanceTimersByTime(1);
      expect(Socket.made.length).toBe(length + 1);
    }
  });

  it('drops a flight that is refused, says why, and goes on with the next', () => {
    const { link, heard } = start();
    Socket.last.open();
    fly(link, 1);
    fly(link, 1);
    Socket.last.refused('there is no values model with the hash 12');
    expect(heard.at(-1)).toBe('The flight was not stored: there is no values model with the hash 12');
    expect(Socket.last.told).toEqual(['begin', 'begin']);
  });

  it('gives a flight up that breaks every connection', () => {
    const { link, heard } = start();
    fly(link, 1);
    fly(link, 1);
    for (let i = 0; i < 3; i += 1) {
      Socket.last.open();
      Socket.last.break(1002, 'the setup cannot be read');
      vi.advanceTimersByTime(8000);
    }
    expect(heard).toContain('A flight was not stored: the setup cannot be read');
    expect(heard.at(-1)).toBe('off 1');
  });

  it('keeps a flight whose server cannot write, however often', () => {
    const { link, heard } = start();
    fly(link, 1);
    for (let i = 0; i < 9; i += 1) {
      Socket.last.open();
      Socket.last.break(1011, 'the disk is full');
      vi.advanceTimersByTime(8000);
    }
    expect(heard.at(-1)).toBe('off 1');
  });

  it('forgets a flight that ended before its first tick', () => {
    const { link, heard } = start();
    fly(link, 0);
    Socket.last.open();
    expect(Socket.last.told).toEqual([]);
    expect(heard.at(-1)).toBe('on 0');
  });

  it('delivers after a reload what was flown before it', () => {
    const first = start();
    first.link.begin(SETUP);
    first.link.chunk(0, 50, Uint8Array.of(1, 2, 255), DIGESTS);
    first.link.end('goal');
    start();
    Socket.last.open();
    Socket.last.begun(3n, 0);
    expect(Socket.last.told).toEqual(['begin', '0-50', 'end 50']);
    expect([...Socket.last.sent[1]!.subarray(26)]).toEqual([1, 2, 255]);
    Socket.last.finished(3n);
    start();
    Socket.last.open();
    expect(Socket.last.told).toEqual([]);
  });

  it('passes on what the server says of itself and of new models', () => {
    const { heard } = start();
    Socket.last.open();
    Socket.last.say(129, '{"cohelm":"0.1.0","format":1,"learning":true,"values":"ab"}');
    Socket.last.say(134, 'x'.repeat(32));
    expect(heard.slice(-2)).toEqual(['welcome ab', 'model 7878']);
  });

  it('begins under a key that was given, and says which flight was stored', () => {
    const stored: string[] = [];
    const { link } = start({ stored: (episode, key) => stored.push(`${episode} ${key}`) });
    Socket.last.open();
    link.begin(SETUP, { key: new Uint8Array(16).fill(0xab), begunAt: Date.now() - 5000 });
    expect(Socket.last.key).toBe(String(new Uint8Array(16).fill(0xab)));
    expect(new DataView(Socket.last.sent[0]!.buffer).getUint32(18, true)).toBe(5000);
    link.chunk(0, 50, new Uint8Array(), DIGESTS);
    link.end('goal');
    Socket.last.begun(4n, 0);
    Socket.last.finished(4n);
    expect(stored).toEqual([`4 ${'ab'.repeat(16)}`]);
  });

  it('goes on with an unfinished flight from what is committed, whose pieces come from the first tick again', () => {
    const { link } = start();
    Socket.last.open();
    link.begin(SETUP, { key: new Uint8Array(16) });
    for (const from of [0, 50, 100]) link.chunk(from, from + 50, new Uint8Array(), DIGESTS);
    Socket.last.begun(4n, 75);
    link.chunk(150, 170, new Uint8Array(), DIGESTS);
    expect(Socket.last.told).toEqual(['begin', '50-100', '100-150', '150-170']);
  });

  it('forgets a flight that is left, without ending it', () => {
    const { link, heard } = start();
    Socket.last.open();
    link.begin(SETUP);
    link.chunk(0, 50, new Uint8Array(), DIGESTS);
    link.forget();
    Socket.last.begun(4n, 0);
    expect(Socket.last.told).toEqual(['begin']);
    expect(heard.at(-1)).toBe('on 0');
  });

  it('keeps nothing where somebody else does', () => {
    const first = start({}, null);
    fly(first.link, 1);
    start({}, null);
    Socket.last.open();
    expect(Socket.last.told).toEqual([]);
  });

  it('tells of a refusal by its key, if that is wanted', () => {
    const refused: string[] = [];
    const { link, heard } = start({ refused: (reason, key) => refused.push(`${key.slice(0, 4)} ${reason}`) });
    Socket.last.open();
    link.begin(SETUP, { key: new Uint8Array(16).fill(0x12) });
    Socket.last.refused('not your flight');
    expect(refused).toEqual(['1212 not your flight']);
    expect(heard).not.toContain('The flight was not stored: not your flight');
  });

  it.each([4001, null])('stays away once another tab took over, or it was closed (%s)', (code) => {
    const taken: boolean[] = [];
    const { link } = start({ takenOver: () => taken.push(true) });
    Socket.last.open();
    if (code === null) link.close();
    Socket.last.break(code ?? 1000);
    vi.advanceTimersByTime(60_000);
    expect(Socket.made.length).toBe(1);
    expect(taken.length).toBe(code === null ? 0 : 1);
  });
});
