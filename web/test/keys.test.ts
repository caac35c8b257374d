import { describe, expect, it, vi } from 'vitest';
import type { Control } from '../src/core';
import { PadConfirm, pointing, PadListener, stickOf, type PadState } from '../src/gamepad';
import { keyCap, KeyListener } from '../src/keys';

const CONTROLS: Control[] = [
  { name: 'left', keys: ['ArrowLeft', 'KeyA'] },
  { name: 'main', keys: ['ArrowUp', 'KeyW', 'Space'] },
];

/** A window that keys are struck at, and what the listener said of it. */
function keyboard() {
  const window = Object.assign(new EventTarget(), { document: new EventTarget() });
  const said: string[] = [];
  const listener = new KeyListener(CONTROLS, (kind, control) =>
    said.push(kind === 'release-all' ? kind : `${kind} ${control}`),
  );
  listener.attach(window as unknown as Window);
  const strike = (type: string, code: string, more: object = {}) => {
    const event = Object.assign(new Event(type, { cancelable: true }), { code, repeat: false, ...more });
    window.dispatchEvent(event);
    return event;
  };
  return {
    said,
    listener,
    window,
    down: (code: string, more?: object) => strike('keydown', code, more),
    up: (code: string) => strike('keyup', code),
  };
}

describe('the keyboard', () => {
  it('tells keys that are held together apart', () => {
    const { said, down, up, listener } = keyboard();
    down('ArrowLeft');
    down('ArrowUp');
    expect([...listener.heldControls()]).toEqual([0, 1]);
    up('ArrowLeft');
    up('ArrowUp');
    expect(said).toEqual(['down 0', 'down 1', 'up 0', 'up 1']);
  });

  it('takes auto-repeat for no key press', () => {
    const { said, down } = keyboard();
    down('ArrowUp');
    down('ArrowUp', { repeat: true });
    down('ArrowUp', { repeat: true });
    expect(said).toEqual(['down 1']);
  });

  it('releases a control with the last of its keys', () => {
    const { said, down, up } = keyboard();
    down('ArrowUp');
    down('KeyW');
    up('ArrowUp');
    expect(said).toEqual(['down 1']);
    up('KeyW');
    expect(said).toEqual(['down 1', 'up 1']);
  });

  it.each(['blur', 'visibilitychange'])('releases everything at %s, once', (type) => {
    const { said, down, up, window } = keyboard();
    const target = type === 'blur' ? window : window.document;
    down('ArrowUp');
    target.dispatchEvent(new Event(type));
    target.dispatchEvent(new Event(type));
    up('ArrowUp');
    expect(said).toEqual(['down 1', 'release-all']);
  });

  it.each(['MetaLeft', 'MetaRight'])('releases everything at %s, while which macOS tells of no release', (code) => {
    const { said, down, up } = keyboard();
    down('ArrowUp');
    down(code, { metaKey: true });
    expect(said).toEqual(['down 1', 'release-all']);
    down('ArrowLeft');
    up(code);
    expect(said).toEqual(['down 1', 'release-all', 'down 0', 'release-all']);
  });

  it('gives a key to the first control that has it', () => {
    const window = Object.assign(new EventTarget(), { document: new EventTarget() });
    const said: string[] = [];
    const both = CONTROLS.map(({ name }) => ({ name, keys: ['ArrowUp'] }));
    new KeyListener(both, (kind, control) => said.push(`${kind} ${control}`)).attach(window as unknown as Window);
    window.dispatchEvent(Object.assign(new Event('keydown'), { code: 'ArrowUp' }));
    expect(said).toEqual(['down 0']);
  });

  it('leaves other keys and shortcuts of the browser alone', () => {
    const { said, down } = keyboard();
    expect(down('KeyX').defaultPrevented).toBe(false);
    expect(down('KeyA', { ctrlKey: true }).defaultPrevented).toBe(false);
    expect(down('Space').defaultPrevented).toBe(true);
    expect(said).toEqual(['down 1']);
  });

  it('hears nothing once it is detached', () => {
    const { said, down, listener } = keyboard();
    down('ArrowUp');
    listener.detach();
    down('ArrowLeft');
    expect(said).toEqual(['down 1']);
    expect(listener.heldControls().size).toBe(0);
  });

  it('names keys as they are printed on them', () => {
    expect(['ArrowUp', 'KeyW', 'Digit1', 'Space'].map(keyCap)).toEqual(['↑', 'W', '1', 'Space']);
  });
});

function pad(axes: number[], pressed: number[] = []): PadState {
  return { axes, buttons: Array.from({ length: 16 }, (_, i) => ({ pressed: pressed.includes(i) })) };
}

const AXES: Control[] = [
  { name: 'y −', keys: ['ArrowDown'] },
  { name: 'y +', keys: ['ArrowUp'] },
  { name: 'x −', keys: ['ArrowLeft'] },
  { name: 'x +', keys: ['ArrowRight'] },
];

describe('a gamepad', () => {
  it('points with its stick, its cross, or its lower button', () => {
    expect(pointing(pad([-0.75, 0]), 'ArrowLeft')).toBe(0.75);
    expect(pointing(pad([-0.75, 0]), 'ArrowRight')).toBe(0);
    expect(pointing(pad([0, 0], [0]), 'ArrowUp')).toBe(1);
    expect(pointing(pad([0, 0], [15]), 'ArrowRight')).toBe(1);
  });

  it('moves axes by the arrows that the loop binds to them: up is up', () => {
    expect(stickOf(pad([0.5, -1]), AXES)).toEqual([32767, 16384, 0, 0]);
  });

  it('tells a move once, and everything released at a pause', () => {
    const said: unknown[] = [];
    let now = pad([0, 0]);
    const listener = new PadListener(
      AXES,
      true,
      (kind) => said.push(kind),
      (stick) => said.push(stick),
      () => [null, now],
    );
    listener.poll(0);
    now = pad([0, -1]);
    listener.poll(20);
    listener.poll(40);
    listener.releaseAll(60);
    listener.releaseAll(80);
    expect(said).toEqual([[32767, 0, 0, 0], 'release-all']);
  });

  it('counts again after a letting go only once it was let go of, too', () => {
    const said: string[] = [];
    let now = pad([0, 0], [0]);
    const listener = new PadListener(
      CONTROLS,
      false,
      (kind, control) => said.push(`${kind} ${control}`),
      () => {},
      () => [now],
    );
    const show = (state: PadState) => {
      now = state;
      listener.poll(0);
    };
    show(pad([0, 0], [0]));
    listener.letGo(20);
    show(pad([0, 0], [0]));
    show(pad([-0.9, 0]));
    show(pad([0.05, 0]));
    show(pad([-0.9, 0]));
    expect(said).toEqual(['down 1', 'release-all 0', 'down 0']);
  });

  it('presses controls where there are no axes', () => {
    const said: string[] = [];
    let now = pad([0, 0], [0]);
    const listener = new PadListener(
      CONTROLS,
      false,
      (kind, control) => said.push(`${kind} ${control}`),
      () => {},
      () => [now],
    );
    listener.poll(0);
    listener.poll(20);
    now = pad([-0.9, 0]);
    listener.poll(40);
    expect(said).toEqual(['down 1', 'down 0', 'up 1']);
  });

  it('confirms when its lower button or its start button goes down, not while one is held from before', () => {
    vi.useFakeTimers();
    let now = pad([0, 0], [0]);
    let meant = true;
    const confirmed: boolean[] = [];
    const listener = new PadConfirm(
      () => confirmed.push(true),
      () => [null, now],
      () => meant,
    );
    const show = (...pressed: number[]) => {
      now = pad([0, 0], pressed);
      vi.advanceTimersByTime(100);
      return confirmed.length;
    };
    expect([show(0), show(), show(0), show(0), show(3), show(9)]).toEqual([0, 0, 1, 1, 1, 2]);
    // Behind a dialog, or in a window without the focus, nothing is confirmed; nor by what is still held afterwards.
    meant = false;
    expect([show(), show(0)]).toEqual([2, 2]);
    meant = true;
    expect(show(0)).toBe(2);
    listener.dispose();
    expect([show(), show(0)]).toEqual([2, 2]);
    vi.useRealTimers();
  });
});
