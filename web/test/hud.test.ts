// @vitest-environment jsdom
import { describe, expect, it } from 'vitest';
import type { Opening } from '../src/core';
import { Hud } from '../src/hud';

const OPENING = { controls: [{ name: 'left', keys: ['ArrowLeft'] }] } as Opening;

function begun(): Hud {
  const hud = new Hud();
  hud.begin(OPENING, 'alone');
  return hud;
}

const tiltOf = (hud: Hud) =>
  ['.dial', '.tilt'].map((part) => (hud.node.querySelector<HTMLElement>(part)!.hidden ? 'hidden' : 'shown'));
const fly = (hud: Hud, tilt_rad: number) => hud.show(1, new Set(), { across: 0.3, upwards: 0, tilt_rad });

describe('the tilt', () => {
  it('is not shown of what stays upright, such as a hand or a cart', () => {
    const hud = begun();
    fly(hud, 0);
    expect(tiltOf(hud)).toEqual(['hidden', 'hidden']);
    expect(hud.node.textContent).toContain('0.3');
  });

  it('is shown from the first turn on, also where it comes back to nothing', () => {
    const hud = begun();
    fly(hud, -0.1);
    fly(hud, 0);
    expect(tiltOf(hud)).toEqual(['shown', 'shown']);
    expect(hud.node.querySelector('.tilt')!.textContent).toBe('tilt 0°');
  });

  it('is hidden again when another flight begins', () => {
    const hud = begun();
    fly(hud, 0.5);
    hud.begin(OPENING, 'alone');
    expect(tiltOf(hud)).toEqual(['hidden', 'hidden']);
  });
});
