// @vitest-environment jsdom
// The page at a plant that is elsewhere: what it says stays true when the server goes, answers twice, or has no co-pilot.

import './study/canvas';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import type { Context } from '../src/context';
import type { ExternalReady } from '../src/external';
import { ExternalView } from '../src/externalview';

/** A server that writes down what it is told, and says what the test says. */
class Server extends EventTarget {
  static readonly CONNECTING = 0;
  static readonly OPEN = 1;
  static last: Server;
  readyState = Server.OPEN;
  readonly told: unknown[] = [];

  constructor() {
    super();
    Server.last = this;
  }

  send(words: string): void {
    this.told.push(JSON.parse(words));
  }

  say(words: unknown): void {
    this.dispatchEvent(new MessageEvent('message', { data: JSON.stringify(words) }));
  }

  close(): void {
    this.readyState = 3;
    this.dispatchEvent(new Event('close'));
  }
}

const READY: ExternalReady = {
  name: 'cart',
  has_axes: true,
  has_values: false,
  why_alone: 'no values fit this plant',
  opening: {
    setup: { seed: 1, rule: { rule: 'hic' } },
    ticks_per_second: 50,
    ticks: null,
    controls: [
      { name: 'x −', keys: ['ArrowLeft'] },
      { name: 'x +', keys: ['ArrowRight'] },
    ],
    pilot_goal: 0,
    goals: [],
    scene: { bounds: [0, 0, 1, 1], fixed: [], movable: [], origin: [0, 0], scale: [1, 1] },
    poses: [],
  } as unknown as ExternalReady['opening'],
};
const ENDED = { ending: 'goal', why: null, ticks: 50, commands: 9, corrected: 0, late: 0, episode: null };

let view: ExternalView;
const card = () => view.main.querySelector<HTMLElement>('.card:not([hidden])');
const key = (type: string, code: string) => window.dispatchEvent(new KeyboardEvent(type, { code }));
const changes = () => Server.last.told.filter((words) => typeof words === 'object' && 'change' in (words as object));

beforeEach(() => {
  vi.stubGlobal('WebSocket', Server);
  localStorage.clear();
  view = new ExternalView({ onStored: new Set(), go() {} } as unknown as Context);
  document.body.replaceChildren(view.main, view.footer);
});
afterEach(() => {
  view.dispose();
  vi.unstubAllGlobals();
});

describe('the page at a plant elsewhere', () => {
  it('keeps the card of a flight that has ended when the server goes', () => {
    Server.last.say({ ready: READY });
    key('keydown', 'Enter');
    Server.last.say({ ended: ENDED });
    Server.last.close();
    expect(card()!.dataset['kind']).toBe('goal');
    const before = Server.last;
    key('keydown', 'Enter');
    expect(Server.last).not.toBe(before);
  });

  it('heeds only the answer to its last wish, and steers with one pair of hands', () => {
    const modes = view.footer.querySelector('select');
    Server.last.say({ ready: READY });
    expect(modes).toBeNull();
    // Two wishes at once: the first answer is over before it comes.
    (view as unknown as { prepare(): void }).prepare();
    (view as unknown as { prepare(): void }).prepare();
    Server.last.say({ ready: { ...READY, name: 'older' } });
    expect(card()!.textContent).not.toContain('older');
    Server.last.say({ ready: { ...READY, name: 'newer' } });
    expect(card()!.textContent).toContain('newer');
    key('keydown', 'Enter');
    key('keydown', 'ArrowRight');
    expect(changes()).toHaveLength(1);
    Server.last.say({ ended: ENDED });
    key('keyup', 'ArrowRight');
    key('keydown', 'ArrowRight');
    expect(changes()).toHaveLength(1);
  });

  it('offers no mode that is not flown', () => {
    Server.last.say({ ready: READY });
    const box = view.footer.querySelector('select')!;
    expect(box.value).toBe('hic');
    expect([...box.options].filter((option) => !option.disabled).map(({ value }) => value)).toEqual(['hic']);
    expect(box.textContent).toContain('no co-pilot for this plant');
  });

  it('says anew in words that it was let go of', () => {
    Server.last.say({ ready: READY });
    key('keydown', 'Enter');
    window.dispatchEvent(new Event('blur'));
    const voice = view.main.querySelector('.voice')!;
    expect(voice.textContent).toBe('Let go: press again');
    key('keydown', 'ArrowLeft');
    expect(voice.textContent).toBe('');
  });
});
