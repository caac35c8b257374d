// What a person steers a plant elsewhere by: keys, a gamepad, a drag. Only while the page is to be seen and has the focus;
// once it was let go of, everything must be pressed anew.

import type { Control, KeyKind } from './core';
import { isAttended } from './external';
import { PadListener, type Stick } from './gamepad';
import { KeyListener } from './keys';
import { PointerStick } from './pointer';
import { TouchKeys } from './touch';
import { directionOf } from './words';

/** How often sticks are asked, ms. */
const ASK_EVERY_MS = 20;

/** Who is told what the hands do. */
export interface Told {
  key(kind: KeyKind, control: number, atMs: number): void;
  stick(stick: Stick, atMs: number): void;
}

export class Hands {
  private readonly keys: KeyListener;
  private readonly pad: PadListener;
  private readonly pointer: PointerStick | null;
  private readonly touch: TouchKeys;
  private timer = 0;

  /** `surface` is where a drag begins, if the plant has axes; `place` has the buttons for fingers. */
  constructor(
    controls: Control[],
    surface: HTMLElement | null,
    private readonly told: Told,
    private readonly attended = isAttended,
    place: HTMLElement | null = null,
  ) {
    const key = told.key.bind(told);
    const stick = told.stick.bind(told);
    this.keys = new KeyListener(controls, key);
    this.pad = new PadListener(controls, surface !== null, key, stick);
    this.pointer = surface && new PointerStick(surface, controls, () => this.timer !== 0, stick);
    this.touch = new TouchKeys(controls, () => this.timer !== 0, key, directionOf);
    place?.append(this.touch.node);
  }

  attach(): void {
    if (this.timer !== 0) return;
    // What was pushed before the start must be let go of and pushed again.
    this.pad.letGo(performance.now());
    this.keys.attach(window);
    this.pointer?.attach();
    this.timer = window.setInterval(() => this.ask(), ASK_EVERY_MS);
  }

  detach(): void {
    clearInterval(this.timer);
    this.timer = 0;
    this.keys.detach();
    this.pointer?.detach();
    this.touch.node.remove();
  }

  /** Lets go of everything. Nothing that is still held counts until it was let go of and pressed again. */
  letGo(): void {
    const now = performance.now();
    this.keys.releaseAll(now);
    this.pad.letGo(now);
    this.touch.releaseAll(now);
    this.pointer?.releaseAll(() => this.told.key('release-all', 0, now));
  }

  held(): ReadonlySet<number> {
    return new Set([...this.keys.heldControls(), ...this.pad.heldControls(), ...this.touch.heldControls()]);
  }

  /** A stick is read without any event, so that it would be read also of somebody who looks at something else. */
  private ask(): void {
    if (!this.attended()) {
      this.letGo();
      return;
    }
    const now = performance.now();
    this.pad.poll(now);
    this.pointer?.poll(now);
  }
}
