// @vitest-environment jsdom
// An interrupted flight goes on from the exact state of its last tick.

import './canvas';
import { readFileSync } from 'node:fs';
import { beforeAll, beforeEach, describe, expect, it } from 'vitest';
import { Keeper, longer, readCommitted } from '../../jspsych-cohelm/src';
import { Core, type Setup } from '../../src/core';
import { FlightRun, type KeyLog, type KeyLogSink } from '../../src/flight';
import { Meter } from '../../src/meter';
import { eventsBefore, keyEvents } from '../../src/record';
import type { Stage } from '../../src/stage';

const SETUP: Setup = {
  task: { plant: 'flag-lander', options: {} },
  plant_version: 1,
  seed: 5,
  rule: { rule: 'hic' },
  inference: 'nearest',
  silence: 'best',
  time_scale: 1,
  values: null,
  intent: null,
  pilot: 'person',
};
const STAGE = { show() {}, note() {}, draw() {}, end() {} } as unknown as Stage;

let core: Core;
beforeAll(async () => {
  core = await Core.load(readFileSync('dist/cohelm_page.wasm'));
});

/** Holds the main engine now and then, and moves sideways; returns the log and the digests after so many ticks. */
function fly(ticks: number): KeyLog & { plant: string; decisions: string } {
  core.begin(SETUP);
  for (let tick = 0; tick < ticks; tick += 1) {
    if (tick % 20 === 5) core.key('down', 1, 20 * tick + 3.7);
    if (tick % 20 === 14) core.key('up', 1, 20 * tick + 1.2);
    if (tick === 33) core.key('down', 0, 661);
    if (tick === 41) core.key('release-all', 0, 830);
    core.tick();
  }
  return { ...core.digests(), ticks, events: eventsBefore(core.eventsFrom(0), ticks).bytes };
}

function goOn(log: KeyLog) {
  const sent: [number, number, string][] = [];
  const ended: string[] = [];
  const sink: KeyLogSink = { chunk: (from, to, _, { plant }) => sent.push([from, to, plant]) };
  const events = {
    tick: () => {},
    paused: () => {},
    ended: ({ ending }: { ending: string }) => ended.push(ending),
    failed: (error: unknown) => {
      throw error;
    },
  };
  const run = new FlightRun(core, SETUP, false, STAGE, events, sink, { plain: true, meter: new Meter() });
  run.goOnFrom(log);
  return { run, sent, ended };
}

describe('a flight that goes on', () => {
  it('has the bits of its last tick, plant and decisions', () => {
    const flown = fly(72);
    const { run } = goOn(flown);
    expect(run.ticks).toBe(72);
    expect(core.digests()).toMatchObject({ plant: flown.plant, decisions: flown.decisions });
    expect(run.log().events).toEqual(flown.events);
    run.dispose();
  });

  it('hands its log on from the first tick, in pieces that the server knows', () => {
    const half = fly(50);
    const { run, sent } = goOn(fly(72));
    expect(sent).toEqual([[0, 50, half.plant]]);
    run.dispose();
  });

  it('has released what was held when it was left', () => {
    const { run } = goOn(fly(68));
    core.tick();
    expect(keyEvents(core.eventsFrom(0)).at(-1)).toMatchObject({ tick: 68, kind: 'release-all' });
    expect(core.tick()?.asked).toEqual(goOnAsked());
    run.dispose();
  });

  /** What nobody at the keys asks for. */
  function goOnAsked() {
    const alone = core.begin(SETUP);
    expect(alone.controls.length).toBeGreaterThan(0);
    return core.tick()!.asked;
  }

  it('that had come to its end ends at once', () => {
    const { run, ended } = goOn({ ticks: 10_000, events: new Uint8Array() });
    expect(run.isOver).toBe(true);
    expect(ended.length).toBe(1);
    expect(run.log().ticks).toBe(run.ticks);
    run.dispose();
  });

  it('goes on from the same place when it is left again at once', () => {
    const flown = fly(68);
    const { run } = goOn(flown);
    const again = goOn(run.log());
    expect(core.digests().plant).toBe(flown.plant);
    expect(again.run.ticks).toBe(68);
    run.dispose();
    again.run.dispose();
  });
});

describe('the log to go on from', () => {
  const cut = (log: KeyLog, ticks: number): KeyLog => ({ ticks, events: eventsBefore(log.events, ticks).bytes });

  it('is the longer one, if both say the same', () => {
    const whole = fly(72);
    expect(longer(whole, cut(whole, 50))).toMatchObject({ source: 'page', log: { ticks: 72 } });
    expect(longer(cut(whole, 30), cut(whole, 50))).toMatchObject({ source: 'server', log: { ticks: 50 } });
    expect(longer(whole, null)).toMatchObject({ source: 'page' });
    expect(longer(null, cut(whole, 50))).toMatchObject({ source: 'server' });
    expect(longer(null, null)).toBeNull();
    expect(longer(cut(whole, 0), null)).toBeNull();
  });

  it('is the server’s where they differ: what is committed is not taken back', () => {
    const whole = fly(72);
    const other = { ticks: 72, events: whole.events.slice() };
    other.events[4]! ^= 1;
    expect(longer(other, cut(whole, 50))).toMatchObject({ source: 'server', log: { ticks: 50 } });
  });

  it('is read as the server sends it', () => {
    const setup = new TextEncoder().encode('{"seed":5}');
    const bytes = new Uint8Array(8 + setup.length + 10);
    new DataView(bytes.buffer).setUint32(0, setup.length, true);
    bytes.set(setup, 4);
    new DataView(bytes.buffer).setUint32(4 + setup.length, 75, true);
    bytes.fill(7, 8 + setup.length);
    expect(readCommitted(bytes)).toEqual({ ticks: 75, events: new Uint8Array(10).fill(7) });
  });
});

describe('the keeper', () => {
  const flight = (ticks: number, keptAt = ticks) => ({
    ticks,
    events: Uint8Array.of(1, 2, 255),
    begunAt: 1000,
    keptAt,
    measured: new Meter().soFar(0),
  });
  beforeEach(() => localStorage.clear());

  it('gives back what it was given, by its key', () => {
    new Keeper().keep('aa', flight(7));
    expect(new Keeper().kept('aa')).toEqual(flight(7));
    expect(new Keeper().kept('bb')).toBeNull();
    new Keeper().forget('aa');
    expect(new Keeper().kept('aa')).toBeNull();
  });

  it('lets the oldest go when there are too many', () => {
    const keeper = new Keeper();
    for (let i = 0; i < 25; i += 1) keeper.keep(`key-${i}`, flight(i + 1, i));
    expect(keeper.kept('key-4')).toBeNull();
    expect(keeper.kept('key-5')?.ticks).toBe(6);
    expect(keeper.kept('key-24')?.ticks).toBe(25);
  });

  it('takes what it cannot read for nothing, and does without a shelf', () => {
    localStorage.setItem('cohelm.flight.1.aa', '{"ticks": "many"}');
    expect(new Keeper().kept('aa')).toBeNull();
    const none = new Keeper(null);
    none.keep('aa', flight(1));
    expect(none.kept('aa')).toBeNull();
  });
});
