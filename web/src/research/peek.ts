// Outcomes while a study runs. Who watches a difference grow is tempted to stop when it looks good, so lists keep the
// outcomes of measured flights to themselves until everybody who was planned has finished, or somebody asks for them
// all the same. A flight that is opened shows how it ended: one is looked at to see what went wrong, not to count.

import { element } from '../dom';
import type { Row, StudyReport } from './deskapi';
import type { Feed } from './feed';

/** What looking costs. */
const PRICE =
  'Whoever stops, or goes on, because of what the outcomes look like takes chance for an effect more often than the report says (optional stopping). Decide by the plan.';
/** A step whose flight is measured; practice tells nothing about conditions. */
const MEASURED = /(^|\/)flight-\d+$/;

/** Whether somebody who was planned has not finished yet; without a plan nobody knows. */
export function isRunning({ planned, cells }: Pick<StudyReport, 'planned' | 'cells'>): boolean {
  const finished = cells.reduce((sum, cell) => sum + cell.finished, 0);
  return planned === 0 || finished < planned;
}

export function isMeasured(step: unknown): boolean {
  return typeof step === 'string' && MEASURED.test(step);
}

/** Whether outcomes are shown: one answer for all views of the desk, and no again each time the desk is opened. */
export class Peek {
  private wanted = false;
  private readonly told = new Set<() => void>();

  constructor(private readonly feed: Pick<Feed, 'study'>) {}

  /** Lists keep outcomes to themselves now. */
  get covers(): boolean {
    return !this.wanted && this.matters;
  }

  /** Whether this person's outcomes are kept back: tests and bots are in no result. */
  coversThose(row: Pick<Row, 'test' | 'simulated'> | undefined): boolean {
    return this.covers && row?.test !== true && row?.simulated !== true;
  }

  /** Calls back when somebody asks for outcomes, or no longer; gives what ends that. */
  listen(told: () => void): () => void {
    this.told.add(told);
    return () => this.told.delete(told);
  }

  /** The switch, with what it costs; empty once everybody has finished. */
  node(): HTMLElement {
    if (!this.matters) return element('span', {});
    const box = element('input', { type: 'checkbox', checked: this.wanted, 'aria-describedby': 'peek-price' });
    const price = element('span', { class: 'note', id: 'peek-price' });
    const tell = () => (price.textContent = this.wanted ? PRICE : 'hidden while the study runs');
    box.addEventListener('change', () => {
      this.wanted = box.checked;
      tell();
      this.told.forEach((told) => told());
    });
    tell();
    return element(
      'span',
      { class: 'peek' },
      element('label', { title: PRICE }, box, 'outcomes of measured flights'),
      price,
    );
  }

  private get matters(): boolean {
    return this.feed.study !== null && isRunning(this.feed.study);
  }
}

/** What stands in a list in place of an outcome. */
export function covered(): HTMLElement {
  return element('span', { class: 'none', title: 'Outcomes are hidden while the study runs' }, 'hidden');
}
