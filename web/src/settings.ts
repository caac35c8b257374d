// What the person chose, kept for the next visit.

import type { Inference } from './core';
import { INFERENCES, usualRules, type RuleWord } from './rules';
import { RULE_NAMES, RULES } from './words';

export interface Settings {
  plant: string;
  actions: string;
  mode: Mode;
  /** The rule that is flown in the mode `other`. */
  other: RuleWord;
  /** Parameters that were chosen, by `placeOf`; the usual ones where there are none. */
  parameters: Record<string, Record<string, number>>;
  inference: Inference;
  /** Hash of the values to fly with; the usual ones if empty, or if they do not fit. */
  values: string;
  timeScale: number;
  overlay: boolean;
}

/** The modes a person can choose; `demo` is the robot alone, `other` a rule that has no button of its own. */
export type Mode = 'hic' | 'lasc' | 'misc' | 'misc-r' | 'misc-h' | 'other' | 'demo';

/** What a mode is called and does, and by which rule. */
export interface ModeEntry {
  mode: Mode;
  label: string;
  title: string;
  word: RuleWord;
}

export const MODES: ModeEntry[] = [
  { mode: 'hic', label: 'Alone', title: 'HIC: you fly without help', word: 'hic' },
  { mode: 'lasc', label: 'Linear', title: 'LASC: the co-pilot flies when it is sure of your goal', word: 'lasc' },
  { mode: 'misc', label: 'Minimal', title: 'MISC: the co-pilot changes only what is bad for your goal', word: 'misc' },
  {
    mode: 'misc-r',
    label: 'Minimal-R',
    title: 'MISC-R: the co-pilot changes only what would cost too much',
    word: 'misc-r',
  },
  {
    mode: 'misc-h',
    label: 'Minimal-H',
    title: 'MISC-H: the co-pilot changes only what would cost too much for all goals that you may want',
    word: 'misc-h',
  },
  { mode: 'demo', label: 'Robot', title: 'Watch the robot fly to the goal', word: 'robot' },
];

/** The mode that is chosen. A rule without a button is a mode of its own. */
export function modeOf({ mode, other }: Pick<Settings, 'mode' | 'other'>): ModeEntry {
  if (mode === 'other') {
    const name = RULE_NAMES[other];
    const label = name.charAt(0).toUpperCase() + name.slice(1);
    return { mode, label, title: RULES[other], word: other };
  }
  return MODES.find((known) => known.mode === mode) ?? MODES[0]!;
}

/** The mode in which a person flies by that rule: its button, or the one for all others. */
export function modeBy(word: RuleWord): Pick<Settings, 'mode'> & Partial<Settings> {
  const button = MODES.find((known) => known.word === word && known.mode !== 'demo');
  return button === undefined ? { mode: 'other', other: word } : { mode: button.mode };
}

/** Where the parameters that a person chose for a rule are kept: what suits one set of actions is wrong for another. */
export function placeOf(task: { plant: string; actions: string }, word: RuleWord): string {
  return `${task.plant}/${task.actions}/${word}`;
}

export const TIME_SCALES: [string, string][] = [
  ['1', '1×'],
  ['0.75', '¾×'],
  ['0.5', '½×'],
  ['0.25', '¼×'],
];

const PLACE = 'cohelm.settings.1';

const USUAL: Settings = {
  plant: '',
  actions: '',
  mode: 'misc-r',
  other: 'hindsight',
  parameters: {},
  inference: 'calibrated',
  values: '',
  timeScale: 1,
  overlay: false,
};

/** What was kept, as far as it makes sense. */
export function loadSettings(): Settings {
  const settings = { ...USUAL, parameters: {} };
  try {
    const kept = JSON.parse(localStorage.getItem(PLACE) ?? '{}') as Record<string, unknown>;
    for (const [name, usual] of Object.entries(USUAL)) {
      if (typeof kept[name] === typeof usual && kept[name] !== null) Object.assign(settings, { [name]: kept[name] });
    }
  } catch {
    // Settings that cannot be read are the usual ones.
  }
  if (settings.mode !== 'other' && !MODES.some((known) => known.mode === settings.mode)) settings.mode = USUAL.mode;
  if (!usualRules('commands').some(({ rule }) => rule === settings.other)) settings.other = USUAL.other;
  if (!INFERENCES.some(([inference]) => inference === settings.inference)) settings.inference = USUAL.inference;
  if (!TIME_SCALES.some(([scale]) => Number(scale) === settings.timeScale)) settings.timeScale = USUAL.timeScale;
  return settings;
}

export function keepSettings(settings: Settings): void {
  try {
    localStorage.setItem(PLACE, JSON.stringify(settings));
  } catch {
    // A browser that keeps nothing still flies.
  }
}
