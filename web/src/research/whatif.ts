// The choices of a what-if: from which tick, under which rule, by what inference, who asks.

import { type Hands, type Inference, needsNetwork, type Rule, type Setup, type Wish } from '../core';
import { button, element, select } from '../dom';
import { type Actions, inferenceName, INFERENCES, ruleWords, usualRules } from '../rules';

/** Who looks back can tell the co-pilot the goal. */
const OFFERED: [Inference, string][] = [...INFERENCES, ['known', inferenceName('known')]];

export { ruleWords };

export function handsWords(hands: Hands): string {
  switch (hands.pilot) {
    case 'recorded':
      return 'the recorded keys';
    case 'nobody':
      return 'nobody: keys let go';
    case 'greedy':
      return 'a pilot that knows the values';
    case 'person':
      return `simulated person, ${hands.population}`;
  }
}

/** What there is to choose from. */
export interface Ground {
  /** The record's setup. */
  setup: Setup;
  /** What the plant is steered by: usual parameters depend on it. */
  actions: Actions;
  /** The models of the record, or the usual ones of its task if it has none. */
  models: { values: string | null; intent: string | null; imagined: string | null };
  /** Who can take over. */
  pilots: Hands[];
}

function networkFor({ intent, imagined }: Ground['models'], inference: Inference): string | null {
  return inference === 'imagined' ? imagined : intent;
}

/** A bar with the choices; `changed` is called with a wish whenever one is chosen otherwise. */
export class WhatIfBar {
  readonly node = element('div', { class: 'what-if', role: 'group', 'aria-label': 'What if' });
  private readonly from = element('output', {});
  private readonly who = element('input', {
    type: 'number',
    min: '0',
    max: '999',
    value: '0',
    'aria-label': 'Which of them',
  });
  private readonly whoLabel = element('label', {}, 'no.', this.who);
  private at = 0;
  private rule: Rule;
  private inference: Inference;
  private hands: Hands = { pilot: 'recorded' };

  constructor(
    private readonly ground: Ground,
    private readonly changed: (wish: Wish) => void,
    close: () => void,
  ) {
    const { setup, models, pilots } = ground;
    this.inference = setup.inference;
    const own = JSON.stringify(setup.rule);
    const rules = [setup.rule, ...usualRules(ground.actions).filter((rule) => JSON.stringify(rule) !== own)];
    this.rule = rules.find(({ rule }) => rule !== setup.rule.rule && ['lasc', 'misc'].includes(rule)) ?? rules[1]!;
    const inferences = OFFERED.filter(
      ([inference]) =>
        inference === setup.inference || !needsNetwork(inference) || networkFor(models, inference) !== null,
    );
    this.who.addEventListener('change', () => this.choose({}));
    this.node.append(
      element('b', {}, 'What if'),
      element('span', {}, 'from ', this.from),
      select(
        'rule',
        rules.map((rule, i) => [String(i), ruleWords(rule) + (i === 0 ? ' (as flown)' : '')]),
        String(rules.indexOf(this.rule)),
        (i) => this.choose({ rule: rules[Number(i)]! }),
      ),
      select('intent', inferences, setup.inference, (inference) => this.choose({ inference: inference as Inference })),
      select(
        'asks',
        pilots.map((hands, i) => [String(i), handsWords(hands)]),
        '0',
        (i) => this.choose({ hands: pilots[Number(i)]! }),
      ),
      this.whoLabel,
      element('span', { class: 'spacer' }),
      button('✕', { class: 'secondary', 'aria-label': 'Leave the what-if' }, close),
    );
    this.show();
  }

  /** From that tick on. */
  start(at: number): void {
    this.at = at;
    this.choose({});
  }

  private choose(change: { rule?: Rule; inference?: Inference; hands?: Hands }): void {
    Object.assign(this, change);
    this.show();
    this.changed(this.wish());
  }

  private wish(): Wish {
    const { at, rule, inference, hands } = this;
    const { setup, models } = this.ground;
    const person = Math.max(0, Math.min(999, Math.round(Number(this.who.value)) || 0));
    const pilot = hands.pilot === 'person' ? { ...hands, person } : hands;
    const [values, intent] = [models.values, networkFor(models, inference)];
    return { at, rule, inference, silence: setup.silence ?? 'best', values, intent, pilot };
  }

  private show(): void {
    this.whoLabel.hidden = this.hands.pilot !== 'person';
    this.from.textContent = `tick ${this.at}`;
  }
}
