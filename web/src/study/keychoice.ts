// The keys that a person flies with: the plant's, or those that they chose, kept in this browser.

import type { Control } from '../core';

const PLACE = 'cohelm.keys.1';
/** Keys that the page or the browser needs. */
const RESERVED = ['Escape', 'Enter', 'Tab', 'F5', 'F11', 'MetaLeft', 'MetaRight', 'ContextMenu', 'CapsLock'];

/** Whether a key may fly. */
export function isUsable(code: string): boolean {
  return code !== '' && !RESERVED.includes(code) && !/^(F\d+|Alt|Control|OS|Browser|Audio|Launch|Media)/.test(code);
}

/** Chosen keys by the names of controls. */
export class KeyChoice {
  private readonly place: string;
  private chosen: Record<string, string>;

  /** Of one participant: who uses this browser after them begins with the plant's keys. */
  constructor(participant: string) {
    this.place = `${PLACE}.${participant}`;
    this.chosen = load(this.place);
  }

  /** The controls with the keys that were chosen; a key that was given to another control is lost to its first. */
  readonly bind = (controls: Control[]): Control[] => {
    const given = controls.flatMap(({ name }) => this.chosen[name] ?? []);
    return controls.map((control) => {
      const own = this.chosen[control.name];
      return { ...control, keys: own === undefined ? control.keys.filter((key) => !given.includes(key)) : [own] };
    });
  };

  /** Whether any of these controls has another key than the plant gives it. */
  isRemapped(controls: Control[]): boolean {
    return controls.some(({ name }) => this.chosen[name] !== undefined);
  }

  /** Whether any control has another key than its plant gives it. */
  get isInUse(): boolean {
    return Object.keys(this.chosen).length > 0;
  }

  /** Gives a control a key; a control that had it as its only one gets the key that was given up. */
  choose(controls: Control[], name: string, code: string): void {
    const bound = this.bind(controls);
    const before = bound.find((control) => control.name === name)?.keys[0];
    const loser = bound.find(
      (control) => control.name !== name && control.keys.length === 1 && control.keys[0] === code,
    );
    this.chosen[name] = code;
    if (loser !== undefined && before !== undefined) this.chosen[loser.name] = before;
    save(this.place, this.chosen);
  }

  /** Back to the plant's keys. */
  reset(): void {
    this.chosen = {};
    save(this.place, this.chosen);
  }
}

function load(place: string): Record<string, string> {
  try {
    const kept = JSON.parse(localStorage.getItem(place) ?? '{}') as Record<string, unknown>;
    return Object.fromEntries(
      Object.entries(kept).filter(
        (entry): entry is [string, string] => typeof entry[1] === 'string' && isUsable(entry[1]),
      ),
    );
  } catch {
    return {};
  }
}

function save(place: string, chosen: Record<string, string>): void {
  try {
    localStorage.setItem(place, JSON.stringify(chosen));
  } catch {
    // Then they hold for this visit.
  }
}
