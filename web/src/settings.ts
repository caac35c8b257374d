// What the person chose, kept for the next visit.

import type { Inference, Rule } from './core';

export interface Settings {
  plant: string;
  actions: string;
  mode: Mode;
  inference: Inference;
  timeScale: number;
  overlay: boolean;
}

/** The modes a person can choose; `demo` is the robot alone. */
export type Mode = 'hic' | 'lasc' | 'misc' | 'misc-r' | 'demo';

export const MODES: { mode: Mode; label: string; title: string; rule: Rule }[] = [
  { mode: 'hic', label: 'Alone', title: 'HIC: you fly without help', rule: { rule: 'hic' } },
  { mode: 'lasc', label: 'Linear', title: 'LASC: the surer side flies', rule: { rule: 'lasc' } },
  { mode: 'misc', label: 'Minimal', title: 'MISC: the paper’s minimal intervention', rule: { rule: 'misc' } },
  { mode: 'misc-r', label: 'Minimal-R', title: 'MISC-R: minimal intervention with a regret threshold (recommended)', rule: { rule: 'misc-r', kappa: 0.7 } },
  { mode: 'demo', label: 'Robot', title: 'Watch the robot fly to your goal', rule: { rule: 'robot' } },
];

const KEY = 'cohelm.settings.1';

const USUAL: Settings = {
  plant: 'flag-lander', actions: 'switches', mode: 'misc-r', inference: 'calibrated', timeScale: 1, overlay: false,
};

export function loadSettings(): Settings {
  try {
    const kept: unknown = JSON.parse(localStorage.getItem(KEY) ?? '{}');
    return { ...USUAL, ...(typeof kept === 'object' && kept !== null ? kept : {}) } as Settings;
  } catch {
    return { ...USUAL };
  }
}

export function keepSettings(settings: Settings): void {
  try {
    localStorage.setItem(KEY, JSON.stringify(settings));
  } catch {
    // A browser that keeps nothing still flies.
  }
}
