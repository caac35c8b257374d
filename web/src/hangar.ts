// What can be flown here, and with which models. Knows no plant: what there is to choose comes from the loop, and
// whether two tasks have the same actions is tried out in a loop of its own.

import { listModels, modelBytes, type ModelEntry } from './api';
import {
  needsNetwork,
  type ActionSet,
  type Control,
  type Core,
  type Inference,
  type PlantEntry,
  type Setup,
} from './core';
import { actionsOf, inferenceName, type Actions } from './rules';
import { reasonOf } from './words';

export type Task = Setup['task'];

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

/**
 * The task that an address asks for, such as `?task=drone&actions=continuous`; null if it asks for none. Values are read as
 * `cohelm` reads its `--option NAME=VALUE`: as JSON, or else as a word.
 */
export function taskIn(search: string): Task | null {
  const { task: plant, ...words } = Object.fromEntries(new URLSearchParams(search));
  if (plant === undefined) return null;
  const read = (word: string): unknown => {
    try {
      return JSON.parse(word) as unknown;
    } catch {
      return word;
    }
  };
  return { plant, options: Object.fromEntries(Object.entries(words).map(([name, word]) => [name, read(word)])) };
}

/** The set of actions with the options of a task: one of those that are offered, or one of its own. */
function setOf({ options }: Task, offered: [ActionSet, ...ActionSet[]]): ActionSet {
  const asked = Object.entries(options);
  if (asked.length === 0) return offered[0];
  const same = (set: ActionSet) =>
    Object.keys(set.options).length === asked.length &&
    asked.every(([name, value]) => JSON.stringify(set.options[name]) === JSON.stringify(value));
  const label = asked.map(([name, value]) => `${name} = ${typeof value === 'string' ? value : JSON.stringify(value)}`);
  return offered.find(same) ?? { name: 'asked', label: label.join(', '), options };
}

/** Plants, action sets and models. */
export class Hangar {
  readonly plants: PlantEntry[];
  models: ModelEntry[] = [];
  /** Hash of the values that learn while people fly. */
  learning: string | null = null;
  /** What the page's address asks for, which may have options that no set offers. */
  asked: Task | null = null;
  private readonly tried = new Map<string, Tried | string>();

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

  /** The sets of actions that a plant offers; its only one, if it offers none to choose from. */
  actionSets(plant: string): [ActionSet, ...ActionSet[]] {
    const [first, ...others] = this.plants.find((known) => known.name === plant)?.actions ?? [];
    const [usual, ...more]: [ActionSet, ...ActionSet[]] =
      first === undefined ? [{ name: 'usual', label: this.describe(plant), options: {} }] : [first, ...others];
    const asked = this.asked?.plant === plant ? setOf(this.asked, [usual, ...more]) : usual;
    return [usual, ...more, ...([usual, ...more].includes(asked) ? [] : [asked])];
  }

  /** Notes what the page's address asks for, and says how the settings call it; nothing if it asks for nothing. */
  ask(asked: Task | null): { plant: string; actions: string } | null {
    this.asked = asked;
    return asked === null ? null : { plant: asked.plant, actions: setOf(asked, this.actionSets(asked.plant)).name };
  }

  /** The actions of a plant as it is, in its own words. */
  private describe(plant: string): string {
    const tried = this.try({ plant, options: {} });
    return tried?.hasAxes === true ? 'axes' : (tried?.labels ?? []).join(', ');
  }

  /** What a task is like; null if the loop cannot fly it. */
  try(task: Task): Tried | null {
    const known = this.tryOnce(task);
    return typeof known === 'string' ? null : known;
  }

  /** Why the loop cannot fly a task, in its own words; null if it can. */
  whyNot(task: Task): string | null {
    const known = this.tryOnce(task);
    return typeof known === 'string' ? known : null;
  }

  /** What a task is steered by. */
  actions(task: Task): Actions {
    const tried = this.try(task);
    return tried?.hasAxes === true ? 'axes' : actionsOf(tried?.labels ?? []);
  }

  private tryOnce(task: Task): Tried | string {
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

  /** Why no goal can be inferred like that with these values; null if it can. */
  whyNotInfer(task: Task, wanted: string, inference: Inference): string | null {
    if (inference === 'nearest') return null;
    const { values, intent } = this.crew(task, wanted, inference);
    if (values === null) return 'no values for these actions';
    if (intent !== null || !needsNetwork(inference)) return null;
    return inference === 'imagined' ? 'no model for these actions imagines goals' : 'no intent model for these actions';
  }

  /** How goals are inferred with these values where somebody chose `inference`, and what is said if that is another way:
   * the calibrated one if it can be had, otherwise the nearest goal. */
  inferring(task: Task, wanted: string, inference: Inference): { inference: Inference; note: string | null } {
    const why = this.whyNotInfer(task, wanted, inference);
    if (why === null) return { inference, note: null };
    const instead: Inference = this.whyNotInfer(task, wanted, 'calibrated') === null ? 'calibrated' : 'nearest';
    const [flown, chosen] = [inferenceName(instead), inferenceName(inference)];
    return { inference: instead, note: `Your goal is inferred by “${flown}”, not by “${chosen}”: ${why}.` };
  }

  /** Gives a loop the models of a setup that it does not have yet. */
  async equip(core: Core, hashes: (string | null)[]): Promise<void> {
    for (const hash of hashes) {
      if (hash !== null && !core.hasModel(hash)) core.addModel(await modelBytes(hash));
    }
  }

  private tryAnew(task: Task): Tried | string {
    const version = this.versionOf(task.plant);
    if (version === null)
      return `no plant is called ${task.plant}; there are: ${this.plants.map(({ name }) => name).join(', ')}`;
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
    } catch (error) {
      return reasonOf(error);
    }
  }
}
