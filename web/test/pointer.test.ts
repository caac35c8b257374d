// @vitest-environment jsdom
// The stick under a mouse or a finger.

import { beforeEach, describe, expect, it } from 'vitest';
import type { Control } from '../src/core';
import { deflection, PointerStick } from '../src/pointer';

const AXES: Control[] = [
  { name: 'main −', keys: ['ArrowDown'] },
  { name: 'main +', keys: ['ArrowUp'] },
  { name: 'side −', keys: ['ArrowLeft'] },
  { name: 'side +', keys: ['ArrowRight'] },
];

let surface: HTMLElement;
let said: unknown[];
let lives: boolean;
let stick: PointerStick;

function point(name: string, x: number, y: number, more: { pointerId?: number; button?: number } = {}): void {
  const { pointerId = 1, button = 0 } = more;
  const event = new MouseEvent(name, { clientX: x, clientY: y, button, cancelable: true });
  surface.dispatchEvent(Object.assign(event, { pointerId }));
}

const ring = () => document.querySelector<HTMLElement>('.stick')!;

beforeEach(() => {
  document.body.innerHTML = '<div><canvas></canvas></div>';
  surface = document.querySelector('canvas')!;
  said = [];
  lives = true;
  stick = new PointerStick(
    surface,
    AXES,
    () => lives,
    (moved) => said.push(moved),
  );
  stick.attach();
});

describe('a stick under the pointer', () => {
  it('deflects by the drag: nothing near its middle, everything from 80 pixels on', () => {
    expect([0, 5, -8, 80, -200].map(deflection)).toEqual([0, 0, 0, 1, -1]);
    expect(deflection(44)).toBeCloseTo(0.5);
  });

  it('asks once for each new place, up being up, and for its middle when it is let go of', () => {
    point('pointerdown', 300, 200);
    stick.poll(0);
    point('pointermove', 220, 120);
    stick.poll(20);
    stick.poll(40);
    point('pointerup', 220, 120);
    stick.poll(60);
    stick.poll(80);
    expect(said).toEqual([
      [32767, -32767, 0, 0],
      [0, 0, 0, 0],
    ]);
  });

  it('is to be seen while it is pressed, where it was pressed', () => {
    expect(ring().hidden).toBe(true);
    point('pointerdown', 30, 40);
    expect([ring().hidden, ring().style.left, ring().style.top]).toEqual([false, '30px', '40px']);
    point('pointercancel', 30, 40);
    expect(ring().hidden).toBe(true);
  });

  it('belongs to the first finger and to a main button, and to nobody while nothing flies', () => {
    point('pointerdown', 0, 0, { button: 2 });
    lives = false;
    point('pointerdown', 0, 0);
    expect(ring().hidden).toBe(true);
    lives = true;
    point('pointerdown', 0, 0, { pointerId: 1 });
    point('pointerdown', 500, 0, { pointerId: 2 });
    point('pointermove', 500, 0, { pointerId: 2 });
    point('pointerup', 500, 0, { pointerId: 2 });
    stick.poll(0);
    expect([said, ring().hidden]).toEqual([[], false]);
  });

  it('lets go at a pause, says so once, and counts again only when it is pressed anew', () => {
    const released: string[] = [];
    const release = () => stick.releaseAll(() => released.push('release-all'));
    point('pointerdown', 0, 0);
    point('pointermove', 80, 0);
    stick.poll(0);
    release();
    release();
    point('pointermove', -80, 0);
    stick.poll(20);
    expect([said, released]).toEqual([[[0, 32767, 0, 0]], ['release-all']]);
    point('pointerdown', 0, 0);
    point('pointermove', -80, 0);
    stick.poll(40);
    expect(said.at(-1)).toEqual([0, -32767, 0, 0]);
  });

  it('leaves the picture as it was', () => {
    expect(surface.style.touchAction).toBe('none');
    stick.detach();
    expect([surface.style.touchAction, document.querySelector('.stick')]).toEqual(['', null]);
    point('pointerdown', 0, 0);
    point('pointermove', 80, 0);
    stick.poll(0);
    expect(said).toEqual([]);
  });
});
