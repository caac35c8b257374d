// @vitest-environment jsdom
import { beforeEach, describe, expect, it } from 'vitest';
import type { Control } from '../../src/core';
import { isUsable, KeyChoice } from '../../src/study/keychoice';

const CONTROLS: Control[] = [
  { name: 'left', keys: ['ArrowLeft', 'KeyA'] },
  { name: 'main', keys: ['ArrowUp', 'KeyW', 'Space'] },
  { name: 'right', keys: ['ArrowRight', 'KeyD'] },
];
const keysOf = (choice: KeyChoice) => choice.bind(CONTROLS).map(({ keys }) => keys.join(' '));

describe('chosen keys', () => {
  beforeEach(() => localStorage.clear());

  it('are the plant’s until somebody chooses', () => {
    const choice = new KeyChoice('P');
    expect(choice.bind(CONTROLS)).toEqual(CONTROLS);
    expect(choice.isInUse).toBe(false);
  });

  it('replace all keys of a control, and outlive a reload', () => {
    new KeyChoice('P').choose(CONTROLS, 'main', 'KeyK');
    expect(keysOf(new KeyChoice('P'))).toEqual(['ArrowLeft KeyA', 'KeyK', 'ArrowRight KeyD']);
    expect(new KeyChoice('P').isInUse).toBe(true);
    expect(new KeyChoice('another').isInUse).toBe(false);
  });

  it('never fly two controls at once', () => {
    const choice = new KeyChoice('P');
    choice.choose(CONTROLS, 'main', 'KeyA');
    expect(keysOf(choice)).toEqual(['ArrowLeft', 'KeyA', 'ArrowRight KeyD']);
    choice.choose(CONTROLS, 'left', 'KeyA');
    expect(keysOf(choice)).toEqual(['KeyA', 'ArrowLeft', 'ArrowRight KeyD']);
  });

  it('can be given back', () => {
    const choice = new KeyChoice('P');
    choice.choose(CONTROLS, 'main', 'KeyK');
    choice.reset();
    expect(choice.bind(CONTROLS)).toEqual(CONTROLS);
  });

  it('leave the page and the browser the keys that they need', () => {
    expect(['Escape', 'Enter', 'Tab', 'F5', 'ControlLeft', 'MetaLeft', ''].filter(isUsable)).toEqual([]);
    expect(['KeyK', 'Space', 'ShiftLeft', 'Numpad4', 'ArrowDown'].filter(isUsable).length).toBe(5);
  });

  it('that make no sense are the usual ones', () => {
    localStorage.setItem('cohelm.keys.1.P', '{"main": 3, "left": "Escape"}');
    expect(new KeyChoice('P').bind(CONTROLS)).toEqual(CONTROLS);
  });
});
