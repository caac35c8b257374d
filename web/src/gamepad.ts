// From a gamepad to a stick, for axes, or to controls, for everything that is on or off. Knows no plant: what a
// direction does follows from the arrow key that the loop binds to the same control.

import type { Control } from './core';
import type { KeyChange } from './keys';

/** A stick's position in the loop's numbers, each −32767 to 32767. */
export type Stick = readonly [number, number, number, number];

/** Coarser than a worn stick trembles, finer than a thumb can tell. */
const STEPS = 128;
/** How far a stick must be pushed to count as pressed. */
const PRESSED = 0.5;
/** How far it may stand from its middle to count as let go of: a worn stick does not come back to it. */
const DEAD_ZONE = 0.1;

/** What is read of a gamepad. */
export interface PadState {
  axes: readonly number[];
  buttons: readonly { pressed: boolean }[];
}

/** A pad that is not there any more holds nothing. */
const UNPLUGGED: PadState = { axes: [], buttons: [] };

const ARROWS = ['ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown'] as const;
type Arrow = (typeof ARROWS)[number];

/** How far a pad points in the direction of an arrow key, 0 to 1: left stick, cross, and the lower button for up. */
export function pointing(pad: PadState, arrow: Arrow): number {
  const [x, y] = [pad.axes[0] ?? 0, pad.axes[1] ?? 0];
  const along = { ArrowLeft: -x, ArrowRight: x, ArrowUp: -y, ArrowDown: y }[arrow];
  const buttons = { ArrowLeft: [14], ArrowRight: [15], ArrowUp: [12, 0], ArrowDown: [13] }[arrow];
  return buttons.some((index) => pad.buttons[index]?.pressed) ? 1 : Math.min(Math.max(along, 0), 1);
}

/** The stick of a pad for axes whose controls are listed in pairs, backwards and forwards. */
export function stickOf(pad: PadState, controls: Control[]): Stick {
  const push = (control: Control | undefined) => {
    const arrow = ARROWS.find((known) => control?.keys.includes(known));
    return arrow === undefined ? 0 : pointing(pad, arrow);
  };
  const axis = (i: number) => {
    const bound = [controls[2 * i], controls[2 * i + 1]].some((control) =>
      ARROWS.some((key) => control?.keys.includes(key)),
    );
    const along = bound
      ? push(controls[2 * i + 1]) - push(controls[2 * i])
      : 2 * i + 1 < controls.length
        ? (pad.axes[i] ?? 0)
        : 0;
    return Math.round((Math.round(along * STEPS) / STEPS) * 32767);
  };
  return [axis(0), axis(1), axis(2), axis(3)];
}

/** Asks the pads that are there, before each tick, and tells what changed. */
export class PadListener {
  private readonly held = new Set<number>();
  private last: Stick = [0, 0, 0, 0];
  /** After everything was let go of, until the pad is, too. */
  private waits = false;

  constructor(
    private readonly controls: Control[],
    private readonly hasAxes: boolean,
    private readonly press: KeyChange,
    private readonly move: (stick: Stick, atMs: number) => void,
    private readonly pads: () => (PadState | null)[] = () => [...(navigator.getGamepads?.() ?? [])],
  ) {}

  poll(nowMs: number): void {
    const pad = this.pads().find((pad) => pad !== null) ?? UNPLUGGED;
    if (this.waits && (pad === UNPLUGGED || !this.rests(pad))) return;
    this.waits = false;
    if (this.hasAxes) this.pollStick(pad, nowMs);
    else this.pollControls(pad, nowMs);
  }

  heldControls(): ReadonlySet<number> {
    return this.held;
  }

  /** Lets go of everything; what is still pushed counts anew at the next poll. */
  releaseAll(nowMs: number): void {
    if (this.held.size > 0 || this.last.some((axis) => axis !== 0)) this.press('release-all', 0, nowMs);
    this.held.clear();
    this.last = [0, 0, 0, 0];
  }

  /** Lets go of everything; the pad counts again once it has been let go of, too. */
  letGo(nowMs: number): void {
    this.releaseAll(nowMs);
    this.waits = true;
  }

  private rests(pad: PadState): boolean {
    return this.hasAxes
      ? stickOf(pad, this.controls).every((axis) => Math.abs(axis) <= DEAD_ZONE * 32767)
      : ARROWS.every((arrow) => pointing(pad, arrow) <= DEAD_ZONE);
  }

  private pollStick(pad: PadState, nowMs: number): void {
    const stick = stickOf(pad, this.controls);
    if (stick.every((axis, i) => axis === this.last[i])) return;
    this.last = stick;
    this.move(stick, nowMs);
  }

  private pollControls(pad: PadState, nowMs: number): void {
    this.controls.forEach((control, index) => {
      const pressed = ARROWS.some((arrow) => control.keys.includes(arrow) && pointing(pad, arrow) > PRESSED);
      if (pressed === this.held.has(index)) return;
      if (pressed) this.held.add(index);
      else this.held.delete(index);
      this.press(pressed ? 'down' : 'up', index, nowMs);
    });
  }
}

/** How often a pad is asked while nothing is flown, ms. */
const ASK_EVERY_MS = 50;
/** The lower button and the one that starts games, by the standard mapping. */
const CONFIRM = [0, 9];

/** Whether what a pad presses is meant for what lies behind: the page is to be seen, it has the focus, no dialog is open. */
function isMeant(): boolean {
  return !document.hidden && document.hasFocus() && document.querySelector('dialog[open]') === null;
}

/** Says when a pad confirms something: one of two buttons went down. A pad is read without any event, so that it would be
 * read also of somebody who looks at something else. */
export class PadConfirm {
  private held = true;
  private readonly timer: ReturnType<typeof setInterval>;

  constructor(
    private readonly confirm: () => void,
    private readonly pads: () => (PadState | null)[] = () => [...(navigator.getGamepads?.() ?? [])],
    private readonly meant = isMeant,
  ) {
    this.timer = setInterval(() => this.poll(), ASK_EVERY_MS);
  }

  dispose(): void {
    clearInterval(this.timer);
  }

  private poll(): void {
    const held = this.pads().some((pad) => CONFIRM.some((button) => pad?.buttons[button]?.pressed === true));
    if (held && !this.held && this.meant()) this.confirm();
    this.held = held;
  }
}
