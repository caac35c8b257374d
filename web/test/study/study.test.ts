// @vitest-environment jsdom
// A whole study in the page, from consent to thanks, with jsPsych and the loop as they are, against a server that is
// not: what is rendered is what it says remains.

import './canvas';
import { initJsPsych } from 'jspsych';
import { readFileSync } from 'node:fs';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { Deck, type FlightShow } from '../../jspsych-cohelm/src';
import { KeyChoice } from '../../src/study/keychoice';
import { Place } from '../../src/study/place';
import type { FlightStep, Step } from '../../src/study/steps';
import { en } from '../../src/study/text/en';
import { runTimeline } from '../../src/study/timeline';
import { FakeServer, FakeSocket } from './server';

const WASM = readFileSync('dist/cohelm_page.wasm');

const flight = (id: string, number: number, practice: boolean): FlightStep => ({
  id,
  kind: 'flight',
  label: 'Mode A',
  practice,
  number,
  of: 2,
  block: 1,
  setup: {
    task: { plant: 'flag-lander', options: {} },
    plant_version: 1,
    seed: 100 + number,
    rule: { rule: 'hic' },
    inference: 'nearest',
    silence: 'best',
    time_scale: 1,
    values: null,
    intent: null,
    pilot: 'person',
  },
  flight_key: `${number}`.repeat(32),
  attempt: 1,
  feedback: practice,
  flown: null,
  committed_ticks: 0,
});

const STEPS = (): Step[] => [
  { id: 'consent', kind: 'consent', version: '1.0', text: 'What it is about.', minutes: 9, contact: 'a@example.org' },
  {
    id: 'demographics',
    kind: 'form',
    title: 'About you',
    items: [{ id: 'age', kind: 'number', text: 'Age?', required: true, least: 18, most: 99, unit: null }],
  },
  {
    id: 'quiz',
    kind: 'quiz',
    attempts: 2,
    questions: [
      {
        id: 'goal',
        text: 'Which goal is yours?',
        hint: 'It is amber.',
        choices: [
          { value: 'any', text: 'Any' },
          { value: 'amber', text: 'The amber one' },
        ],
      },
    ],
  },
  { id: 'block-1', kind: 'block', label: 'Mode A', text: 'Now.', practice: 1, measured: 1 },
  flight('block-1/practice-1', 1, true),
  flight('block-1/flight-1', 2, false),
  { id: 'block-1/break', kind: 'break', text: 'Rest.', at_least_s: 30, at_most_s: 60 },
  {
    id: 'end/questionnaire/control',
    kind: 'questionnaire',
    instrument: 'control',
    title: 'How was it?',
    intro: '',
    items: [
      {
        id: 'control',
        kind: 'scale',
        text: 'In control?',
        required: true,
        least: 0,
        most: 100,
        step: 5,
        left: 'no',
        right: 'yes',
        labels: [],
      },
      { id: 'note', kind: 'text', text: 'Anything else?', required: false, most_chars: 50 },
    ],
  },
  { id: 'debrief', kind: 'debrief', text: 'That was it.', contact: 'a@example.org' },
  { id: 'thanks', kind: 'thanks', code: 'ABCD1234', return_address: null, button: '', text: 'Thanks.', contact: '' },
];

let server: FakeServer;
let root: HTMLElement;
let inTheAir: FlightShow | null = null;
const failed = vi.fn();

/** Opens the page at a step of the study. */
async function open(from = 'consent', steps = STEPS()): Promise<void> {
  server = new FakeServer(steps);
  server.place = steps.findIndex(({ id }) => id === from);
  FakeSocket.server = server;
  vi.stubGlobal('WebSocket', FakeSocket);
  const wasm = () => Promise.resolve(new Response(WASM, { headers: { 'content-type': 'application/wasm' } }));
  vi.stubGlobal('fetch', (...[path, init]: Parameters<typeof server.fetch>) =>
    path.endsWith('.wasm') ? wasm() : server.fetch(path, init),
  );
  await enter();
}

/** What happens when the page is opened, or opened again; then nothing of the one before is left. */
async function enter(): Promise<void> {
  inTheAir?.dispose();
  const place = new Place({ changed: () => {}, away: () => {}, closed: () => {} });
  await place.open({});
  const deck = await Deck.open({ place: null });
  root = document.createElement('div');
  document.body.replaceChildren(root);
  vi.useFakeTimers();
  const study = { place, words: en, deck, keys: new KeyChoice('P-007'), refreshHz: 60, inTheAir: () => {}, failed };
  void runTimeline(initJsPsych({ display_element: root }), study, (show) => (inTheAir = show));
  await passes(50);
}

const passes = (ms: number) => vi.advanceTimersByTimeAsync(ms);
const find = <Found extends HTMLElement>(selector: string) => root.querySelector<Found>(selector)!;
const screenNow = () => root.querySelector<HTMLElement>('[data-screen]')?.dataset['screen'];
const cardNow = () => root.querySelector<HTMLElement>('.card:not([hidden])')?.dataset['kind'];
const lastData = () => server.posts.filter(({ path }) => path.includes('/steps/')).at(-1)!.body['data'];

async function press(selector = '.primary'): Promise<void> {
  find(selector).click();
  await passes(50);
}

async function strike(code: string): Promise<void> {
  window.dispatchEvent(Object.assign(new KeyboardEvent('keydown', { code, cancelable: true })));
  await passes(20);
}

async function submit(): Promise<void> {
  find('form').dispatchEvent(new Event('submit', { cancelable: true }));
  await passes(50);
}

/** Sees a flight to its end: nobody is at the keys, so it comes down. */
async function comeDown(): Promise<void> {
  await strike('Enter');
  await passes(3100);
  await passes(12_000);
}

beforeEach(() => {
  localStorage.clear();
  failed.mockClear();
});
afterEach(() => {
  inTheAir?.dispose();
  inTheAir = null;
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

describe('consent', () => {
  it('is given with a tick and a button, and leads on', async () => {
    await open();
    expect(screenNow()).toBe('consent');
    expect(root.textContent).toContain('Version 1.0');
    expect(find<HTMLButtonElement>('.primary').disabled).toBe(true);
    find('#agree').click();
    await press();
    expect(lastData()).toEqual({ agreed: true });
    expect(screenNow()).toBe('form');
  });

  it('that is refused ends the study', async () => {
    await open();
    await press('.secondary');
    expect(lastData()).toEqual({ agreed: false });
    expect(server.status).toBe('declined');
    expect(screenNow()).toBeUndefined();
  });
});

describe('a form', () => {
  it('is handed in only when what is required is there, and outlives a reload', async () => {
    await open('demographics');
    await submit();
    expect(find('.summary').textContent).toBe('One question still needs an answer.');
    find<HTMLInputElement>('input').value = '31';
    find('input').dispatchEvent(new Event('input'));
    vi.useRealTimers();
    await enter();
    expect(find<HTMLInputElement>('input').value).toBe('31');
    await submit();
    expect(lastData()).toEqual({ age: 31 });
    expect(screenNow()).toBe('quiz');
  });

  it('says what the server does not take', async () => {
    await open('demographics');
    find<HTMLInputElement>('input').value = '31';
    server.next.push({ status: 422, body: { error: 'no', items: { age: 'out-of-range' } } });
    await submit();
    expect(find('.complaint').textContent).toBe('This number is not possible here.');
    expect(screenNow()).toBe('form');
  });

  it('asks once before it leaves a question open, and sends null for it', async () => {
    await open('end/questionnaire/control');
    find('input.line').dispatchEvent(new Event('pointerup'));
    await submit();
    expect(find('.summary').textContent).toContain('still open');
    await submit();
    expect(lastData()).toEqual({ control: 50, note: null });
    expect(screenNow()).toBe('debrief');
  });
});

describe('the quiz', () => {
  it('shows the hints of what is wrong, and how many tries are left', async () => {
    await open('quiz');
    find('input[value=any]').click();
    const [current, ...rest] = server.session.steps;
    const missed = { ...server.session, steps: [{ ...current, attempts: 1 }, ...rest], wrong: ['goal'] };
    server.next.push({ status: 200, body: missed });
    await submit();
    expect(find('.complaint').textContent).toBe('It is amber.');
    expect(find('.summary').textContent).toContain('one more try');
    find('input[value=amber]').click();
    await submit();
    expect(lastData()).toEqual({ goal: 'amber' });
    expect(screenNow()).toBe('block');
  });
});

describe('a screen that cannot go on', () => {
  it('tells the page, so that nobody waits for ever', async () => {
    await open('demographics');
    find<HTMLInputElement>('input').value = '31';
    server.next.push({ status: 404, body: { error: 'there is no such step' } });
    await submit();
    expect(failed).toHaveBeenCalledOnce();
    expect(String(failed.mock.calls[0])).toContain('404 without a session');
  });

  it('tells it too if the picture of a task cannot be drawn', async () => {
    const steps = STEPS();
    (steps.find(({ id }) => id === 'block-1/practice-1') as FlightStep).setup.task.plant = 'gone';
    const pages = [{ title: 'Your task', text: 'Land.', picture: 'task' as const }];
    steps.unshift({ id: 'instructions', kind: 'instructions', pages });
    await open('instructions', steps);
    expect(String(failed.mock.calls[0])).toContain('gone');
  });

  it('says nothing of a session that is closed, of which the page speaks already', async () => {
    await open('demographics');
    find<HTMLInputElement>('input').value = '31';
    server.tab = 'another';
    await submit();
    expect(failed).not.toHaveBeenCalled();
  });
});

describe('flights', () => {
  it('are flown, delivered and noted; practice says how it ended, a measured flight does not', async () => {
    await open('block-1');
    await press();
    expect(cardNow()).toBe('ready');
    expect(find('.card h2').textContent).toBe('Practice 1 of 2');
    await comeDown();
    expect(find('.card h2').textContent).toBe(en.flight.endings.crash);
    await strike('Enter');
    await passes(100);
    expect(lastData()).toMatchObject({ pauses: 0, interruptions: 0, presses: 0, refresh_hz: 60 });
    expect(server.committed.get('1'.repeat(32))!.ticks).toBe((lastData() as { ticks: number }).ticks);
    expect(find('.card h2').textContent).toBe('Flight 2 of 2');
    await comeDown();
    expect(screenNow()).toBe('break');
    expect(localStorage.getItem(`cohelm.flight.1.${'2'.repeat(32)}`)).toBeNull();
  });

  it('go on after a reload from their last tick, after a countdown', async () => {
    await open('block-1/flight-1');
    await strike('Enter');
    await passes(3000 + 640);
    await strike('ArrowUp');
    await passes(220);
    window.dispatchEvent(new Event('pagehide'));
    const kept = JSON.parse(localStorage.getItem(`cohelm.flight.1.${'2'.repeat(32)}`)!) as { ticks: number };
    expect(kept.ticks).toBeGreaterThan(35);
    vi.useRealTimers();
    await enter();
    expect(cardNow()).toBe('interrupted');
    expect(find('.hud .clock').textContent).toBe(`${(kept.ticks / 50).toFixed(1)} s`);
    await comeDown();
    const resumed = server.posts.find(({ body }) => 'resumed' in body)!.body['resumed'];
    expect(resumed).toMatchObject({ tick: kept.ticks, source: 'page' });
    expect(lastData()).toMatchObject({ interruptions: 1, presses: 1 });
    expect(screenNow()).toBe('break');
  });

  it('that are refused stop at once, say why, and are flown once more', async () => {
    await open('block-1/flight-1');
    server.refuses = 'the setup is another';
    await strike('Enter');
    await passes(3000 + 600);
    expect(cardNow()).toBe('failed');
    expect(find('.card').textContent).toContain('The setup is another.');
    await strike('Enter');
    await passes(100);
    expect(cardNow()).toBe('ready');
    expect(localStorage.getItem(`cohelm.flight.1.${'2'.repeat(32)}`)).toBeNull();
    await comeDown();
    expect(server.committed.get('f'.repeat(32))!.ticks).toBeGreaterThan(40);
    expect(screenNow()).toBe('break');
  });

  it('pause with Esc and when the window loses the focus', async () => {
    await open('block-1/flight-1');
    await strike('Enter');
    await passes(3200);
    await strike('Escape');
    expect(cardNow()).toBe('paused');
    const clock = find('.hud .clock').textContent;
    await passes(5000);
    expect(find('.hud .clock').textContent).toBe(clock);
    await strike('Enter');
    await passes(1000);
    window.dispatchEvent(new Event('blur'));
    expect(cardNow()).toBe('paused');
  });

  it('that the server has already, but nothing more of, are only noted', async () => {
    const steps = STEPS();
    const flown = steps.find(({ id }) => id === 'block-1/flight-1') as FlightStep;
    flown.flown = 'crash';
    await open('block-1/flight-1', steps);
    await passes(100);
    expect(server.posts.at(-1)!.path).toBe('/api/session/steps/block-1/flight-1');
    expect(screenNow()).toBe('break');
  });

  it('never show a rule’s name', async () => {
    const steps = STEPS();
    (steps.find(({ id }) => id === 'block-1/flight-1') as FlightStep).setup.rule = { rule: 'hic' };
    await open('block-1/flight-1', steps);
    expect(root.textContent).not.toMatch(/HIC|LASC|MISC|robot/i);
    expect(root.querySelector('.overlay')).toBeNull();
  });
});

describe('a break', () => {
  it('cannot be cut short', async () => {
    await open('block-1/break');
    expect(find<HTMLButtonElement>('.primary').disabled).toBe(true);
    await passes(30_500);
    expect(find<HTMLButtonElement>('.primary').disabled).toBe(false);
    await passes(40_000);
    expect(find('.clock').textContent).toBe(en.break.late);
    await press();
    expect(screenNow()).toBe('questionnaire');
  });
});

describe('the end', () => {
  it('gives the code and stays', async () => {
    await open('debrief');
    await press();
    expect(screenNow()).toBe('thanks');
    expect(find('output').textContent).toBe('ABCD1234');
    await passes(60_000);
    expect(screenNow()).toBe('thanks');
  });
});
