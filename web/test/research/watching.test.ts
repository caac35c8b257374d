// A flight in the air, watched: what its page says is read by the bytes of the protocol, flown again with the same bits,
// and shown evenly.

import { readFileSync } from 'node:fs';
import { beforeAll, describe, expect, it } from 'vitest';
import { Core, type Setup } from '../../src/core';
import * as protocol from '../../src/protocol';
import { Following } from '../../src/research/following';
import { Playback } from '../../src/research/playback';
import { readFromPage, readKeys } from '../../src/research/wire';

const WASM = readFileSync(new URL('../../dist/cohelm_page.wasm', import.meta.url));

const SETUP: Setup = {
  task: { plant: 'point', options: {} },
  plant_version: 1,
  seed: 5,
  rule: { rule: 'misc' },
  inference: 'nearest',
  silence: 'best',
  time_scale: 1,
  values: null,
  intent: null,
  pilot: 'person',
};

let page: Core;
let desk: Core;
beforeAll(async () => {
  page = await Core.load(WASM);
  desk = await page.another();
});

/** The messages of a flight of so many ticks, a piece every twenty, and its end. */
function said(ticks: number): Uint8Array[] {
  page.begin(SETUP);
  const messages = [protocol.begin(new Uint8Array(16).fill(7), 1234, SETUP)];
  let events = 0;
  for (let tick = 0; tick < ticks; tick += 1) {
    if (tick === 5) page.key('down', 3, 100);
    if (tick === 27) page.stick([12_000, -300, 0, 0], 540);
    if (tick === 40) page.key('release-all', 0, 800);
    page.tick();
    if ((tick + 1) % 20 !== 0 && tick + 1 !== ticks) continue;
    const from = tick + 1 - ((tick % 20) + 1);
    const log = page.eventsFrom(events);
    events += readKeys(log).length;
    messages.push(protocol.chunk({ from, to: tick + 1, events: log, digests: page.digests() }));
  }
  return [...messages, protocol.end(ticks, 'abandoned', page.digests())];
}

const pieces = (messages: Uint8Array[]) =>
  messages.flatMap((bytes) => {
    const message = readFromPage(bytes);
    return message?.kind === 'chunk' ? [message.piece] : [];
  });

describe('what a page says', () => {
  it('is read as it was written', () => {
    const messages = said(50);
    expect(readFromPage(messages[0]!)).toEqual({ kind: 'begin', key: '07'.repeat(16), ageMs: 1234, setup: SETUP });
    expect(readFromPage(messages.at(-1)!)).toEqual({ kind: 'end', ticks: 50, ending: 'abandoned' });
    const keys = pieces(messages).flatMap(({ events }) => readKeys(events));
    expect(keys).toEqual([
      { tick: 5, atMs: 100, kind: 'down', control: 3 },
      { tick: 27, atMs: 540, kind: 'stick', axes: [12_000, -300, 0, 0] },
      { tick: 40, atMs: 800, kind: 'release-all', control: 0 },
    ]);
  });

  it('in another version or of another kind is passed over', () => {
    expect(readFromPage(Uint8Array.of(9, 1))).toBeNull();
    expect(readFromPage(Uint8Array.of(1, 99))).toBeNull();
    expect(readFromPage(new Uint8Array())).toBeNull();
  });
});

describe('a flight that is followed', () => {
  it('has the same bits, whatever comes twice or overlaps', () => {
    const [first, second, third] = pieces(said(60)) as [protocol.Piece, protocol.Piece, protocol.Piece];
    const following = new Following(desk, SETUP);
    for (const piece of [first, first, second, third, second]) {
      if (piece.to > following.ticks.length) following.take(piece);
    }
    expect(following.exact).toBe(true);
    expect(desk.digests()).toEqual({ ticks: 60, ...third.digests });
    expect(following.history.outcomes.length).toBe(60);
    expect(following.posesAt(0)).toEqual(following.opening.poses);
    expect(following.posesAt(60)).toEqual(following.ticks[59]!.poses);
  });

  it('says so when the bits differ, and refuses a gap', () => {
    const [first, , third] = pieces(said(60)) as [protocol.Piece, protocol.Piece, protocol.Piece];
    const following = new Following(desk, SETUP);
    expect(() => following.take(third)).toThrow('ticks 0 to 40 of the flight are missing');
    following.take({ ...first, digests: { ...first.digests, decisions: '0'.repeat(16) } });
    expect(following.exact).toBe(false);
  });
});

describe('the picture of a live flight', () => {
  /** Where it stands at each of these times, ms, if pieces of a second arrive then; looked at 60 times a second. */
  function shown(arrivals: [ms: number, head: number][], until: number): { place: number; at: number }[] {
    const playback = new Playback(50);
    const places = [];
    for (let at = 0; at <= until; at += 1000 / 60) {
      while (arrivals.length > 0 && arrivals[0]![0] <= at) playback.arrived(arrivals.shift()![1], at);
      places.push({ at, place: playback.at(at) });
    }
    return places;
  }

  it('moves evenly though the log comes in pieces, 1 to 1.5 s behind', () => {
    const late = [0, 60, 10, 90, 30, 0, 120, 20, 40, 0];
    const places = shown(
      late.map((ms, i) => [1000 * (i + 1) + ms, 50 * (i + 1)]),
      10_900,
    );
    for (const { at, place } of places.filter(({ at }) => at > 4000)) {
      expect(at / 1000 - place / 50).toBeGreaterThan(1);
      expect(at / 1000 - place / 50).toBeLessThan(1.5);
    }
    const steps = places.slice(1).map(({ place }, i) => place - places[i]!.place);
    expect(Math.max(...steps)).toBeLessThan(1.25 * (50 / 60) + 1e-9);
    expect(Math.min(...steps.slice(250))).toBeGreaterThan(0);
  });

  it('never goes beyond what is there, never backwards, and waits through a pause', () => {
    const places = shown(
      [
        [1000, 50],
        [2000, 100],
        [8000, 150],
        [9000, 200],
      ],
      9900,
    );
    const at = (ms: number) => places.filter((place) => place.at <= ms).at(-1)!.place;
    expect([at(4000), at(7900)]).toEqual([100, 100]);
    expect(at(9200)).toBeGreaterThan(110);
    places.slice(1).forEach(({ place }, i) => expect(place).toBeGreaterThanOrEqual(places[i]!.place));
    expect(at(9900)).toBeLessThanOrEqual(200);
  });

  it('begins near the present for who comes late, and jumps rather than rush', () => {
    expect(shown([[0, 900]], 20)[1]!.place).toBeGreaterThanOrEqual(849);
    const playback = new Playback(50);
    playback.arrived(50, 0);
    playback.at(0);
    playback.arrived(1050, 100);
    playback.at(100);
    expect(playback.at(120)).toBeGreaterThan(900);
  });

  it('shows the end to its last tick', () => {
    const playback = new Playback(50);
    playback.arrived(50, 0);
    playback.ended();
    let now = 0;
    for (; !playback.isDone && now < 5000; now += 20) playback.at(now);
    expect(playback.at(now)).toBe(50);
    expect(playback.waits).toBe(false);
  });
});
