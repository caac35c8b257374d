// What the desk's views share.

import type { Core } from '../core';
import type { Hangar } from '../hangar';
import type { Feed } from './feed';
import type { Peek } from './peek';

/** A view fills the space below the header, and lets go of everything when another takes its place. */
export interface DeskView {
  readonly main: HTMLElement;
  dispose(): void;
}

export interface Desk {
  feed: Feed;
  /** Whether lists show outcomes. */
  peek: Peek;
  /** The loop and what it can fly with; loaded when a flight is first looked at. */
  loop(): Promise<{ core: Core; second: Core; hangar: Hangar }>;
  /** Goes to another view: `overview`, `people`, `people/7`, `watch/7`, `episodes`, `episodes/31`. */
  go(place: string): void;
}
