// The footer of the flying view: mode, speed, and a panel for what is chosen more rarely.

import type { ModelEntry } from './api';
import type { ActionSet, Rule } from './core';
import { button, element, select } from './dom';
import type { Hangar, Task } from './hangar';
import { say } from './message';
import {
  INFERENCES,
  needsOf,
  rangesOf,
  ruleWords,
  usualRule,
  usualRules,
  whyNotParameter,
  withParameters,
  type Range,
  type RuleWord,
} from './rules';
import { modeBy, modeOf, MODES, placeOf, TIME_SCALES, type ModeEntry, type Settings } from './settings';
import { RULE_NAMES, SIGNS } from './words';

/** What is chosen is told; what can be chosen follows from plant, actions and models. */
export class Controls {
  readonly node = element('footer', {});
  /** The seed of the next flight, if somebody wants a certain one. */
  seed: number | null = null;
  private readonly panel = element('div', { class: 'panel', id: 'choices', hidden: true });
  private readonly opener: HTMLButtonElement;

  constructor(
    private readonly hangar: Hangar,
    private readonly settings: Settings,
    private readonly changed: (change: Partial<Settings>) => void,
    private readonly toggleOverlay: () => void,
  ) {
    this.opener = button('', { class: 'secondary opener', 'aria-expanded': 'false', 'aria-controls': 'choices' }, () =>
      this.open(this.panel.hidden !== false),
    );
    // A click leaves the focus on a button, where the next Space or Enter would press it again; keys leave it there.
    this.node.addEventListener('click', (event) => {
      if (event.detail > 0 && document.activeElement instanceof HTMLButtonElement) document.activeElement.blur();
    });
    this.panel.addEventListener('keydown', (event) => {
      if (event.key !== 'Escape') return;
      event.stopPropagation();
      this.open(false);
      this.opener.focus();
    });
  }

  get actionSet(): ActionSet {
    const sets = this.hangar.actionSets(this.plant);
    return sets.find((set) => set.name === this.settings.actions) ?? sets[0];
  }

  get plant(): string {
    const { plants } = this.hangar;
    return plants.find((known) => known.name === this.settings.plant)?.name ?? plants[0]?.name ?? '';
  }

  get task(): Task {
    return { plant: this.plant, options: this.actionSet.options };
  }

  get mode(): ModeEntry {
    return modeOf(this.settings);
  }

  /** The rule of a mode, with the parameters chosen for these actions or the usual ones. */
  ruleOf({ mode, word }: ModeEntry): Rule {
    const usual = usualRule(word, this.hangar.actions(this.task));
    return mode === 'demo' ? usual : withParameters(usual, this.settings.parameters[this.place(word)]);
  }

  private place(word: RuleWord): string {
    return placeOf({ plant: this.plant, actions: this.actionSet.name }, word);
  }

  /** Why a mode cannot be flown with this task; null if it can. */
  whyNot(entry: ModeEntry): string | null {
    return this.whyNotRule(this.ruleOf(entry));
  }

  private whyNotRule(rule: Rule): string | null {
    const needs = needsOf(rule);
    const trained = this.hangar.fitting('values', this.task).length > 0;
    const own = this.hangar.try(this.task)?.hasValues === true;
    if (needs === 'nothing' || trained || (needs === 'values' && own)) return null;
    return own
      ? 'This needs a trained co-pilot; the plant’s own values have no measured range.'
      : 'There is no trained co-pilot for these actions.';
  }

  /** Builds it anew after a change of what can be chosen; what had the focus has it again. */
  build(): void {
    const { settings } = this;
    const focused = document.activeElement instanceof HTMLElement ? document.activeElement.dataset['name'] : undefined;
    const { label } = this.actionSet;
    this.opener.textContent = `${this.plant} · ${label} ▴`;
    const open = this.panel.hidden === false;
    this.panel.replaceChildren(...this.choices());
    this.node.replaceChildren(
      this.modes(),
      select('speed', TIME_SCALES, String(settings.timeScale), (scale) => this.changed({ timeScale: Number(scale) })),
      element('span', { class: 'choices' }, this.opener, this.panel),
      element('span', { class: 'spacer' }),
      this.overlayButton(),
    );
    this.open(open);
    if (focused !== undefined) this.node.querySelector<HTMLElement>(`[data-name="${focused}"]`)?.focus();
  }

  private overlayButton(): HTMLButtonElement {
    const made = button(
      'Overlay ',
      { class: 'secondary', 'data-name': 'overlay', 'aria-pressed': String(this.settings.overlay) },
      () => {
        this.toggleOverlay();
        made.setAttribute('aria-pressed', String(this.settings.overlay));
      },
    );
    made.append(element('kbd', {}, 'O'));
    return made;
  }

  private modes(): HTMLElement {
    const box = element('div', { class: 'segmented', role: 'group', 'aria-label': 'Mode' });
    const { mode } = this;
    const entries = mode.mode === 'other' ? [...MODES.slice(0, -1), mode, ...MODES.slice(-1)] : MODES;
    for (const entry of entries) {
      const why = this.whyNot(entry);
      const pressed = String(entry.mode === this.settings.mode);
      const attributes = {
        title: why === null ? entry.title : `${entry.title}. ${why}`,
        'data-mode': entry.mode,
        'data-name': entry.mode,
        'aria-pressed': pressed,
      };
      box.append(
        button(entry.label, { ...attributes, 'aria-disabled': String(why !== null) }, () =>
          this.changed({ mode: entry.mode }),
        ),
      );
    }
    return box;
  }

  private choices(): HTMLElement[] {
    const { hangar, settings, task } = this;
    const plants = hangar.plants.map(({ name }): [string, string] => [name, name]);
    const sets = hangar.actionSets(task.plant).map(({ name, label }): [string, string] => [name, label]);
    const values = hangar
      .fitting('values', task)
      .map((model): [string, string] => [model.hash, nameOf(model, hangar.learning)]);
    const inferences = INFERENCES.map(([inference, name]): [string, string, string | null] => [
      inference,
      name,
      hangar.whyNotInfer(task, settings.values, inference),
    ]);
    const { inference: inferring, note } = hangar.inferring(task, settings.values, settings.inference);
    const summary = hangar.plants.find((known) => known.name === task.plant)?.summary ?? '';
    const chosen = values.some(([hash]) => hash === settings.values) ? settings.values : (values[0]?.[0] ?? '');
    return [
      element('p', {}, summary),
      select('plant', plants, task.plant, (plant) => this.changed({ plant })),
      select('actions', sets, this.actionSet.name, (actions) => this.changed({ actions })),
      select('co-pilot', values.length > 0 ? values : [['', 'none']], chosen, (hash) =>
        this.changed({ values: hash === values[0]?.[0] ? '' : hash }),
      ),
      ...this.ruleChoices(),
      select('inference', inferences, inferring, (inference) =>
        this.changed({ inference: inference as Settings['inference'] }),
      ),
      ...(note === null ? [] : [element('p', { class: 'note' }, note)]),
      this.seedBox(),
    ];
  }

  /** All rules, and the parameters of the one that is flown. */
  private ruleChoices(): HTMLElement[] {
    const rules = usualRules(this.hangar.actions(this.task)).map((rule): [string, string, string | null] => [
      rule.rule,
      RULE_NAMES[rule.rule],
      this.whyNotRule(rule) === null ? null : 'no values for it',
    ]);
    const { mode } = this;
    const flown = this.ruleOf(mode);
    const shown = mode.mode === 'demo' ? '' : flown.rule;
    const chosen: [string, string][] = shown === '' ? [['', 'the robot, which is told the goal']] : [];
    return [
      select('rule', [...chosen, ...rules], shown, (word) => this.changed(modeBy(word as RuleWord))),
      ...rangesOf(flown).map(([name, value, range]) => this.parameterBox(flown, name, value, range)),
    ];
  }

  private parameterBox(rule: Rule, name: string, value: number, { least, most, step }: Range): HTMLElement {
    const box = element('input', {
      type: 'number',
      min: String(least),
      max: String(most),
      step: String(step),
      value: String(value),
      'data-name': `parameter ${name}`,
    });
    box.addEventListener('change', () => {
      const why =
        box.value === '' ? `a number from ${least} to ${most}` : whyNotParameter(rule, name, Number(box.value));
      if (why !== null) {
        say(`${SIGNS[name] ?? name} of ${RULE_NAMES[rule.rule]}: expected ${why}; ${ruleWords(rule)} stays.`);
        box.value = String(value);
        return;
      }
      const { parameters } = this.settings;
      const place = this.place(rule.rule);
      this.changed({ parameters: { ...parameters, [place]: { ...parameters[place], [name]: Number(box.value) } } });
    });
    return element('label', { class: 'parameter' }, SIGNS[name] ?? name, box);
  }

  private seedBox(): HTMLElement {
    const box = element('input', {
      type: 'number',
      min: '0',
      step: '1',
      placeholder: 'random',
      value: this.seed === null ? '' : String(this.seed),
    });
    box.addEventListener('change', () => {
      const read = readSeed(box.value, box.validity.badInput);
      if (typeof read === 'string') {
        say(read);
        box.value = this.seed === null ? '' : String(this.seed);
        return;
      }
      this.seed = read.seed;
      this.changed({});
    });
    return element('label', {}, 'seed', box);
  }

  private open(open: boolean): void {
    this.panel.hidden = !open;
    this.opener.setAttribute('aria-expanded', String(open));
  }

  /** Puts the panel away. */
  close(): void {
    this.open(false);
  }
}

/** The seed that was typed, none if nothing was, or what was expected instead. */
export function readSeed(typed: string, isNoNumber = false): { seed: number | null } | string {
  if (typed === '' && !isNoNumber) return { seed: null };
  const seed = Number(typed);
  if (!isNoNumber && Number.isSafeInteger(seed) && seed >= 0) return { seed };
  const came = isNoNumber ? 'something else' : typed;
  return `A seed is a whole number from 0 to ${Number.MAX_SAFE_INTEGER}, or nothing for a random one; got ${came}. It stays as it was.`;
}

function nameOf({ hash, card }: ModelEntry, learning: string | null): string {
  const variant = card.variant === null ? '' : ` (${card.variant})`;
  return `${card.name}${variant} ${hash.slice(0, 6)}${hash === learning ? ', learning' : ''}`;
}
