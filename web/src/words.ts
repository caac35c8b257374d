// Words that several views share.

import type { Ending, Rule } from './core';

/** A headline after a flight. */
export const ENDINGS: Record<Ending, string> = {
  goal: 'At your goal',
  elsewhere: 'Somewhere else',
  crash: 'Crashed',
  'out-of-bounds': 'Out of bounds',
  'time-limit': 'Out of time',
  abandoned: 'Stopped',
};

/** What it means, and what to do better. */
export const ENDING_HINTS: Record<Ending, string> = {
  goal: 'At rest, just where you wanted to be.',
  elsewhere: 'Well done, but at another goal than yours.',
  crash: 'That was too hard. Gentler next time.',
  'out-of-bounds': 'The sides are hatched when you come near.',
  'time-limit': 'It has to rest at the goal before the time is up.',
  abandoned: 'The flight ends here.',
};

/** A sign and a word for it in lists; the sign says the same as the colour. */
export const ENDING_WORDS: Record<Ending, { sign: string; word: string }> = {
  goal: { sign: '●', word: 'at the goal' },
  elsewhere: { sign: '◐', word: 'elsewhere' },
  crash: { sign: '✕', word: 'crashed' },
  'out-of-bounds': { sign: '◁', word: 'out of bounds' },
  'time-limit': { sign: '◌', word: 'time limit' },
  abandoned: { sign: '–', word: 'stopped' },
};

/** Short names of the rules. */
export const RULE_NAMES: Record<Rule['rule'], string> = {
  hic: 'HIC',
  robot: 'robot',
  lasc: 'LASC',
  misc: 'MISC',
  tolerance: 'tolerance',
  'misc-r': 'MISC-R',
};

/** What a rule does, in one sentence. */
export const RULES: Record<Rule['rule'], string> = {
  hic: 'Human alone: what is asked is carried out.',
  robot: 'Robot alone: the best action, whatever is asked.',
  lasc: 'Linear: the robot’s action if c > 0.5, otherwise the person’s.',
  misc: 'Minimal intervention: allowed is Q′ ≥ c · Q′max; of these the most similar.',
  tolerance: 'Constant tolerance: allowed is Q′ ≥ (1 − α) · Q′max; of these the most similar.',
  'misc-r': 'MISC-R: allowed is what costs at most κ · median range; of these the most similar.',
};

/** How axes are steered without keys. */
export const DRAG = 'Or press on the picture and drag: a stick under your mouse or finger.';

/** Why something failed, in words. */
export function reasonOf(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}

/** The same as a sentence: messages begin small and have no full stop, so that they can be part of others. */
export function sentence(text: string): string {
  const whole = text.charAt(0).toUpperCase() + text.slice(1);
  return /[.!?]$/.test(whole) ? whole : `${whole}.`;
}
