// @vitest-environment jsdom
// While a study runs, lists keep to themselves how measured flights ended, unless somebody asks.

import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import type { DeskEpisode, Row, StudyReport } from '../../src/research/deskapi';
import { FlightListView } from '../../src/research/flightlist';
import { designRows } from '../../src/research/overview';
import { isMeasured, isRunning, Peek } from '../../src/research/peek';
import type { Desk } from '../../src/research/place';
import { eventWords } from '../../src/research/says';

const study = (finished: number, planned = 2) => ({ planned, cells: [{ finished }] }) as StudyReport;

const flight = (id: number, participant: number, step: string) =>
  ({
    ...{ id, participant, step, code: `P${participant}`, condition: 'hic', ticks: 50, seed: 1, started_at_ms: 0 },
    ...{ state: 'finished', ending: 'crash', setup: { task: { plant: 'point', options: {} }, rule: { rule: 'hic' } } },
  }) as DeskEpisode;

const FLIGHTS = [
  flight(3, 2, 'block-1/flight-1'),
  flight(2, 1, 'block-1/flight-1'),
  flight(1, 1, 'block-1/practice-1'),
];

/** The list of flights of a person and of a bot. */
async function opened(finished: number) {
  const rows = [
    { id: 1, code: 'P1', test: false, simulated: false },
    { id: 2, code: 'P2', test: false, simulated: true },
  ] as Row[];
  const feed = { study: study(finished), rows, row: (id: number) => rows.find((row) => row.id === id) };
  const desk = { feed, peek: new Peek(feed), go: () => {} } as unknown as Desk;
  const { main } = new FlightListView(desk);
  document.body.replaceChildren(main);
  await new Promise((resume) => setTimeout(resume, 10));
  const outcomes = () => [...main.querySelectorAll('tbody tr')].map((row) => row.children[6]!.textContent);
  return { main, outcomes };
}

beforeEach(() => {
  vi.stubGlobal('fetch', (path: string) =>
    Promise.resolve(Response.json(path.includes('plants') ? { plants: [] } : { episodes: FLIGHTS, next: null })),
  );
});
afterEach(() => vi.unstubAllGlobals());

describe('outcomes', () => {
  it('of people’s measured flights are hidden while the study runs, until somebody asks, who is told what it costs', async () => {
    const { main, outcomes } = await opened(1);
    expect(outcomes()).toEqual(['✕ crashed', 'hidden', '✕ crashed']);
    const ask = main.querySelector<HTMLInputElement>('.peek input')!;
    expect(ask.checked).toBe(false);
    ask.click();
    expect(outcomes()).toEqual(['✕ crashed', '✕ crashed', '✕ crashed']);
    expect(main.querySelector('.peek')!.textContent).toContain('optional stopping');
    ask.click();
    expect(outcomes()[1]).toBe('hidden');
  });

  it('are shown when everybody has finished', async () => {
    const { main, outcomes } = await opened(2);
    expect(outcomes()).not.toContain('hidden');
    expect(main.querySelector('.peek')).toBeNull();
  });

  it('are kept back in the log as well', () => {
    const ended = { seq: 1, at_ms: 0, event: 'flight-ended', step: 'block-1/flight-3', ending: 'crash' };
    expect(eventWords(ended, true).detail).toBe('');
    expect(eventWords({ ...ended, step: 'block-1/practice-3' }, true).detail).toBe('✕ crashed');
  });

  it('matter as long as somebody who was planned is missing', () => {
    expect([isRunning(study(1)), isRunning(study(2)), isRunning(study(0, 0))]).toEqual([true, false, true]);
    expect(['block-1/flight-12', 'block-1/practice-1', null].map(isMeasured)).toEqual([true, false, false]);
  });
});

describe('the design', () => {
  it('names the parameters of each rule', () => {
    const rows: [string, string][] = [
      ['Order', 'as drawn'],
      ['Condition a', 'rule misc-r; flights: 1 practice'],
      ['Condition b', 'rule hic; flights: 1 practice'],
    ];
    const conditions: StudyReport['conditions'] = [
      { name: 'a', rule: { rule: 'misc-r', kappa: 0.7 } },
      { name: 'b', rule: { rule: 'hic' } },
    ];
    expect(designRows({ rows, conditions }).map(([, words]) => words)).toEqual([
      'as drawn',
      'rule misc-r (κ = 0.7); flights: 1 practice',
      'rule hic; flights: 1 practice',
    ]);
  });
});
