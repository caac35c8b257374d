// How learning stands, in the header, while the server runs with --learn.

import { keepLearned, learningStatus, returnToShipped, type LearningStatus } from './api';
import { button, element } from './dom';
import { say } from './message';
import { reasonOf } from './words';

/** A badge that opens what there is to know and to do. */
export class LearningBadge {
  readonly node = element('details', { class: 'learning', hidden: true });
  private readonly summary = element('summary', {});
  private readonly panel = element('div', { class: 'panel' });
  /** Flights that were learnt from since the last return to the shipped values. */
  learned = 0;

  constructor() {
    this.node.append(this.summary, this.panel);
    document.addEventListener('pointerdown', (event) => {
      if (!this.node.contains(event.target as Node)) this.node.open = false;
    });
    this.node.addEventListener('keydown', (event) => {
      if (event.key === 'Escape') this.node.open = false;
    });
  }

  /** Asks the server how it stands. */
  async refresh(): Promise<void> {
    await this.ask(learningStatus());
  }

  private async ask(answer: Promise<LearningStatus>): Promise<void> {
    try {
      this.show(await answer);
    } catch (error) {
      say(`Learning: ${reasonOf(error)}`);
    }
  }

  private show(status: LearningStatus): void {
    this.node.hidden = !status.learning;
    if (!status.learning) return;
    const { learned, waiting, left_out, failure, kept, current, shipped } = status;
    this.learned = learned;
    this.summary.textContent =
      failure !== null ? '⚠ learning stopped' : learned === 0 ? '✦ learning' : `✦ learnt from ${flights(learned)}`;
    this.summary.dataset['state'] = failure !== null ? 'failed' : 'well';
    const now =
      current === shipped
        ? 'the shipped values'
        : current === kept
          ? 'learnt values, which are kept'
          : 'learnt values, not kept yet';
    const lines = [
      `Assists now: ${now} (${current.slice(0, 8)}).`,
      ...(waiting > 0 ? [`${flights(waiting)} in the queue.`] : []),
      ...(left_out > 0 ? [`${flights(left_out)} came too fast to learn from.`] : []),
      ...(failure !== null ? [failure] : []),
      'Keep: the next start of the server goes on from these values. Return: forget what was learnt.',
    ];
    this.panel.replaceChildren(
      ...lines.map((line) => element('p', {}, line)),
      element(
        'div',
        { class: 'actions' },
        button('Keep', { class: 'primary', disabled: current === kept }, () => void this.ask(keepLearned())),
        button(
          'Return to shipped',
          { class: 'secondary', disabled: current === shipped && kept === null },
          () => void this.ask(returnToShipped()),
        ),
      ),
    );
  }
}

function flights(count: number): string {
  return count === 1 ? '1 flight' : `${count} flights`;
}
