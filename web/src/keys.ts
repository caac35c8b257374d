// From the keyboard to controls. Keys may be held together; auto-repeat is not a key press.

import type { Control, KeyKind } from './core';
import { isTheirs } from './dom';

export type KeyChange = (kind: KeyKind, control: number, atMs: number) => void;

/** While one of these is held, macOS tells nobody that other keys are released: a control would stay held for ever. */
const META = ['MetaLeft', 'MetaRight'];

/** Listens while attached, and says which control changed and when (by `event.timeStamp`). */
export class KeyListener {
  private readonly bindings = new Map<string, number>();
  private readonly held = new Map<string, number>();
  private readonly detachers: (() => void)[] = [];

  constructor(
    controls: Control[],
    private readonly change: KeyChange,
  ) {
    // A key moves one control: the first that has it.
    controls.forEach((control, index) =>
      control.keys.forEach((key) => {
        if (!this.bindings.has(key)) this.bindings.set(key, index);
      }),
    );
  }

  attach(target: Window): void {
    this.listen(target, 'keydown', (event) => this.down(event as KeyboardEvent));
    this.listen(target, 'keyup', (event) => this.up(event as KeyboardEvent));
    this.listen(target, 'blur', (event) => this.releaseAll(event.timeStamp));
    this.listen(target.document, 'visibilitychange', (event) => this.releaseAll(event.timeStamp));
  }

  detach(): void {
    this.detachers.splice(0).forEach((detach) => detach());
    this.held.clear();
  }

  /** Numbers of the controls that are held. */
  heldControls(): ReadonlySet<number> {
    return new Set(this.held.values());
  }

  releaseAll(atMs: number): void {
    if (this.held.size === 0) return;
    this.held.clear();
    this.change('release-all', 0, atMs);
  }

  private listen(target: EventTarget, name: string, listener: (event: Event) => void): void {
    target.addEventListener(name, listener);
    this.detachers.push(() => target.removeEventListener(name, listener));
  }

  /** A key that a button or a list has a use for is left to it while it has the focus. */
  private down(event: KeyboardEvent): void {
    if (META.includes(event.code)) this.releaseAll(event.timeStamp);
    const control = this.bindings.get(event.code);
    if (control === undefined || event.ctrlKey || event.metaKey || event.altKey || isTheirs(event)) return;
    event.preventDefault();
    if (event.repeat || this.held.has(event.code)) return;
    const already = this.heldControls().has(control);
    this.held.set(event.code, control);
    if (!already) this.change('down', control, event.timeStamp);
  }

  /** A control is released when the last of its keys is. */
  private up(event: KeyboardEvent): void {
    if (META.includes(event.code)) this.releaseAll(event.timeStamp);
    const control = this.held.get(event.code);
    if (control === undefined) return;
    this.held.delete(event.code);
    if (!this.heldControls().has(control)) this.change('up', control, event.timeStamp);
  }
}

/** What a key is called on a key cap. */
export function keyCap(code: string): string {
  const arrows: Record<string, string> = { ArrowLeft: '←', ArrowRight: '→', ArrowUp: '↑', ArrowDown: '↓' };
  return arrows[code] ?? code.replace(/^(Key|Digit)/, '');
}

/** Which keys do the same as those that are shown, and what the others do. */
export function otherKeys(controls: Control[]): string {
  const second = controls.flatMap(({ keys }) => keys.slice(1, 2));
  const same = second.length === 0 ? '' : `Also ${second.map(keyCap).join(', ')}. `;
  return `${same}Esc pauses, O shows what the co-pilot does.`;
}

/** The same in words, for those who hear the page. */
export function keyName(code: string): string {
  return code
    .replace(/^(Key|Digit)/, '')
    .replace(/^Arrow/, 'arrow ')
    .toLowerCase();
}
