// The rules that can be chosen, with their usual parameters for a kind of actions, and what each parameter may be. The
// fly page and the desk's what-if offer the same ones. Knows no page.

import type { Inference, Rule } from './core';
import { parametersOf, RULE_NAMES } from './words';

export type RuleWord = Rule['rule'];

/** What a plant is steered by: one command at a time, levers that are held together, or values of axes. */
export type Actions = 'commands' | 'levers' | 'axes';

/** The kind of actions with these names: a lever's positions are joined by a plus sign, an axis has two directions. */
export function actionsOf(labels: readonly string[]): Actions {
  if (labels.some((label) => / [−+]$/.test(label))) return 'axes';
  return labels.some((label) => label.includes(' + ')) ? 'levers' : 'commands';
}

/** The rules in the order of lists, as Rust's `Rule::USUAL` has them. */
const USUAL: readonly Rule[] = [
  { rule: 'hic' },
  { rule: 'lasc' },
  { rule: 'misc' },
  { rule: 'misc-r', kappa: 0.7 },
  { rule: 'misc-h', kappa: 1.25, release: 0.5 },
  { rule: 'tolerance', alpha: 0.4 },
  { rule: 'line-graph', start: 0.2, full: 0.8, most: 1 },
  { rule: 'threshold', confidence: 0.6 },
  { rule: 'hindsight', likeness: 0 },
  { rule: 'ida' },
  { rule: 'safe-nearest', hold: 10, horizon: 80 },
  { rule: 'robot' },
];

/** What does not carry over from commands to axes: docs/continuous.md and docs/measured/compare/tuning.csv have the
 * measurements. Of the lander, the drone and the arm these are best on the hardest, and nearly so on the others. */
const ON_AXES: readonly Rule[] = [
  { rule: 'misc-r', kappa: 0.2 },
  { rule: 'misc-h', kappa: 1, release: 0.25 },
  { rule: 'tolerance', alpha: 0.1 },
];

/** Every rule with its usual parameters for actions of this kind. */
export function usualRules(actions: Actions): Rule[] {
  return USUAL.map((rule) => (actions === 'axes' ? ON_AXES.find((one) => one.rule === rule.rule) : undefined) ?? rule);
}

/** The rule of that word with its usual parameters for actions of this kind. */
export function usualRule(word: RuleWord, actions: Actions): Rule {
  return usualRules(actions).find(({ rule }) => rule === word)!;
}

/** What a parameter may be, and by how much an arrow of its field changes it. */
export interface Range {
  least: number;
  most: number;
  step: number;
}

const SHARE: Range = { least: 0, most: 1, step: 0.05 };
const REGRET: Range = { least: 0, most: 10, step: 0.05 };
const TICKS: Range = { least: 0, most: 500, step: 1 };
const RANGES: Record<string, Range> = { kappa: REGRET, likeness: REGRET, hold: TICKS, horizon: TICKS };

/** The parameters of a rule by name, and what each may be. */
export function rangesOf(rule: Rule): [name: string, value: number, range: Range][] {
  return Object.entries(rule).flatMap(([name, value]): [string, number, Range][] =>
    typeof value === 'number' ? [[name, value, RANGES[name] ?? SHARE]] : [],
  );
}

/** Why a parameter cannot be that; null if it can. */
export function whyNotParameter(rule: Rule, name: string, value: number): string | null {
  const range = RANGES[name] ?? SHARE;
  if (!(value >= range.least && value <= range.most)) return `a number from ${range.least} to ${range.most}`;
  if (range === TICKS && !Number.isInteger(value)) return 'a whole number of ticks';
  const changed: Rule = { ...rule, [name]: value };
  if ((changed.start ?? 0) > (changed.full ?? 1)) return 'no smaller full than start';
  return null;
}

/** A rule with the parameters that somebody chose, as far as they make sense. */
export function withParameters(rule: Rule, chosen: Record<string, unknown> | undefined): Rule {
  let changed = rule;
  for (const [name] of rangesOf(rule)) {
    const value = chosen?.[name];
    if (typeof value === 'number' && whyNotParameter(changed, name, value) === null)
      changed = { ...changed, [name]: value };
  }
  return changed;
}

/** What a rule needs of a plant: nothing, values of any kind, or values whose usual range is known. */
export function needsOf(rule: Rule): 'nothing' | 'values' | 'model' {
  if (rule.rule === 'hic') return 'nothing';
  return rule.kappa !== undefined || (rule.likeness ?? 0) > 0 ? 'model' : 'values';
}

/** A rule in a few words, such as `MISC-R κ = 0.7`. */
export function ruleWords(rule: Rule): string {
  const parameters = parametersOf(rule);
  return RULE_NAMES[rule.rule] + (parameters ? ` ${parameters}` : '');
}

/** Ways to infer the goal that a person can choose. */
export const INFERENCES: [Inference, string][] = [
  ['calibrated', 'calibrated'],
  ['softmax', 'softmax of distances'],
  ['inverse-distance', 'inverse distance (the paper’s)'],
  ['bayesian', 'by the values'],
  ['calibrated-bayesian', 'calibrated × by the values'],
  ['imagined', 'imagined: knows no goals'],
  ['nearest', 'nearest goal'],
];

/** What an inference is called. */
export function inferenceName(inference: Inference): string {
  return inference === 'known'
    ? 'told the goal'
    : (INFERENCES.find(([known]) => known === inference)?.[1] ?? inference);
}
