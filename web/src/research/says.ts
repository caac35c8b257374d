// The desk's words: what a status, a step and an event are called, and when something was.

import type { Ending } from '../core';
import { ENDING_WORDS } from '../words';
import type { Logged, Status } from './deskapi';
import { isMeasured } from './peek';

/** A sign and a word for each status; the sign says the same as the colour. */
export const STATUS: Record<Status, { sign: string; word: string }> = {
  invited: { sign: '○', word: 'invited' },
  'under-way': { sign: '◐', word: 'under way' },
  completed: { sign: '●', word: 'completed' },
  excluded: { sign: '⊘', word: 'excluded' },
  withdrawn: { sign: '✕', word: 'withdrawn' },
  declined: { sign: '–', word: 'declined' },
};
export const STATUSES = Object.keys(STATUS) as Status[];

/** `block-1/flight-3` as `block 1 · flight 3`. */
export function stepWords(step: string): string {
  return step
    .split('/')
    .filter((part) => part !== 'questionnaire')
    .map((part) => part.replace(/-(\d+)$/, ' $1'))
    .join(' · ');
}

/** How long ago something was, in the largest unit that says enough. */
export function ago(at_ms: number, now_ms: number): string {
  const seconds = Math.max(0, Math.round((now_ms - at_ms) / 1000));
  if (seconds < 10) return 'now';
  if (seconds < 60) return `${seconds} s ago`;
  if (seconds < 3600) return `${Math.floor(seconds / 60)} min ago`;
  if (seconds < 86_400) return `${Math.floor(seconds / 3600)} h ago`;
  return `${Math.floor(seconds / 86_400)} d ago`;
}

/** The time of day, with the date unless it is today's. */
export function clock(at_ms: number, now_ms: number): string {
  const [at, now] = [new Date(at_ms), new Date(now_ms)];
  const time = at.toLocaleTimeString([], { hour: '2-digit', minute: '2-digit', second: '2-digit', hourCycle: 'h23' });
  return at.toDateString() === now.toDateString() ? time : `${at.toLocaleDateString()} ${time}`;
}

const text = (value: unknown): string => (typeof value === 'string' || typeof value === 'number' ? String(value) : '');

/** What an event says: a headline, and what one may want to know besides; how a measured flight ended may be kept back. */
export function eventWords({ event, ...fields }: Logged, isCovered = false): { what: string; detail: string } {
  const field = (name: string) => text(fields[name]);
  const step = stepWords(field('step'));
  const seconds = (ticks: unknown) => (typeof ticks === 'number' ? `tick ${ticks}` : '');
  const by = field('by') === '' ? '' : `by ${field('by')}`;
  const known: Record<string, () => [string, string]> = {
    invited: () => ['invited', [fields['test'] === true ? 'test' : '', field('note')].filter(Boolean).join(' · ')],
    assigned: () => ['assigned', `cell ${field('cell')}`],
    opened: () => ['opened the page', ''],
    'taken-over': () => ['went on in another tab', ''],
    'step-done': () => [`done: ${step}`, ''],
    'quiz-missed': () => ['missed in the quiz', Array.isArray(fields['wrong']) ? fields['wrong'].join(', ') : ''],
    declined: () => ['declined', ''],
    'flight-begun': () => [`took off: ${step}`, `episode ${field('episode')}`],
    'flight-interrupted': () => [`interrupted: ${step}`, `${seconds(fields['tick'])} · ${field('reason')}`],
    'flight-resumed': () => [
      `resumed: ${step}`,
      `${seconds(fields['tick'])} · from the ${field('source')}, away ${Math.round(Number(fields['away_ms'] ?? 0) / 1000)} s`,
    ],
    'flight-ended': () => {
      if (isCovered && isMeasured(fields['step'])) return [`ended: ${step}`, ''];
      const ending = ENDING_WORDS[fields['ending'] as Ending];
      return [`ended: ${step}`, `${ending === undefined ? field('ending') : `${ending.sign} ${ending.word}`}`];
    },
    'flight-refused': () => [`refused: ${step}`, field('reason')],
    'flight-noted': () => [`telemetry: ${step}`, ''],
    completed: () => ['completed', field('code') === '' ? '' : `code ${field('code')}`],
    excluded: () => ['excluded', [field('reason'), by].filter(Boolean).join(' · ')],
    reinstated: () => ['reinstated', by],
    withdrawn: () => ['withdrawn', by],
    note: () => [`“${field('text')}”`, by],
  };
  const [what, detail] = known[event]?.() ?? [event.replaceAll('-', ' '), step];
  return { what, detail };
}

/** Events that a person at the desk looks for; the rest is for the log. */
export function isNews({ event }: Logged): boolean {
  return !['flight-noted', 'opened', 'assigned', 'flight-begun'].includes(event);
}
