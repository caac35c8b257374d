// @vitest-environment jsdom
// What the page says to a plant that is elsewhere, and what it hears of it.

import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { ExternalLink, isAttended } from '../src/external';

/** A server that writes down what it is told. */
class Server extends EventTarget {
  static readonly CONNECTING = 0;
  static readonly OPEN = 1;
  static last: Server;
  readyState = Server.CONNECTING;
  readonly told: unknown[] = [];

  constructor() {
    super();
    Server.last = this;
  }

  open(): void {
    this.readyState = Server.OPEN;
    this.dispatchEvent(new Event('open'));
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

let heard: string[];
let seen: boolean;
let link: ExternalLink;

beforeEach(() => {
  vi.useFakeTimers();
  vi.stubGlobal('WebSocket', Server);
  [heard, seen] = [[], true];
  const events = {
    ready: () => heard.push('ready'),
    tick: (_: unknown, late: number, letGo: boolean) => heard.push(`tick, ${late} late${letGo ? ', let go' : ''}`),
    ended: () => heard.push('ended'),
    refused: (reason: string) => heard.push(reason),
    closed: () => heard.push('closed'),
  };
  link = new ExternalLink('ws://here/ws/external', events, () => seen);
});

afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

describe('the way to a plant elsewhere', () => {
  it('says what the server reads, in order, also what was said before the connection stood', () => {
    link.begin(7, { rule: 'misc' });
    Server.last.open();
    link.key('down', 2, 10);
    link.key('release-all', 0, 20);
    link.stick([1, 2, 3, 4], 30);
    link.stop();
    expect(Server.last.told).toEqual([
      { begin: { seed: 7, rule: { rule: 'misc' } } },
      { change: { change: { down: 2 }, at_ms: 10 } },
      { change: { change: 'release-all', at_ms: 20 } },
      { change: { change: { stick: [1, 2, 3, 4] }, at_ms: 30 } },
      'stop',
    ]);
  });

  it('says ten times a second that somebody is there, but not of a page that nobody sees, nor after the end', () => {
    Server.last.open();
    link.start();
    vi.advanceTimersByTime(1000);
    expect(Server.last.told).toEqual(['start', ...Array<unknown>(10).fill({ here: { shown: null } })]);
    seen = false;
    vi.advanceTimersByTime(1000);
    seen = true;
    Server.last.say({ ended: { ending: 'goal' } });
    vi.advanceTimersByTime(1000);
    expect(Server.last.told.length).toBe(11);
  });

  it('tells which tick it has shown: every third at once, others ten times a second, none that nobody saw', () => {
    Server.last.open();
    link.start();
    for (let tick = 0; tick < 8; tick += 1) link.shown(tick);
    vi.advanceTimersByTime(100);
    seen = false;
    link.shown(20);
    expect(Server.last.told).toEqual(['start', ...[2, 5, 7].map((shown) => ({ here: { shown } }))]);
    seen = true;
    link.start();
    vi.advanceTimersByTime(100);
    expect(Server.last.told.at(-1)).toEqual({ here: { shown: null } });
  });

  it('counts as seen only with the focus and in front', () => {
    const focus = vi.spyOn(document, 'hasFocus').mockReturnValue(true);
    const hidden = vi.spyOn(document, 'hidden', 'get').mockReturnValue(false);
    expect(isAttended()).toBe(true);
    hidden.mockReturnValue(true);
    expect(isAttended()).toBe(false);
    hidden.mockReturnValue(false);
    focus.mockReturnValue(false);
    expect(isAttended()).toBe(false);
    vi.restoreAllMocks();
  });

  it('tells what it hears', () => {
    Server.last.open();
    Server.last.say({ ready: { name: 'cart' } });
    Server.last.say({ tick: { report: {}, late: 3, let_go: false } });
    Server.last.say({ tick: { report: {}, late: 3, let_go: true } });
    Server.last.say({ refused: { reason: 'the plant cannot be reached' } });
    Server.last.close();
    expect(heard).toEqual(['ready', 'tick, 3 late', 'tick, 3 late, let go', 'the plant cannot be reached', 'closed']);
  });
});
