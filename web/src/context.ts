// What the views share.

import type { Core, Ending } from './core';
import type { Hangar } from './hangar';
import type { Link } from './link';

/** A view fills the space below the header, and lets go of everything when another takes its place. */
export interface View {
  readonly main: HTMLElement;
  readonly footer: HTMLElement;
  dispose(): void;
}

/** What happened since the page was opened. */
export interface Session {
  /** How the person's flights ended; what the robot flew alone is not theirs. */
  endings: Ending[];
  /** The record of the last flight. */
  last: Uint8Array | null;
}

export interface Context {
  core: Core;
  hangar: Hangar;
  link: Link;
  session: Session;
  /** What is to be done when other models are to be had; `learnt` if a flight taught them. */
  onModels: Set<(learnt: boolean) => void>;
  /** What is to be done when a flight was stored. */
  onStored: Set<(episode: number) => void>;
  /** Goes to another view: `fly`, `again`, `episodes` or `episodes/7`. */
  go(place: string): void;
}
