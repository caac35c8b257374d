// What a researcher sees of every tick: pilot, intent, value, arbitration, in the order of the loop's sentence.

import type { Goal, Rule, Tick } from './core';
import { element } from './dom';
import { drawStrip, History, outcomeOf } from './history';
import { drawPlane, planeOf, worthOf } from './plane';
import { actionsOf, type Actions } from './rules';
import { parametersOf, ruleSaid } from './words';

/** Ticks of history that are shown: five seconds at fifty a second. */
const HISTORY_TICKS = 250;
/** c above which the linear rule lets the robot fly, where commands cannot be mixed. */
const LINEAR_AT = 0.5;

/** Names of actions longer than this need more room. */
const LONG_NAME = 12;

const VERDICTS = { none: '', asked: '= as asked', corrected: '≠ corrected', opposed: '⇄ the opposite' };

/** What the marks mean where every action has a row, and where actions are points of a plane. */
const OF_COMMANDS = '▸ asked · ● carried out · | threshold';
const OF_AXES = '○ asked · + carried out · green allowed, larger is worth more · | threshold';

/** The panel beside the flight. */
export class Overlay {
  readonly node = element('aside', { class: 'overlay', 'aria-label': 'What the co-pilot does' });
  private readonly asked = element('span', { class: 'chip asked' });
  private readonly executed = element('span', { class: 'chip executed' });
  private readonly verdict = element('span', { class: 'verdict' });
  private readonly goals = element('div', { class: 'bars' });
  private readonly confidence = element('div', { class: 'bars' });
  private readonly values = element('div', { class: 'bars values' });
  private readonly plane = element('canvas', { class: 'plane', hidden: '' });
  private readonly legend = element('p', { class: 'note legend' }, OF_COMMANDS);
  private readonly rule = element('p', { class: 'note' });
  private readonly strip = element('canvas', { class: 'strip' });
  private flown: Rule = { rule: 'hic' };
  private actions: Actions = 'commands';
  private ownGoal: number | null = null;

  constructor() {
    const section = (title: string, ...content: (Node | string)[]) =>
      element('section', {}, element('h3', {}, title), ...content);
    this.node.append(
      section('Pilot', element('p', {}, 'asks for ', this.asked)),
      section('Intent', this.goals, this.confidence),
      section('Value', this.plane, this.values, this.legend),
      section('Arbitration', this.rule, element('p', {}, 'carries out ', this.executed, this.verdict)),
      section(
        'Last five seconds',
        this.strip,
        element(
          'p',
          { class: 'note legend' },
          element('i', { class: 'asked' }),
          'as asked ',
          element('i', { class: 'corrected' }),
          'corrected ',
          element('i', { class: 'opposed' }),
          'opposed ',
          element('i', { class: 'line' }),
          'c',
        ),
      ),
    );
  }

  /** Before the first tick; `labels` are the names of the actions that will be valued. */
  begin(rule: Rule, ownGoal: number | null, goals: Goal[], labels: string[]): void {
    this.ownGoal = ownGoal;
    this.flown = rule;
    this.actions = actionsOf(labels);
    this.sayRule();
    this.fill(null, new History(), 0);
    this.showGoals(null, goals);
    rows(this.values, labels.length).forEach((row, i) => setRow(row, labels[i]!, '', 0, '', ''));
    this.widenFor(labels);
  }

  /** Shows a tick, and the five seconds of a history that end after `upTo` ticks. */
  show(tick: Tick | null, history: History, upTo: number): void {
    if (!this.node.hidden) this.fill(tick, history, upTo);
  }

  private fill(tick: Tick | null, history: History, upTo: number): void {
    this.asked.textContent = tick === null ? '–' : (tick.asked?.label ?? 'nothing');
    this.executed.textContent = tick === null ? '–' : (tick.executed?.label ?? 'nothing');
    if (tick !== null) this.learnActions(tick);
    const outcome = outcomeOf(tick);
    this.verdict.textContent = VERDICTS[outcome];
    this.verdict.dataset['state'] = outcome;
    const c = tick?.belief.confidence ?? 0;
    setRow(rows(this.confidence, 1)[0]!, 'confidence c', '', c, c.toFixed(2), 'confidence');
    setThreshold(this.confidence, this.flown.rule === 'lasc' && this.actions === 'commands' ? LINEAR_AT : null);
    if (tick !== null) {
      this.showGoals(tick, tick.goals);
      this.showValues(tick);
    }
    drawStrip(this.strip, history, upTo - HISTORY_TICKS, upTo);
  }

  private showGoals(tick: Tick | null, goals: Goal[]): void {
    const imagined = tick?.belief.imagined;
    if (imagined !== undefined) {
      const place = imagined.map((at) => at.toFixed(2)).join(', ');
      setRow(rows(this.goals, 1)[0]!, 'imagined at', '●', 0, place, 'chosen');
      return;
    }
    this.ownGoal = tick === null ? this.ownGoal : tick.pilot_goal;
    rows(this.goals, goals.length).forEach((row, i) => {
      const own = goals[i]?.id === this.ownGoal;
      const share = tick?.belief.probabilities[i] ?? 0;
      const inferred = tick !== null && tick.belief.goal === i;
      setRow(
        row,
        `goal ${i + 1}${own ? ' ★' : ''}`,
        inferred ? '●' : '',
        share,
        share.toFixed(2),
        `${inferred ? 'chosen' : ''} ${own ? 'own' : ''}`,
      );
    });
  }

  /** A recording says with its first tick what its actions are. */
  private learnActions({ candidates }: Tick): void {
    const axes = candidates.some(({ action }) => action.axes !== undefined);
    const actions = axes ? 'axes' : actionsOf(candidates.map(({ action }) => action.label));
    if (actions === this.actions || candidates.length === 0) return;
    this.actions = actions;
    this.sayRule();
  }

  private sayRule(): void {
    const parameters = parametersOf(this.flown);
    this.rule.textContent = ruleSaid(this.flown.rule, this.actions) + (parameters ? ` ${parameters}.` : '');
  }

  private widenFor(labels: string[]): void {
    this.values.classList.toggle(
      'wide',
      labels.some((label) => label.length > LONG_NAME),
    );
  }

  private showValues(tick: Tick): void {
    const { candidates } = tick;
    const plane = planeOf(tick);
    this.plane.hidden = plane === null;
    write(this.legend, plane === null ? OF_COMMANDS : OF_AXES);
    if (plane !== null) {
      drawPlane(this.plane, plane);
      this.showAxes(tick);
      return;
    }
    this.widenFor(candidates.map(({ action }) => action.label));
    const most = Math.max(...candidates.map((candidate) => candidate.above_worst), 1e-9);
    const same = (a: { label: string } | null | undefined, b: { label: string }) => a?.label === b.label;
    rows(this.values, candidates.length).forEach((row, i) => {
      const { action, above_worst, allowed } = candidates[i]!;
      const [asked, executed] = [same(tick.asked, action), same(tick.executed, action)];
      const marks = [allowed ? 'allowed' : 'refused', asked ? 'asked' : '', executed ? 'chosen' : ''].join(' ');
      setRow(
        row,
        action.label,
        `${asked ? '▸' : ''}${executed ? '●' : ''}`,
        above_worst / most,
        above_worst.toFixed(2),
        marks,
      );
    });
    const { threshold } = tick;
    setThreshold(this.values, threshold === null ? null : Math.min(threshold / most, 1));
  }

  /** Of many candidates only what is asked, what is carried out and the best have a row, and the share that is allowed. */
  private showAxes(tick: Tick): void {
    const { candidates, threshold } = tick;
    const most = Math.max(...candidates.map((candidate) => candidate.above_worst), 1e-9);
    const allowed = candidates.filter((candidate) => candidate.allowed).length;
    const worths: [string, number | null][] = [
      ['asked', worthOf(tick, tick.asked)],
      ['carried out', worthOf(tick, tick.executed)],
      ['best', most],
    ];
    this.values.classList.remove('wide');
    const [asked, executed, best, share] = rows(this.values, 4) as [HTMLElement, HTMLElement, HTMLElement, HTMLElement];
    [asked, executed, best].forEach((row, i) => {
      const [name, worth] = worths[i]!;
      setRow(row, name, '', (worth ?? 0) / most, worth === null ? '–' : worth.toFixed(2), 'allowed');
    });
    setRow(share, 'allowed', '', allowed / candidates.length, `${allowed} of ${candidates.length}`, 'count');
    setThreshold(this.values, threshold === null ? null : Math.min(threshold / most, 1));
  }
}

function rows(box: HTMLElement, count: number): HTMLElement[] {
  while (box.childElementCount > count) box.lastElementChild!.remove();
  while (box.childElementCount < count) {
    box.append(
      element(
        'div',
        { class: 'row' },
        element('span', { class: 'name' }),
        element('span', { class: 'marks' }),
        element('span', { class: 'track' }, element('span', { class: 'bar' })),
        element('span', { class: 'number' }),
      ),
    );
  }
  return [...box.children] as HTMLElement[];
}

function setRow(row: HTMLElement, name: string, marks: string, share: number, number: string, kind: string): void {
  const [label, signs, track, text] = [...row.children] as [HTMLElement, HTMLElement, HTMLElement, HTMLElement];
  write(label, name);
  write(signs, marks);
  write(text, number);
  (track.firstElementChild as HTMLElement).style.transform = `scaleX(${Math.max(share, 0.004)})`;
  row.className = `row ${kind}`;
}

/** Touching text that stays the same would cost fifty layouts a second. */
function write(node: HTMLElement, text: string): void {
  if (node.textContent !== text) node.textContent = text;
}

function setThreshold(box: HTMLElement, share: number | null): void {
  box.classList.toggle('with-threshold', share !== null);
  if (share !== null) box.style.setProperty('--threshold', String(share));
}
