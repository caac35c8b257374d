// From a mouse, a finger or a pen to a stick, for axes: press anywhere on the picture, drag, let go. The stick stands
// where it was pressed and returns to its middle when it is let go of. Knows no plant, like the gamepad.

import type { Control } from './core';
import { element } from './dom';
import { stickOf, type Stick } from './gamepad';

/** How far a drag is for full deflection, CSS pixels: shorter is twitchy, longer runs off a phone. */
const REACH = 80;
/** Share of that within which an axis stays in its middle, so that a straight drag stays straight. */
const DEAD_ZONE = 0.1;
const MIDDLE: Stick = [0, 0, 0, 0];

/** How far one axis is deflected by a drag of so many pixels, −1 to 1. */
export function deflection(pixels: number): number {
  const part = Math.min(Math.max(pixels / REACH, -1), 1);
  const beyond = Math.abs(part) - DEAD_ZONE;
  return beyond <= 0 ? 0 : (Math.sign(part) * beyond) / (1 - DEAD_ZONE);
}

/** A stick under the pointer: asked before each tick, it tells what changed. */
export class PointerStick {
  private readonly knob = element('i', {});
  private readonly ring = element('div', { class: 'stick', 'aria-hidden': 'true', hidden: true }, this.knob);
  private readonly detachers: (() => void)[] = [];
  private pointer: number | null = null;
  private from: readonly [number, number] = [0, 0];
  private dragged: readonly [number, number] = [0, 0];
  private last: Stick = MIDDLE;

  /** `lives` says whether a press counts now. */
  constructor(
    private readonly surface: HTMLElement,
    private readonly controls: Control[],
    private readonly lives: () => boolean,
    private readonly move: (stick: Stick, atMs: number) => void,
  ) {}

  attach(): void {
    if (this.detachers.length > 0) return;
    this.surface.parentElement?.append(this.ring);
    // Without this a finger scrolls the page instead.
    this.surface.style.touchAction = 'none';
    this.listen('pointerdown', (event) => this.press(event));
    this.listen('pointermove', (event) => this.drag(event));
    for (const end of ['pointerup', 'pointercancel', 'lostpointercapture'] as const)
      this.listen(end, (event) => {
        if (event.pointerId === this.pointer) this.letGo();
      });
    this.listen('contextmenu', (event) => {
      if (this.pointer !== null) event.preventDefault();
    });
  }

  detach(): void {
    this.letGo();
    this.detachers.splice(0).forEach((detach) => detach());
    this.surface.style.touchAction = '';
    this.ring.remove();
  }

  /** Tells where the stick is, if it has moved since the last time. */
  poll(nowMs: number): void {
    const [across, down] = this.dragged;
    const stick = stickOf({ axes: [deflection(across), deflection(down)], buttons: [] }, this.controls);
    if (stick.every((axis, i) => axis === this.last[i])) return;
    this.last = stick;
    this.move(stick, nowMs);
  }

  /** Lets go, and says so if the stick was out of its middle; it counts again once it is pressed anew. */
  releaseAll(say: () => void): void {
    this.letGo();
    if (this.last.some((axis) => axis !== 0)) say();
    this.last = MIDDLE;
  }

  private listen<Name extends 'pointerdown' | 'pointermove' | 'pointerup' | 'contextmenu'>(
    name: Name | 'pointercancel' | 'lostpointercapture',
    listener: (event: PointerEvent) => void,
  ): void {
    const heard = (event: Event) => listener(event as PointerEvent);
    this.surface.addEventListener(name, heard);
    this.detachers.push(() => this.surface.removeEventListener(name, heard));
  }

  /** Only the first finger, and only a mouse's main button. */
  private press(event: PointerEvent): void {
    if (this.pointer !== null || event.button !== 0 || !this.lives()) return;
    event.preventDefault();
    this.pointer = event.pointerId;
    // A drag goes on outside the picture.
    this.surface.setPointerCapture?.(event.pointerId);
    this.from = [event.clientX, event.clientY];
    const { left, top } = this.surface.getBoundingClientRect();
    this.ring.style.left = `${event.clientX - left}px`;
    this.ring.style.top = `${event.clientY - top}px`;
    this.ring.hidden = false;
    this.show([0, 0]);
  }

  private drag(event: PointerEvent): void {
    if (event.pointerId !== this.pointer) return;
    this.show([event.clientX - this.from[0], event.clientY - this.from[1]]);
  }

  private letGo(): void {
    this.pointer = null;
    this.ring.hidden = true;
    this.dragged = [0, 0];
  }

  private show(dragged: readonly [number, number]): void {
    this.dragged = dragged;
    const [x, y] = dragged.map((pixels) => Math.min(Math.max(pixels, -REACH), REACH));
    this.knob.style.transform = `translate(${x}px, ${y}px)`;
  }
}
