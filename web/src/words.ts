// Words that several views share.

import type { Ending, Rule } from './core';
import type { Actions } from './rules';

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
  crash: 'Too hard, or beside the place for it. Gentler next time.',
  'out-of-bounds': 'There is a limit there. Keep further away from it.',
  'time-limit': 'It has to rest at the goal before the time is up.',
  abandoned: 'The flight ends here.',
};

/** What a flight needs to have its ending explained: who flew, and whether the person asked for anything. */
export interface Flier {
  robot: boolean;
  commands: number;
}

/** What an ending means, and what to do better: praise and advice only for who flew. */
export function endingHint(ending: Ending, { robot, commands }: Flier): string {
  const idle = !robot && commands === 0;
  if (ending === 'goal' && robot) return 'The robot rests at the goal that was marked.';
  if (ending === 'elsewhere' && robot) return 'The robot rests at another goal than the one that was marked.';
  if (ending === 'goal' && idle) return 'At rest at your goal, although you asked for nothing.';
  if (ending === 'elsewhere' && idle)
    return 'At rest at another goal than yours: you asked for nothing that tells which.';
  if (ending === 'crash' && robot) return 'Too hard, or beside the place for it.';
  return ENDING_HINTS[ending];
}

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
  'line-graph': 'line graph',
  threshold: 'threshold',
  hindsight: 'hindsight',
  misc: 'MISC',
  tolerance: 'tolerance',
  'misc-r': 'MISC-R',
  'misc-h': 'MISC-H',
  ida: 'IDA',
  'safe-nearest': 'safe-nearest',
};

/** What a rule does with commands, in one sentence. */
export const RULES: Record<Rule['rule'], string> = {
  hic: 'Human alone: what is asked is carried out.',
  robot: 'Robot alone: the best action, whatever is asked.',
  lasc: 'Linear: the robot’s command if c > 0.5, otherwise the person’s.',
  'line-graph':
    'Line graph: the robot’s command where it weighs more than half; its weight grows between two confidences.',
  threshold: 'Threshold: the robot takes over above a confidence.',
  hindsight: 'Hindsight optimisation: the best action on average over the goals.',
  misc: 'Minimal intervention: allowed is Q′ ≥ c · Q′max; of these the most similar.',
  tolerance: 'Constant tolerance: allowed is Q′ ≥ (1 − α) · Q′max; of these the most similar.',
  'misc-r': 'MISC-R: allowed is what costs at most κ · median range; of these the most similar.',
  'misc-h':
    'MISC-H: allowed is what costs at most κ · median range on average over the goals, less after an intervention.',
  ida: 'Act only if better: the robot’s action if it is better for every goal.',
  'safe-nearest': 'Safe-nearest: the most similar action after which the robot can still save the plant.',
};

/** What is otherwise where actions can be mixed (docs/arbitration.md). */
const BLENDS: Partial<Record<Rule['rule'], Record<Exclude<Actions, 'commands'>, string>>> = {
  lasc: {
    levers: 'Linear: each lever goes to the position nearest to c · robot + (1 − c) · person.',
    axes: 'Linear: on each axis c · robot + (1 − c) · person, with c the confidence.',
  },
  'line-graph': {
    levers: 'Line graph: as linear, each lever by itself; the robot’s weight grows between two confidences.',
    axes: 'Line graph: a mix on each axis, in which the robot’s weight grows between two confidences.',
  },
};

/** What a rule does with such actions, in one sentence. */
export function ruleSaid(rule: Rule['rule'], actions: Actions): string {
  return (actions === 'commands' ? undefined : BLENDS[rule]?.[actions]) ?? RULES[rule];
}

/** Signs of parameters that have one. */
export const SIGNS: Record<string, string> = { alpha: 'α', kappa: 'κ', confidence: 'c' };

/** A rule's parameters, such as `κ = 0.7`; empty if it has none. */
export function parametersOf(rule: Rule): string {
  const given = Object.entries(rule).filter((entry): entry is [string, number] => typeof entry[1] === 'number');
  return given.map(([name, value]) => `${SIGNS[name] ?? name} = ${value}`).join(', ');
}

/** Axes of the picture, as plants name what moves along them, in the words for its directions. */
const DIRECTIONS: Record<string, string> = { 'x −': 'left', 'x +': 'right', 'y −': 'down', 'y +': 'up' };

/** A control as people read it: a direction of the picture, or the plant's own name. */
export function directionOf(control: string): string {
  return DIRECTIONS[control] ?? control;
}

/** What a picture of a flight shows, for those who do not see it. */
export const CANVAS = 'What is steered, and the goals; your own is marked';

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
