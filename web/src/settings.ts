// What the person chose, kept for the next visit.

import type { Inference, Rule } from './core';

export interface Settings {
  plant: string;
  actions: string;
  mode: Mode;
  inference: Inference;
  /** Hash of the values to fly with; the usual ones if empty, or if they do not fit. */
  values: string;
  timeScale: number;
  overlay: boolean;
}

/** The modes a person can choose; `demo` is the robot alone. */
export type Mode = 'hic' | 'lasc' | 'misc' | 'misc-r' | 'demo';

/** What a mode is called and does, and what it needs: nothing, values of any kind, or values whose usual range is known. */
export interface ModeEntry {
  mode: Mode;
  label: string;
  title: string;
  rule: Rule;
  needs: 'nothing' | 'values' | 'model';
}

export const MODES: ModeEntry[] = [
  { mode: 'hic', label: 'Alone', title: 'HIC: you fly without help', rule: { rule: 'hic' }, needs: 'nothing' },
  {
    mode: 'lasc',
    label: 'Linear',
    title: 'LASC: the co-pilot flies when it is sure of your goal',
    rule: { rule: 'lasc' },
    needs: 'values',
  },
  {
    mode: 'misc',
    label: 'Minimal',
    title: 'MISC: the co-pilot changes only what is bad for your goal',
    rule: { rule: 'misc' },
    needs: 'values',
  },
  {
    mode: 'misc-r',
    label: 'Minimal-R',
    title: 'MISC-R: the co-pilot changes only what would cost too much',
    rule: { rule: 'misc-r', kappa: 0.7 },
    needs: 'model',
  },
  { mode: 'demo', label: 'Robot', title: 'Watch the robot fly to the goal', rule: { rule: 'robot' }, needs: 'values' },
];

export const INFERENCES: [Inference, string][] = [
  ['calibrated', 'calibrated'],
  ['softmax', 'softmax of distances'],
  ['inverse-distance', 'inverse distance (the paper’s)'],
  ['bayesian', 'by the values'],
  ['calibrated-bayesian', 'calibrated × by the values'],
  ['imagined', 'imagined: knows no goals'],
  ['nearest', 'nearest goal'],
];

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
  inference: 'calibrated',
  values: '',
  timeScale: 1,
  overlay: false,
};

/** What was kept, as far as it makes sense. */
export function loadSettings(): Settings {
  const settings = { ...USUAL };
  try {
    const kept = JSON.parse(localStorage.getItem(PLACE) ?? '{}') as Record<string, unknown>;
    for (const [name, usual] of Object.entries(USUAL)) {
      if (typeof kept[name] === typeof usual) Object.assign(settings, { [name]: kept[name] });
    }
  } catch {
    // Settings that cannot be read are the usual ones.
  }
  if (!MODES.some((known) => known.mode === settings.mode)) settings.mode = USUAL.mode;
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
