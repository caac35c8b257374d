// Candidates on axes, as the overlay shows them.

import { describe, expect, it } from 'vitest';
import type { Tick } from '../src/core';
import { MOST_ROWS, planeOf, worthOf } from '../src/plane';

const named = (main: number, side: number) => ({
  label: `main ${main.toFixed(2)}, side ${side.toFixed(2)}`,
  axes: [main, side, 0, 0] as [number, number, number, number],
});

/** A tick with the corners of a space from (0, −1) to (2, 1) and points between them. */
function tick(count: number): Tick {
  const corners = [named(0, -1), named(2, 1)];
  const between = Array.from({ length: count - 2 }, (_, i) => named(1 + i / 100, 0));
  const candidates = [...corners, ...between].map((action, i) => ({
    action,
    value: i,
    above_worst: i,
    allowed: i > 3,
  }));
  return { candidates, asked: named(0, -1), executed: named(1, 0), threshold: 4 } as unknown as Tick;
}

describe('the plane of candidates', () => {
  it('goes from one end of each axis to the other', () => {
    const plane = planeOf(tick(40))!;
    expect(plane.names).toEqual(['main', 'side']);
    expect(plane.spots).toHaveLength(40);
    expect(plane.spots[0]).toEqual({ x: -1, y: -1, worth: 0, allowed: false });
    expect(plane.spots[1]).toMatchObject({ x: 1, y: 1, allowed: false });
    expect(plane.spots[39]).toMatchObject({ worth: 1, allowed: true });
    expect([plane.asked, plane.executed]).toEqual([
      [-1, -1],
      [0, 0],
    ]);
  });

  it('is there only where candidates are many and have axes', () => {
    expect(planeOf(tick(MOST_ROWS))).toBeNull();
    const commands = tick(40);
    commands.candidates.forEach((candidate) => delete candidate.action.axes);
    expect(planeOf(commands)).toBeNull();
  });

  it('knows what an action is worth if it is a candidate', () => {
    expect(worthOf(tick(40), named(2, 1))).toBe(1);
    expect(worthOf(tick(40), named(0.5, 0.5))).toBeNull();
    expect(worthOf(tick(40), null)).toBeNull();
  });
});
