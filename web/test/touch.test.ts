// @vitest-environment jsdom
// Fingers on the screen's buttons, and what the picture leaves free for them and for what is looked at.

import './study/canvas';
import { expect, describe, it } from 'vitest';
import { within } from '../src/backdrop';
import { sideFor } from '../src/card';
import { otherKeys } from '../src/keys';
import { Overlay } from '../src/overlay';
import { TouchKeys } from '../src/touch';

const CONTROLS = [
  { name: 'left', keys: ['ArrowLeft', 'KeyA'] },
  { name: 'grip', keys: ['Digit2'] },
];

/** Buttons, and what they said; `touch` presses or lets go of one with a finger. */
function buttons() {
  const said: string[] = [];
  const state = { lives: true };
  const keys = new TouchKeys(
    CONTROLS,
    () => state.lives,
    (kind, control) => said.push(kind === 'release-all' ? kind : `${kind} ${control}`),
    (name) => name.toUpperCase(),
  );
  const touch = (type: string, control: number, finger = 1) =>
    keys.node.children[control]!.dispatchEvent(
      Object.assign(new Event(type, { cancelable: true }), { pointerId: finger }),
    );
  return { said, keys, touch, state };
}

describe('buttons for fingers', () => {
  it('hold a control each, together, until the finger is lifted or lost', () => {
    const { said, keys, touch } = buttons();
    touch('pointerdown', 0, 1);
    touch('pointerdown', 1, 2);
    expect([...keys.heldControls()]).toEqual([0, 1]);
    touch('pointerup', 0, 1);
    touch('lostpointercapture', 0, 1);
    touch('pointercancel', 1, 2);
    expect(said).toEqual(['down 0', 'down 1', 'up 0', 'up 1']);
  });

  it('let go of everything at a pause, and press nothing while nothing flies', () => {
    const { said, keys, touch, state } = buttons();
    touch('pointerdown', 0);
    keys.releaseAll(0);
    touch('pointerup', 0);
    state.lives = false;
    touch('pointerdown', 0);
    expect(said).toEqual(['down 0', 'release-all']);
  });

  it('show an arrow where there is one, otherwise the name of the control', () => {
    const { keys } = buttons();
    expect([...keys.node.children].map((button) => button.textContent)).toEqual(['←', 'GRIP']);
    expect(keys.node.firstElementChild!.getAttribute('aria-label')).toBe('LEFT');
  });
});

it('labels are moved into the picture', () => {
  expect([within(5, 40, 390), within(200, 40, 390), within(380, 40, 390)]).toEqual([40, 200, 350]);
});

it('the card of an ending stands beside what is in its way', () => {
  expect([sideFor([0.5, 0.9]), sideFor([0.6, 0.3]), sideFor([0.2, 0.3]), sideFor(null)]).toEqual([
    'middle',
    'left',
    'right',
    'middle',
  ]);
});

it('the ready card names the keys that do the same', () => {
  expect(otherKeys(CONTROLS)).toBe('Also A. Esc pauses, O shows what the co-pilot does.');
  expect(otherKeys([])).toMatch(/^Esc/);
});

it('the panel has something to say before the first tick, also if it is opened only then', () => {
  const overlay = new Overlay();
  overlay.node.hidden = true;
  overlay.begin({ rule: 'misc' }, 0, [], ['left on', 'left off']);
  const chips = [...overlay.node.querySelectorAll('.chip')].map((chip) => chip.textContent);
  expect(chips).toEqual(['–', '–']);
});
