// What can be flown here, and with which models. Knows no plant: which options a plant takes, and whether two tasks
// have the same actions, is tried out in a loop of its own.

import { listModels, modelBytes, type ModelEntry } from './api';
import type { About, Control, Core, Inference, Setup } from './core';

export type Task = Setup['task'];

/** A set of actions that a plant can be flown with. */
export interface ActionSet {
  key: string;
  label: string;
  options: Record<string, unknown>;
}

/** What the page has words for; a plant that takes none of these options is flown as it is. */
const ACTION_SETS: ActionSet[] = [
  { key: 'usual', label: '', options: {} },
  { key: 'switches', label: 'switches (the paper’s)', options: { actions: 'switches' } },
  { key: 'main-side', label: 'main × side, held', options: { actions: 'main-side' } },
  { key: 'gymnasium', label: 'Gymnasium’s four', options: { actions: 'gymnasium' } },
  { key: 'continuous', label: 'axes, stick or keys', options: { actions: 'continuous' } },
  { key: 'axes', label: 'axes, stick or keys', options: { continuous: true } },
];

/** What trying a task out has shown. */
export interface Tried {
  controls: Control[];
  /** What its actions are called. */
  labels: string[];
  /** True if actions are values of axes, for which a stick is good. */
  hasAxes: boolean;
  /** True if the plant brings values of its own, so that it can be assisted without a trained model. */
  hasValues: boolean;
}

/** Plants, action sets and models. */
export class Hangar {
  readonly plants: About['plants'];
  models: ModelEntry[] = [];
  /** Hash of the values that learn while people fly. */
  learning: string | null = null;
  private readonly tried = new Map<string, Tried | null>();

  /** `trial` is a loop for trying things out; nobody else may use it. */
  constructor(private readonly trial: Core) {
    this.plants = trial.about().plants;
  }

  async refresh(): Promise<void> {
    this.models = await listModels();
  }

  versionOf(plant: string): number | null {
    return this.plants.find((known) => known.name === plant)?.version ?? null;
  }

  actionSets(plant: string): ActionSet[] {
    const taken = ACTION_SETS.filter((set) => this.try({ plant, options: set.options }) !== null);
    const named = taken.filter((set) => 'actions' in set.options);
    return named.length > 0 ? named : taken.map((set) => ({ ...set, label: set.label || this.describe(plant) }));
  }

  /** The actions of a plant as it is, in its own words. */
  private describe(plant: string): string {
    const tried = this.try({ plant, options: {} });
    return tried?.hasAxes === true ? 'axes' : (tried?.labels ?? []).join(', ');
  }

  /** What a task is like; null if the loop cannot fly it. */
  try(task: Task): Tried | null {
    const key = JSON.stringify(task);
    let known = this.tried.get(key);
    if (known === undefined) {
      known = this.tryAnew(task);
      this.tried.set(key, known);
    }
    return known;
  }

  /** The models of a kind that were made for a task, the one to take first: what learns, then the newest usual one. */
  fitting(kind: ModelEntry['kind'], task: Task): ModelEntry[] {
    const labels = this.try(task)?.labels.join();
    const fits = ({ card, ...model }: ModelEntry) =>
      model.kind === kind &&
      (model.offered || model.hash === this.learning) &&
      card.task.plant === task.plant &&
      card.plant_version === this.versionOf(task.plant) &&
      this.try(card.task)?.labels.join() === labels;
    const rank = ({ hash, card }: ModelEntry) => (hash === this.learning ? 2 : card.variant === null ? 1 : 0);
    return this.models
      .filter(fits)
      .reverse()
      .sort((a, b) => rank(b) - rank(a));
  }

  /** The models to fly a task with: the wanted values if they fit, and the intent that serves the inference and was
   * trained for them, or the usual one. A goal is imagined by networks that see none. */
  crew(task: Task, wanted: string, inference: Inference): { values: string | null; intent: string | null } {
    const fitting = this.fitting('values', task);
    const values = fitting.find((model) => model.hash === wanted) ?? fitting[0];
    const serves = ({ card }: ModelEntry) => (card.goals === 0) === (inference === 'imagined');
    const intents = this.fitting('intent', task).filter(serves);
    const intent = intents.find(({ card }) => card.variant === (values?.card.variant ?? null)) ?? intents[0];
    return { values: values?.hash ?? null, intent: intent?.hash ?? null };
  }

  /** Gives a loop the models of a setup that it does not have yet. */
  async equip(core: Core, hashes: (string | null)[]): Promise<void> {
    for (const hash of hashes) {
      if (hash !== null && !core.hasModel(hash)) core.addModel(await modelBytes(hash));
    }
  }

  private tryAnew(task: Task): Tried | null {
    const version = this.versionOf(task.plant);
    if (version === null) return null;
    try {
      const { controls } = this.trial.begin({
        task,
        plant_version: version,
        seed: 0,
        rule: { rule: 'hic' },
        inference: 'nearest',
        time_scale: 1,
        values: null,
        intent: null,
        pilot: 'person',
      });
      const candidates = this.trial.tick()?.candidates ?? [];
      const hasAxes = candidates.some((candidate) => candidate.action.axes !== undefined);
      const labels = hasAxes
        ? controls.map((control) => control.name)
        : candidates.map((candidate) => candidate.action.label);
      const hasValues = candidates.some((candidate) => candidate.above_worst > 0);
      return { controls, labels, hasAxes, hasValues };
    } catch {
      return null;
    }
  }
}
