// What the desk says of a study: words for steps and events, who is quiet, who is shown first.

import { describe, expect, it } from 'vitest';
import type { Logged, Row } from '../../src/research/deskapi';
import { idsIn } from '../../src/research/feed';
import { filtered, isGone, isQuiet, QUIET_MS } from '../../src/research/roll';
import { ago, eventWords, stepWords } from '../../src/research/says';

const ROW: Row = {
  id: 1,
  code: 'K4QT',
  status: 'under-way',
  test: false,
  simulated: false,
  cell: 0,
  order: ['hic', 'misc'],
  place: 4,
  total: 40,
  step: 'block-1/flight-2',
  condition: 'hic',
  last_seen_ms: 1_000_000,
  connected: false,
  in_air: null,
  minutes: 3,
  late_ticks: [],
  interruptions: 0,
  endings: {},
  notes: 0,
  breaches: [],
  excluded: null,
};
const row = (change: Partial<Row>): Row => ({ ...ROW, ...change });
const logged = (event: string, more: Record<string, unknown> = {}): Logged => ({ seq: 1, at_ms: 0, event, ...more });

describe('a step', () => {
  it('is said in words', () => {
    expect(stepWords('block-1/flight-3')).toBe('block 1 · flight 3');
    expect(stepWords('block-2/questionnaire/nasa-tlx')).toBe('block 2 · nasa-tlx');
    expect(stepWords('consent')).toBe('consent');
  });
});

describe('an event', () => {
  it('is said with what one wants to know of it', () => {
    const ended = logged('flight-ended', { step: 'block-1/flight-3', ending: 'crash', ticks: 311 });
    expect(eventWords(ended)).toEqual({ what: 'ended: block 1 · flight 3', detail: '✕ crashed' });
    const resumed = logged('flight-resumed', { step: 'block-1/flight-3', tick: 12, source: 'server', away_ms: 61_000 });
    expect(eventWords(resumed).detail).toBe('tick 12 · from the server, away 61 s');
    expect(eventWords(logged('excluded', { reason: 'took part before', by: 'desk' })).detail).toBe(
      'took part before · by desk',
    );
  });

  it('of a newer server is still said', () => {
    expect(eventWords(logged('coffee-fetched', { step: 'block-1/break' }))).toEqual({
      what: 'coffee fetched',
      detail: 'block 1 · break',
    });
  });
});

describe('time', () => {
  it('is said in the largest unit that says enough', () => {
    const now = 10 * 86_400_000;
    const said = [3, 42, 600, 7200, 3 * 86_400].map((seconds) => ago(now - 1000 * seconds, now));
    expect(said).toEqual(['now', '42 s ago', '10 min ago', '2 h ago', '3 d ago']);
    expect(ago(now + 5000, now)).toBe('now');
  });
});

describe('participants', () => {
  it('are quiet only under way, away, and for long enough', () => {
    const now = ROW.last_seen_ms! + QUIET_MS + 1;
    expect(isQuiet(ROW, now)).toBe(true);
    expect(isQuiet(ROW, now - 2)).toBe(false);
    expect(isQuiet(row({ connected: true }), now)).toBe(false);
    expect(isQuiet(row({ status: 'completed' }), now)).toBe(false);
    expect([row({ status: 'excluded' }), row({ status: 'completed' })].map(isGone)).toEqual([true, false]);
  });

  const rows = [
    row({ id: 1, code: 'AAAA' }),
    row({ id: 2, code: 'BBBB', connected: true }),
    row({ id: 3, code: 'CCCC', test: true, status: 'completed' }),
    row({ id: 4, code: 'DDDD', simulated: true }),
    row({ id: 5, code: 'EAEE', in_air: { episode: 9, ticks: 50 }, connected: true }),
  ];
  const ids = (filter: Partial<Parameters<typeof filtered>[1]>) =>
    filtered(rows, { code: '', status: 'all', others: true, ...filter }).map(({ id }) => id);

  it('whose flight is under way come first, then who is here, then the newest', () => {
    expect(ids({})).toEqual([5, 2, 4, 3, 1]);
  });

  it('are found by part of a code, by status, and without tests and bots', () => {
    expect(ids({ code: ' a ' })).toEqual([5, 1]);
    expect(ids({ status: 'completed' })).toEqual([3]);
    expect(ids({ status: 'here' })).toEqual([5, 2]);
    expect(ids({ others: false })).toEqual([5, 2, 1]);
  });
});

describe('news', () => {
  it('name participants, in whatever form', () => {
    expect(idsIn('7')).toEqual([7]);
    expect(idsIn('[7, 8]')).toEqual([7, 8]);
    expect(idsIn('{"participant": 7}')).toEqual([7]);
    expect(idsIn('{"participants": [7, 9], "all": false}')).toEqual([7, 9]);
    expect(idsIn('hello')).toEqual([]);
    expect(idsIn('null')).toEqual([]);
  });
});
