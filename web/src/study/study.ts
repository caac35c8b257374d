// What the screens of a study share.

import { element } from '../dom';
import type { Deck } from '../../jspsych-cohelm/src';
import type { KeyChoice } from './keychoice';
import type { Place, Taken } from './place';
import type { FlightStep, Step } from './steps';
import type { Words } from './text';

export interface Study {
  readonly place: Place;
  readonly words: Words;
  readonly deck: Deck;
  readonly keys: KeyChoice;
  /** Of the display, once it was measured, Hz. */
  refreshHz: number | null;
  /** The flight came into the air, or left it. */
  inTheAir(flying: boolean): void;
  /** A screen cannot go on; the person is told, and offered to open the page anew. */
  failed(error: unknown): void;
}

/** Shows a step and is over when the server has what it gave. */
export type Screen<Kind extends Step['kind']> = (
  root: HTMLElement,
  step: Extract<Step, { kind: Kind }>,
  study: Study,
) => Promise<void>;

/** Hands in what a step gave, with the time for which it was shown. */
export function handIn(study: Study, step: Step, data: unknown, shownAt: number): Promise<Taken> {
  return study.place.answer(step.id, data, performance.now() - shownAt);
}

/** The next flight that remains; its task is what this study flies. */
export function nextFlight(study: Study): FlightStep | null {
  return study.place.session.steps.find((step) => step.kind === 'flight') ?? null;
}

/** Fills the page with a sheet of text, whose heading gets the focus, so that it is read to those who hear the page. */
export function showSheet(root: HTMLElement, kind: string, title: string, ...content: (Node | string)[]): HTMLElement {
  const heading = element('h1', { tabindex: '-1' }, title);
  const sheet = element('article', { class: 'leaf', 'data-screen': kind }, heading, ...content);
  root.replaceChildren(sheet);
  root.scrollTop = 0;
  heading.focus({ preventScroll: true });
  return sheet;
}

/** Waits for a press of a button. */
export function pressed(button: HTMLButtonElement): Promise<void> {
  return new Promise((resolve) => button.addEventListener('click', () => resolve(), { once: true }));
}

/** The button that leads on. */
export function forward(label: string, attributes: Record<string, string | boolean> = {}): HTMLButtonElement {
  return element('button', { type: 'button', class: 'primary large', ...attributes }, label);
}
