// Buttons to press and hold, one for each control: what has no keyboard steers by them. They are seen only where a finger
// is what points (flight.css).

import type { Control } from './core';
import { element } from './dom';
import { keyCap, type KeyChange } from './keys';

/** A control is held while at least one finger presses its button. */
export class TouchKeys {
  readonly node = element('div', { class: 'touch-keys' });
  private readonly held = new Map<number, number>();

  /** `lives` says whether a press counts now; `nameOf` what a control is called for people. */
  constructor(
    controls: Control[],
    private readonly lives: () => boolean,
    private readonly change: KeyChange,
    nameOf: (control: string) => string,
  ) {
    this.node.append(...controls.map((control, index) => this.button(control, index, nameOf(control.name))));
  }

  /** Numbers of the controls that are held. */
  heldControls(): ReadonlySet<number> {
    return new Set(this.held.values());
  }

  /** Lets go of everything; a finger that still presses counts again when it presses anew. */
  releaseAll(atMs: number): void {
    if (this.held.size === 0) return;
    this.held.clear();
    this.change('release-all', 0, atMs);
  }

  private button({ keys, name }: Control, index: number, label: string): HTMLButtonElement {
    const cap = keyCap(keys[0] ?? '?');
    // An arrow says by itself what it does; a letter does not.
    const text = /^[←→↑↓]$/.test(cap) ? cap : label;
    const made = element('button', { type: 'button', tabindex: '-1', 'aria-label': label, title: name }, text);
    made.addEventListener('pointerdown', (event) => {
      event.preventDefault();
      made.setPointerCapture?.(event.pointerId);
      this.down(event.pointerId, index, event.timeStamp);
    });
    for (const end of ['pointerup', 'pointercancel', 'lostpointercapture'] as const)
      made.addEventListener(end, (event) => this.up(event.pointerId, event.timeStamp));
    made.addEventListener('contextmenu', (event) => event.preventDefault());
    return made;
  }

  private down(finger: number, control: number, atMs: number): void {
    if (!this.lives()) return;
    const already = this.heldControls().has(control);
    this.held.set(finger, control);
    if (!already) this.change('down', control, atMs);
  }

  private up(finger: number, atMs: number): void {
    const control = this.held.get(finger);
    if (control === undefined) return;
    this.held.delete(finger);
    if (!this.heldControls().has(control)) this.change('up', control, atMs);
  }
}
