// What if, in the page: a branch is the record up to its tick, and says when it begins to differ and how far it gets.

import { readFileSync } from 'node:fs';
import { beforeAll, describe, expect, it } from 'vitest';
import { Core, CoreError, type Rule, type Setup, type Wish } from '../../src/core';
import { readRecording, type Recording } from '../../src/replay';
import { apart, flyBranch, type Branch } from '../../src/research/branching';
import { momentWords, whatItSays } from '../../src/research/worth';

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

let one: Core;
let other: Core;
let original: Recording;
beforeAll(async () => {
  one = await Core.load(WASM);
  other = await one.another();
  one.begin(SETUP);
  for (let tick = 0; tick < 120; tick += 1) {
    if (tick === 5) one.key('down', 3, 100);
    if (tick === 70) one.key('release-all', 0, 300);
    one.tick();
  }
  const record = one.finish();
  original = (await readRecording(
    one,
    record,
    () => true,
    () => {},
  ))!;
  other.watch(record);
});

const wish = (at: number, rule: Rule, pilot: Wish['pilot'] = { pilot: 'recorded' }): Wish => ({
  at,
  rule,
  inference: 'nearest',
  silence: 'best',
  values: null,
  intent: null,
  pilot,
});

describe('a branch', () => {
  it('under the recorded rule is the record as far as it goes', async () => {
    const branch = (await flyBranch(other, original, wish(30, { rule: 'misc' }), () => true))!;
    const distances = apart(original, branch, 0);
    expect(distances.length).toBe(121);
    expect(Math.max(...distances)).toBeLessThan(1e-6);
    expect(branch.history.outcomes.slice(0, 120)).toEqual(original.history.outcomes);
    expect(branch.differsAfter).toBeNull();
    expect(branch.length).toBeGreaterThan(120);
  });

  it('under another rule is the record before its tick and leaves it after', async () => {
    const branch = (await flyBranch(other, original, wish(30, { rule: 'hic' }), () => true))!;
    const distances = apart(original, branch, 0);
    expect(Math.max(...distances.slice(0, 31))).toBeLessThan(1e-6);
    expect(distances.at(-1)).toBeGreaterThan(0.01);
    expect(branch.tickAt(30)).toEqual(original.tickAt(30));
    expect(branch.tickAt(31)!.executed).toEqual(branch.tickAt(31)!.asked);
    expect(branch.opening.setup.rule.rule).toBe('hic');
    const first = 30 + branch.differsAfter! + 1;
    expect(branch.tickAt(first)!.executed).not.toEqual(original.tickAt(first)!.executed);
  });

  it('is left when nobody wants it any more, and refused in words when it cannot be', async () => {
    const slow = Object.create(other) as Core;
    slow.tick = () => {
      const until = performance.now() + 3;
      while (performance.now() < until);
      return other.tick();
    };
    expect(await flyBranch(slow, original, wish(0, { rule: 'robot' }), () => false)).toBeNull();
    await expect(flyBranch(other, original, wish(500, { rule: 'hic' }), () => true)).rejects.toThrow(CoreError);
  });

  it('is offered to the recorded hands, to nobody, to the values and to people of every kind', () => {
    expect(other.pilots().slice(0, 3)).toEqual([{ pilot: 'recorded' }, { pilot: 'nobody' }, { pilot: 'greedy' }]);
    expect(
      other
        .pilots()
        .slice(3)
        .map((hands) => hands.pilot),
    ).toEqual(Array(10).fill('person'));
  });
});

describe('what a branch is worth', () => {
  const fly = async (at: number, rule: Rule, pilot?: Wish['pilot']): Promise<Branch> =>
    (await flyBranch(other, original, wish(at, rule, pilot), () => true))!;

  it('is said for the moment: as recorded, an open loop, then nothing much', async () => {
    const branch = await fly(30, { rule: 'robot' });
    const states = [30, 31, 80, 81].map((position) => momentWords(branch, position).state);
    expect(states).toEqual(['recorded', 'fresh', 'fresh', 'stale']);
    expect(momentWords(branch, 80).words).toBe('+1.00 s, open loop');
    expect(momentWords(branch, 121).words).toMatch(/keys are over, nobody asks/);
  });

  it('runs by the time as the person saw it', async () => {
    const branch = await fly(30, { rule: 'robot' });
    branch.opening.setup.time_scale = 0.5;
    expect([55, 56].map((position) => momentWords(branch, position).state)).toEqual(['fresh', 'stale']);
  });

  it('of a simulated pilot is never said to be the person', async () => {
    const branch = await fly(30, { rule: 'hic' }, { pilot: 'greedy' });
    expect(momentWords(branch, 110)).toEqual({ words: '+1.60 s, simulated pilot', state: 'fresh' });
    expect(whatItSays(original, branch)).toMatch(/Not this participant/);
  });

  it('names the first other action and the parting of the ways, and calls an open loop one', async () => {
    expect(whatItSays(original, await fly(30, { rule: 'misc' }))).toMatch(/^Nothing else would have been carried out/);
    const words = whatItSays(original, await fly(30, { rule: 'robot' }));
    expect(words).toMatch(/^First other action after \d\.\d\d s; the ways part visibly after \d\.\d\d s\./);
    expect(words).toMatch(/An open loop/);
  });
});
