// @vitest-environment jsdom
// The list of stored flights: each once, and as long as its plant says.

import './study/canvas';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import type { EpisodeEntry } from '../src/api';
import type { Context } from '../src/context';
import type { ReplayReport } from '../src/core';
import { EpisodesView } from '../src/episodesview';
import { flownWords, plantWords } from '../src/rates';
import { exactMark } from '../src/replayview';

const entry = (id: number, plant: string): EpisodeEntry => ({
  id,
  plant,
  ticks: 100,
  plant_version: 1,
  format: 1,
  program: '',
  rule: 'hic',
  seed: 1,
  pilot: 'person',
  time_scale: 1,
  values: null,
  intent: null,
  setup: { task: { plant, options: plant === 'external' ? { name: 'cart' } : {} } } as EpisodeEntry['setup'],
  started_at_ms: 0,
  ended_at_ms: 0,
  state: 'finished',
  ending: 'goal',
});

/** Answers that are given when the test says so. */
let waiting: (() => void)[] = [];
const answer = async () => {
  waiting.splice(0).forEach((give) => give());
  await new Promise((resume) => setTimeout(resume));
};

beforeEach(() => {
  waiting = [];
  vi.stubGlobal('fetch', (path: string) => {
    const pages = path.includes('before=3')
      ? { episodes: [entry(2, 'point'), entry(1, 'external')], next: null }
      : { episodes: [entry(4, 'point'), entry(3, 'point')], next: 3 };
    if (path === '/api/plants')
      return Promise.resolve(Response.json({ plants: [{ name: 'point', ticks_per_second: 40 }] }));
    return new Promise((resolve) => waiting.push(() => resolve(Response.json(pages))));
  });
});
afterEach(() => vi.unstubAllGlobals());

function opened() {
  const onStored = new Set<(episode: number) => void>();
  const view = new EpisodesView({ onStored, go: () => {} } as unknown as Context);
  const rows = () => [...view.main.querySelectorAll('tbody tr')].map((row) => row.children[0]!.textContent);
  const cells = (row: number) =>
    [...view.main.querySelectorAll('tbody tr')[row]!.children].map((cell) => cell.textContent);
  const older = view.main.querySelector<HTMLButtonElement>('button')!;
  return { rows, cells, older, stored: () => onStored.forEach((told) => told(5)) };
}

describe('the list of flights', () => {
  it('goes back in time, each flight once, however often it is asked for', async () => {
    const { rows, older } = opened();
    await answer();
    older.click();
    expect(older.disabled).toBe(true);
    older.disabled = false;
    older.click();
    await answer();
    expect(rows()).toEqual(['4', '3', '2', '1']);
    expect(older.hidden).toBe(true);
  });

  it('begins anew when a flight was stored, whatever was asked for before', async () => {
    const { rows, older, stored } = opened();
    await answer();
    older.click();
    stored();
    await answer();
    expect(rows()).toEqual(['4', '3']);
    expect(older.disabled).toBe(false);
  });

  it('tells seconds where the plant has a rate of ours, and ticks where only the record knows it', async () => {
    const { cells, older } = opened();
    await answer();
    expect(cells(0)[6]).toBe('2.5 s');
    older.click();
    await answer();
    expect([cells(3)[2], cells(3)[6]]).toEqual(['cart', '100 ticks']);
  });
});

describe('words', () => {
  it('never make up a rate or a name', () => {
    expect(flownWords(75, 'point', new Map([['point', 50]]))).toBe('1.5 s');
    expect(flownWords(75, 'point', new Map())).toBe('75 ticks');
    expect(plantWords({ plant: 'external', options: { name: 'cart' } })).toBe('cart');
    expect(plantWords({ plant: 'point', options: {} })).toBe('point');
  });

  it('do not say that a plant elsewhere was flown again', () => {
    const exact: ReplayReport = {
      identical: true,
      plant_identical: true,
      decisions_identical: true,
      requests_identical: true,
    };
    expect(exactMark(exact, 0, null).textContent).toContain('flown again');
    const elsewhere = exactMark(exact, 0, { name: 'cart', lost: null });
    expect(elsewhere.textContent).toBe('✓ from recorded states; the decisions made again, the same');
    expect(elsewhere.dataset['identical']).toBe('true');
    const other = exactMark({ ...exact, identical: false, plant_identical: false }, 0, { name: 'cart', lost: null });
    expect(other.textContent).toBe('✕ differs from its record: states');
  });
});
