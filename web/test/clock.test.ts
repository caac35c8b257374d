import { describe, expect, it } from 'vitest';
import { TickClock } from '../src/clock';

/** Ticks that a clock of 20 ms gives when it is looked at every `stepMs` for `forMs`. */
function ticks(stepMs: number, forMs: number): number {
  const clock = new TickClock(20);
  clock.start(1000);
  let flown = 0;
  for (let now = 1000; now <= 1000 + forMs; now += stepMs) flown += clock.due(now);
  return flown;
}

describe('the clock', () => {
  it.each([1000 / 30, 1000 / 60, 1000 / 144, 4, 7.3])(
    'gives fifty ticks a second, looked at every %f ms, and keeps to that for an hour',
    (step) => {
      const hour = 3_600_000;
      expect(ticks(step, hour)).toBeGreaterThanOrEqual(hour / 20 - 1 - step / 20);
      expect(ticks(step, hour)).toBeLessThanOrEqual(hour / 20);
    },
  );

  it('makes up for a short stumble and counts what came late', () => {
    const clock = new TickClock(20);
    clock.start(0);
    expect([clock.due(20), clock.due(100), clock.due(120)]).toEqual([1, 4, 1]);
    expect(clock.late).toBe(3);
  });

  it('forgives a long one: nobody can fly a second in one frame', () => {
    const clock = new TickClock(20);
    clock.start(0);
    expect([clock.due(20), clock.due(1020), clock.due(1040)]).toEqual([1, 1, 1]);
    expect(clock.late).toBe(50);
  });

  it('goes on after a pause from where it was, within the tick', () => {
    const clock = new TickClock(20);
    clock.start(0);
    expect(clock.due(25)).toBe(1);
    clock.pause(31);
    expect(clock.between(5000)).toBeCloseTo(0.55);
    expect(clock.due(5000)).toBe(0);
    clock.start(9000);
    expect(clock.between(9000)).toBeCloseTo(0.55);
    expect(clock.due(9008)).toBe(0);
    expect(clock.due(9009)).toBe(1);
  });

  it('says where now lies between two ticks', () => {
    const clock = new TickClock(40);
    clock.start(0);
    clock.due(40);
    expect([clock.between(40), clock.between(50), clock.between(80), clock.between(500)]).toEqual([0, 0.25, 1, 1]);
    clock.stop();
    expect(clock.between(50)).toBe(1);
  });

  it('never goes backwards when it is asked about an earlier moment', () => {
    const clock = new TickClock(20);
    clock.start(100);
    expect(clock.due(90)).toBe(0);
    expect(clock.between(90)).toBe(0);
  });
});
