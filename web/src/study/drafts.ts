// Answers that were given but not handed in yet, kept in this browser: a reload in the middle of a form loses nothing.

import type { Answer } from './steps';

/** The answers of one step so far. */
export class Draft {
  private readonly place: string;
  private answers: Record<string, Answer>;

  constructor(participant: string, step: string) {
    this.place = `cohelm.draft.1.${participant}.${step}`;
    this.answers = this.read();
  }

  of(item: string): Answer {
    return this.answers[item] ?? null;
  }

  set(item: string, answer: Answer): void {
    this.answers[item] = answer;
    try {
      localStorage.setItem(this.place, JSON.stringify(this.answers));
    } catch {
      // A browser that keeps nothing still hands in what is on the page.
    }
  }

  /** The step is done. */
  clear(): void {
    this.answers = {};
    try {
      localStorage.removeItem(this.place);
    } catch {
      // It was not kept.
    }
  }

  private read(): Record<string, Answer> {
    try {
      const kept: unknown = JSON.parse(localStorage.getItem(this.place) ?? '{}');
      return typeof kept === 'object' && kept !== null ? (kept as Record<string, Answer>) : {};
    } catch {
      return {};
    }
  }
}
