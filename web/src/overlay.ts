// What a researcher sees of every tick: intent, value, arbitration, in the order of the loop's sentence.

import type { Goal, Rule, Tick } from './core';
import { element } from './dom';

const RULES: Record<Rule['rule'], string> = {
  hic: 'Human alone: what is asked is carried out.',
  robot: 'Robot alone: the best action, whatever is asked.',
  lasc: 'Linear: the robot’s action if c > 0.5, otherwise the person’s.',
  misc: 'Minimal intervention: allowed is Q′ ≥ c · Q′max; the most similar is carried out.',
  tolerance: 'Constant tolerance: allowed is Q′ ≥ (1 − α) · Q′max.',
  'misc-r': 'MISC-R: allowed is what costs at most κ · median range; the most similar is carried out.',
};

const HISTORY_TICKS = 250;

/** The panel beside the flight. */
export class Overlay {
  readonly node = element('aside', { class: 'overlay', 'aria-label': 'What the co-pilot does' });
  private readonly asked = element('span', { class: 'chip asked' });
  private readonly executed = element('span', { class: 'chip executed' });
  private readonly verdict = element('span', { class: 'verdict' });
  private readonly goals = element('div', { class: 'bars' });
  private readonly confidence = element('output', {});
  private readonly values = element('div', { class: 'bars values' });
  private readonly rule = element('p', { class: 'note' });
  private readonly strip = element('canvas', { class: 'strip' });
  private history: { confidence: number; state: 'none' | 'asked' | 'corrected' | 'opposed' }[] = [];
  private ownGoal: number | null = null;

  constructor() {
    const section = (title: string, ...content: (Node | string)[]) =>
      element('section', {}, element('h3', {}, title), ...content);
    this.node.append(
      section('Pilot', element('p', {}, 'asked ', this.asked)),
      section('Intent', this.goals, element('p', {}, 'confidence c = ', this.confidence)),
      section('Value', this.values),
      section('Arbitration', this.rule, element('p', {}, 'carried out ', this.executed, this.verdict)),
      section('Last five seconds', this.strip, element('p', { class: 'note legend' },
        element('i', { class: 'asked' }), 'as asked ', element('i', { class: 'corrected' }), 'corrected ',
        element('i', { class: 'opposed' }), 'opposed ', element('i', { class: 'line' }), 'c')),
    );
  }

  begin(rule: Rule, ownGoal: number | null): void {
    this.history = [];
    this.ownGoal = ownGoal;
    this.rule.textContent = RULES[rule.rule];
    this.show(null);
  }

  show(tick: Tick | null): void {
    this.asked.textContent = tick?.asked?.label ?? 'nothing';
    this.executed.textContent = tick?.executed?.label ?? 'nothing';
    const seen = tick?.intervention;
    const state = seen === null || seen === undefined ? 'none'
      : seen.opposed ? 'opposed' : seen.effective ? 'corrected' : 'asked';
    this.verdict.textContent = { none: '', asked: 'as asked', corrected: 'corrected', opposed: 'the opposite' }[state];
    this.verdict.dataset['state'] = state;
    this.confidence.textContent = (tick?.belief.confidence ?? 0).toFixed(2);
    this.showGoals(tick);
    this.showValues(tick);
    if (tick !== null) {
      this.history.push({ confidence: tick.belief.confidence, state });
      if (this.history.length > HISTORY_TICKS) this.history.shift();
    }
    this.drawStrip();
  }

  /** Five seconds that end at a tick of a record. */
  showHistory(ticks: Tick[]): void {
    this.history = [];
    ticks.forEach((tick) => this.show(tick));
  }

  private showGoals(tick: Tick | null): void {
    const goals: Goal[] = tick?.goals ?? [];
    rows(this.goals, goals.length).forEach((row, i) => {
      const inferred = tick?.belief.goal === i;
      const own = goals[i]?.id === this.ownGoal;
      const name = `pad ${i + 1}${own ? ' ★' : ''}`;
      setRow(row, name, tick?.belief.probabilities[i] ?? 0, inferred ? 'chosen' : '');
    });
  }

  private showValues(tick: Tick | null): void {
    const candidates = tick?.candidates ?? [];
    const most = Math.max(...candidates.map((candidate) => candidate.above_worst), 1e-9);
    const same = (a: { label: string } | null | undefined, b: { label: string }) => a?.label === b.label;
    rows(this.values, candidates.length).forEach((row, i) => {
      const candidate = candidates[i]!;
      const marks = [
        candidate.allowed ? 'allowed' : 'refused',
        same(tick?.asked, candidate.action) ? 'asked' : '',
        same(tick?.executed, candidate.action) ? 'chosen' : '',
      ];
      setRow(row, candidate.action.label, candidate.above_worst / most, marks.join(' '));
    });
    const share = tick?.threshold === null || tick === null ? null : Math.min((tick.threshold ?? 0) / most, 1);
    this.values.style.setProperty('--threshold', share === null ? '-1' : String(share));
    this.values.classList.toggle('with-threshold', share !== null && candidates.length > 0);
  }

  private drawStrip(): void {
    const { strip, history } = this;
    const ratio = devicePixelRatio || 1;
    const [width, height] = [strip.clientWidth, strip.clientHeight];
    if (width === 0) return;
    strip.width = Math.round(width * ratio);
    strip.height = Math.round(height * ratio);
    const pen = strip.getContext('2d')!;
    pen.scale(ratio, ratio);
    const x = (i: number) => ((HISTORY_TICKS - history.length + i) / HISTORY_TICKS) * width;
    const colours = { none: 'transparent', asked: '#56b4e9', corrected: '#ffb000', opposed: '#e5533d' };
    history.forEach(({ state }, i) => {
      pen.fillStyle = colours[state];
      pen.fillRect(x(i), height - 10, width / HISTORY_TICKS + 0.5, 10);
    });
    pen.strokeStyle = '#dfe8ff';
    pen.lineWidth = 1.5;
    pen.beginPath();
    history.forEach(({ confidence }, i) => pen.lineTo(x(i), (height - 14) * (1 - confidence) + 2));
    pen.stroke();
  }
}

function rows(box: HTMLElement, count: number): HTMLElement[] {
  while (box.childElementCount > count) box.lastElementChild!.remove();
  while (box.childElementCount < count) {
    box.append(element('div', { class: 'row' }, element('span', { class: 'name' }),
      element('span', { class: 'track' }, element('span', { class: 'bar' })), element('span', { class: 'number' })));
  }
  return [...box.children] as HTMLElement[];
}

function setRow(row: HTMLElement, name: string, share: number, marks: string): void {
  const [label, track, number] = [...row.children] as [HTMLElement, HTMLElement, HTMLElement];
  if (label.textContent !== name) label.textContent = name;
  (track.firstElementChild as HTMLElement).style.transform = `scaleX(${Math.max(share, 0.004)})`;
  number.textContent = share.toFixed(2);
  row.className = `row ${marks}`;
}
