// @vitest-environment jsdom
// What steers a plant elsewhere: who looks away lets go, and must press again.

import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { Hands } from '../src/hands';

const CONTROLS = [
  { name: 'x −', keys: ['ArrowLeft'] },
  { name: 'x +', keys: ['ArrowRight'] },
];

let told: unknown[];
let attended: boolean;
let pushed: number;
let hands: Hands;

beforeEach(() => {
  vi.useFakeTimers();
  [told, attended, pushed] = [[], true, 0];
  vi.stubGlobal('navigator', { getGamepads: () => [{ axes: [pushed, 0], buttons: [] }] });
  hands = new Hands(
    CONTROLS,
    document.createElement('canvas'),
    { key: (kind, control) => told.push([kind, control]), stick: (stick) => told.push(stick[0]) },
    () => attended,
  );
  hands.attach();
  // The pad rests first: what is pushed at the start does not count.
  vi.advanceTimersByTime(40);
});

afterEach(() => {
  hands.detach();
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

/** What is told while a gamepad is pushed so far for a while. */
function push(far: number): unknown[] {
  pushed = far;
  told = [];
  vi.advanceTimersByTime(100);
  return told;
}

describe('hands', () => {
  it('do not take a stick that was pushed before the start', () => {
    hands.detach();
    pushed = 1;
    hands.attach();
    expect(push(1)).toEqual([]);
    push(0);
    expect(push(1)).toEqual([32767]);
  });

  it('let go of a stick that is held when the page is left, and do not take it again when it comes back', () => {
    expect(push(0.5)).toEqual([16384]);
    attended = false;
    expect(push(0.5)).toEqual([['release-all', 0]]);
    expect(push(0.7)).toEqual([]);
    attended = true;
    expect(push(0.7)).toEqual([]);
    push(0.05);
    expect(push(0.5)).toEqual([16384]);
  });

  it('are not taken again at once after they were let go of by somebody else', () => {
    expect(push(-1)).toEqual([-32767]);
    hands.letGo();
    expect(push(-1)).toEqual([]);
    push(0);
    expect(push(-1)).toEqual([-32767]);
  });

  it('let go of a pad that is unplugged', () => {
    push(1);
    vi.stubGlobal('navigator', { getGamepads: () => [null] });
    expect(push(1)).toEqual([0]);
  });

  it('let go of keys, which count again when they are pressed again', () => {
    const key = (type: string, repeat = false) =>
      window.dispatchEvent(new KeyboardEvent(type, { code: 'ArrowRight', repeat }));
    told = [];
    key('keydown');
    hands.letGo();
    key('keydown', true);
    key('keyup');
    key('keydown');
    expect(told).toEqual([
      ['down', 1],
      ['release-all', 0],
      ['down', 1],
    ]);
  });
});
