// The loop itself, as it is built, in Node: what the page believes of it must be so.

import { readFileSync } from 'node:fs';
import { beforeAll, describe, expect, it } from 'vitest';
import type { ModelEntry } from '../src/api';
import { Core, CoreError, CoreStopped, type Setup } from '../src/core';
import { Hangar, taskIn } from '../src/hangar';
import { eventsBefore, readRecord, RecordError } from '../src/record';
import { readRecording } from '../src/replay';

const WASM = readFileSync(new URL('../dist/cohelm_page.wasm', import.meta.url));

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

let core: Core;
beforeAll(async () => {
  core = await Core.load(WASM);
});

/** A flight with a key held from the fifth tick to the fifteenth; the record, and the log as it was sent. */
function fly(ticks: number, setup = SETUP): { record: Uint8Array; log: Uint8Array } {
  core.begin(setup);
  for (let tick = 0; tick < ticks; tick += 1) {
    if (tick === 5) core.key('down', 3, 100);
    if (tick === 15) core.key('release-all', 0, 300);
    core.tick();
  }
  const log = core.eventsFrom(0);
  return { record: core.finish(), log };
}

describe('the loop', () => {
  it('refuses in words and lives on', () => {
    expect(() => core.begin({ ...SETUP, values: 'ab'.repeat(32) })).toThrow(CoreError);
    expect(() => core.begin({ ...SETUP, values: 'ab'.repeat(32) })).toThrow(/no values model/);
    expect(core.begin(SETUP).controls.length).toBe(4);
  });

  it('that stops says so, and a fresh one takes its place', async () => {
    const other = await core.another();
    const inside = other as unknown as { wasm: Record<string, unknown> };
    inside.wasm = {
      ...inside.wasm,
      cohelm_about: () => {
        throw new WebAssembly.RuntimeError('unreachable');
      },
    };
    expect(() => other.about()).toThrow(CoreStopped);
    await other.revive();
    expect(other.about().plants.length).toBeGreaterThan(0);
  });
});

describe('a key log', () => {
  it('is cut before a tick', () => {
    const { log } = fly(20);
    expect(eventsBefore(log, 5).count).toBe(0);
    expect(eventsBefore(log, 6)).toEqual({ count: 1, bytes: log.subarray(0, 10) });
    expect(eventsBefore(log, 99)).toEqual({ count: 2, bytes: log });
  });

  it('holds moves of a stick too', () => {
    core.begin(SETUP);
    core.stick([100, -200, 0, 0], 1);
    core.key('down', 1, 2);
    expect(eventsBefore(core.eventsFrom(0), 1)).toMatchObject({ count: 2, bytes: { length: 28 } });
  });
});

describe('a record', () => {
  it('can be read without the loop', () => {
    const { record } = fly(20);
    const read = readRecord(record);
    expect(read).toMatchObject({ ending: 'abandoned', events: 2, setup: { seed: 5, rule: { rule: 'misc' } } });
    expect(read.asked.map((action) => action !== null)).toEqual(
      Array.from({ length: 20 }, (_, tick) => tick >= 5 && tick < 15),
    );
    expect(read.asked[5]).toEqual([0, 1, 0, 0]);
  });

  it('of another format, of something else, or cut off is refused in words', () => {
    const { record } = fly(20);
    const other = record.slice();
    other[4] = 9;
    expect(() => readRecord(other)).toThrow(/format 9/);
    expect(() => readRecord(new TextEncoder().encode('something else'))).toThrow(RecordError);
    expect(() => readRecord(record.subarray(0, record.length - 70))).toThrow(/damaged/);
  });

  it('is wound to any tick, with the ending at its end', async () => {
    const { record } = fly(600);
    const recording = (await readRecording(
      core,
      record,
      () => true,
      () => {},
    ))!;
    const { ending } = readRecord(record);
    expect(recording.tickAt(recording.length)?.ending).toBe(ending);
    expect(recording.differing).toBe(0);
    expect(recording.history.outcomes.length).toBe(recording.length);
    for (const tick of [7, recording.length, 3]) {
      const [kept] = recording.posesAt(tick);
      const { x, y } = recording.tickAt(tick)!.poses[0]!;
      expect([kept!.x, kept!.y]).toEqual([Math.fround(x), Math.fround(y)]);
    }
    expect(core.replay(record)).toMatchObject({ identical: true, requests_identical: true });
  });

  it('of another version of its plant is refused, not flown again', async () => {
    const { record } = fly(20);
    const text = new TextDecoder('latin1').decode(record).replace('"plant_version":1', '"plant_version":7');
    const older = Uint8Array.from(text, (letter) => letter.charCodeAt(0));
    expect(readRecord(older).setup.plant_version).toBe(7);
    await expect(
      readRecording(
        core,
        older,
        () => true,
        () => {},
      ),
    ).rejects.toThrow(/version 7/);
  });

  it('of a plant elsewhere says whose states it holds, and why the plant was lost', () => {
    const { record } = fly(20);
    expect(readRecord(record).elsewhere).toBeNull();
    const header = new TextEncoder().encode(JSON.stringify({ about: { name: 'cart' }, states: 2, lost: 'silent' }));
    const length = new Uint8Array(new Uint32Array([header.length]).buffer);
    const taped = Uint8Array.from([...record, ...length, ...header, 0, 0]);
    taped[4] = 2;
    expect(readRecord(taped).elsewhere).toEqual({ name: 'cart', lost: 'silent' });
  });

  it('that nobody wants is not begun: the loop goes on with what it has', async () => {
    const { record } = fly(20);
    core.begin(SETUP);
    core.tick();
    const recording = await readRecording(
      core,
      record,
      () => false,
      () => {},
    );
    expect(recording).toBeNull();
    expect(core.digests().ticks).toBe(1);
  });

  it('is not read on when nobody wants it any more', async () => {
    let asked = 0;
    const { record } = fly(600);
    const slow = Object.create(core) as Core;
    slow.seek = (tick) => {
      const until = performance.now() + 2;
      while (performance.now() < until);
      return core.seek(tick);
    };
    expect(
      await readRecording(
        slow,
        record,
        () => ++asked < 2,
        () => {},
      ),
    ).toBeNull();
    expect(asked).toBe(2);
  });
});

describe('the hangar', () => {
  const entry = (
    hash: string,
    kind: ModelEntry['kind'],
    more: Partial<ModelEntry['card']> & { offered?: boolean } = {},
  ): ModelEntry => {
    const { offered = true, ...card } = more;
    const task = card.task ?? { plant: 'flag-lander', options: {} };
    return {
      hash,
      kind,
      name: hash,
      plant: task.plant,
      offered,
      card: { name: hash, variant: null, task, plant_version: 1, goals: 3, ...card },
    };
  };
  let hangar: Hangar;
  beforeAll(async () => {
    hangar = new Hangar(await core.another());
  });

  it('offers the actions that the loop names for a plant, and all of them can be flown', () => {
    const names = (plant: string) => hangar.actionSets(plant).map((set) => set.name);
    expect(names('flag-lander')).toEqual(['switches', 'main-side', 'gymnasium', 'continuous']);
    expect(names('gymnasium-lander')).toEqual(['four', 'axes']);
    expect(names('drone')).toEqual(['levers', 'continuous']);
    expect(names('point')).toEqual(['usual']);
    for (const { name } of hangar.plants)
      for (const { options } of hangar.actionSets(name)) expect(hangar.try({ plant: name, options })).not.toBeNull();
  });

  it('reads from the address what is to be flown, as cohelm reads its options', () => {
    expect(taskIn('')).toBeNull();
    expect(taskIn('?task=drone')).toEqual({ plant: 'drone', options: {} });
    const lander = taskIn('?task=flag-lander&actions=continuous&changes_mind=%5B40%2C120%5D');
    expect(lander).toEqual({ plant: 'flag-lander', options: { actions: 'continuous', changes_mind: [40, 120] } });
  });

  it('begins with what the address asks for: a set that is offered, or one of its own', () => {
    const names = (plant: string) => hangar.actionSets(plant).map((set) => set.name);
    const ask = (search: string) => hangar.ask(taskIn(search));
    expect(ask('')).toBeNull();
    expect(ask('?task=drone')).toEqual({ plant: 'drone', actions: 'levers' });
    expect(ask('?task=drone&actions=continuous')).toEqual({ plant: 'drone', actions: 'continuous' });
    expect(names('drone')).toEqual(['levers', 'continuous']);
    expect(ask('?task=drone&wind=0')).toEqual({ plant: 'drone', actions: 'asked' });
    expect(hangar.actionSets('drone').at(-1)).toEqual({ name: 'asked', label: 'wind = 0', options: { wind: 0 } });
    expect(names('arm')).toEqual(['levers', 'continuous']);
    hangar.ask(null);
    expect(names('drone')).toEqual(['levers', 'continuous']);
  });

  it('knows axes from commands, and who brings values', () => {
    expect(hangar.try({ plant: 'point', options: {} })).toMatchObject({ hasAxes: true, hasValues: true });
    expect(hangar.try({ plant: 'flag-lander', options: {} })).toMatchObject({ hasAxes: false, hasValues: false });
    expect(hangar.try({ plant: 'flag-lander', options: { actions: 'continuous' } })).toMatchObject({ hasAxes: true });
  });

  it('takes models of the same plant and actions, whatever options were left out', () => {
    hangar.models = [
      entry('a', 'values'),
      entry('b', 'values', { task: { plant: 'flag-lander', options: { actions: 'main-side' } } }),
      entry('c', 'values', { task: { plant: 'flag-lander', options: { limit: 600 } } }),
      entry('d', 'intent'),
      entry('e', 'values', { plant_version: 2 }),
      entry('f', 'values', { task: { plant: 'point', options: {} } }),
    ];
    const fitting = (actions: string) =>
      hangar.fitting('values', { plant: 'flag-lander', options: { actions } }).map(({ hash }) => hash);
    expect(fitting('switches')).toEqual(['c', 'a']);
    expect(fitting('main-side')).toEqual(['b']);
    expect(fitting('gymnasium')).toEqual([]);
  });

  it('pairs the wanted values with the intent of their variant, if there is one', () => {
    hangar.learning = null;
    hangar.models = [
      entry('values', 'values'),
      entry('second', 'values', { variant: 'second' }),
      entry('paper', 'values', { variant: 'paper' }),
      entry('intent', 'intent'),
      entry('second intent', 'intent', { variant: 'second' }),
    ];
    const task = { plant: 'flag-lander', options: {} };
    const crew = (wanted: string) => Object.values(hangar.crew(task, wanted, 'calibrated'));
    expect(crew('')).toEqual(['values', 'intent']);
    expect(crew('second')).toEqual(['second', 'second intent']);
    expect(crew('paper')).toEqual(['paper', 'intent']);
    expect(crew('of another plant')).toEqual(['values', 'intent']);
    expect(Object.values(hangar.crew({ plant: 'point', options: {} }, '', 'calibrated'))).toEqual([null, null]);
    expect(Object.values(hangar.crew(task, '', 'imagined'))).toEqual(['values', null]);
    hangar.models.push(entry('blind', 'intent', { variant: 'imagined', goals: 0 }));
    expect(Object.values(hangar.crew(task, '', 'imagined'))).toEqual(['values', 'blind']);
    expect(crew('')).toEqual(['values', 'intent']);
  });

  it('prefers what learns, then the newest usual one; what was learned before is not offered', () => {
    const task = { plant: 'flag-lander', options: { actions: 'switches' } };
    hangar.models = [
      entry('usual', 'values'),
      entry('paper', 'values', { variant: 'paper' }),
      entry('learnt', 'values', { offered: false }),
    ];
    expect(hangar.fitting('values', task).map(({ hash }) => hash)).toEqual(['usual', 'paper']);
    hangar.learning = 'learnt';
    expect(hangar.fitting('values', task).map(({ hash }) => hash)).toEqual(['learnt', 'usual', 'paper']);
  });
});
