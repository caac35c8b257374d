// All flights of the study, the newest first.

import { button, element, select } from '../dom';
import { flownWords, ratesOfPlants, type Rates } from '../rates';
import { reasonOf, RULE_NAMES, sentence } from '../words';
import { cell, table } from './bits';
import type { DeskEpisode } from './deskapi';
import * as api from './deskapi';
import { outcome } from './person';
import { isMeasured } from './peek';
import type { Desk, DeskView } from './place';
import { clock, stepWords } from './says';

const HEADS: [name: string, kind: string][] = [
  ['', 'number'],
  ['began', ''],
  ['participant', ''],
  ['step', ''],
  ['condition', ''],
  ['rule', ''],
  ['outcome', ''],
  ['flown', 'number'],
  ['seed', 'number'],
];

export class FlightListView implements DeskView {
  readonly main = element('main', { class: 'people' });
  private readonly rows: DeskEpisode[] = [];
  private readonly body = element('div', { class: 'body' });
  private readonly remark = element('p', { class: 'note', role: 'status' });
  private readonly older = button('Older', { class: 'secondary', hidden: true }, () => void this.load());
  private readonly who: HTMLElement;
  private readonly deaf: () => void;
  private participant: number | null = null;
  private next: number | null = null;
  /** How often was asked: only the answer to the last question counts. */
  private asked = 0;
  private rates: Rates = new Map();

  constructor(private readonly desk: Desk) {
    const people = desk.feed.rows.map(({ id, code }): [string, string] => [String(id), code]);
    this.who = select('participant', [['', 'everybody'], ...people], '', (chosen) => {
      this.participant = chosen === '' ? null : Number(chosen);
      this.begin();
    });
    const again = button('Refresh', { class: 'secondary' }, () => this.begin());
    this.main.append(
      element(
        'div',
        { class: 'toolbar' },
        this.who,
        this.remark,
        desk.peek.node(),
        element('span', { class: 'spacer' }),
        again,
      ),
      this.body,
      this.older,
    );
    this.deaf = desk.peek.listen(() => this.show());
    this.begin();
  }

  dispose(): void {
    this.deaf();
  }

  private begin(): void {
    this.rows.length = 0;
    this.older.hidden = true;
    this.next = null;
    void this.load();
  }

  private async load(): Promise<void> {
    const mine = (this.asked += 1);
    this.older.disabled = true;
    try {
      const rates = ratesOfPlants();
      const { episodes, next } = await api.episodes({
        ...(this.participant === null ? {} : { participant: this.participant }),
        ...(this.next === null ? {} : { before: this.next }),
        limit: 100,
      });
      this.rates = await rates;
      if (mine !== this.asked) return;
      this.rows.push(...episodes);
      this.next = next;
      this.older.hidden = next === null;
      this.remark.textContent = `${this.rows.length}${next === null ? '' : ' newest'}`;
      this.show();
    } catch (error) {
      if (mine === this.asked) this.remark.textContent = sentence(`the flights could not be read: ${reasonOf(error)}`);
    } finally {
      if (mine === this.asked) this.older.disabled = false;
    }
  }

  private show(): void {
    const lines = this.rows.map((row) => this.line(row));
    this.body.replaceChildren(table(HEADS, lines, 'Nothing was flown yet.'));
  }

  private line(episode: DeskEpisode): HTMLElement {
    const { id, participant, code, condition, step, setup, ticks, seed, started_at_ms } = episode;
    const open = episode.state === 'finished';
    const line = element(
      'tr',
      { class: open ? 'opens' : '' },
      cell('number', open ? element('a', { href: `#/episodes/${id}` }, String(id)) : String(id)),
      cell('', clock(started_at_ms, Date.now())),
      cell(
        '',
        participant === null ? '–' : element('a', { href: `#/people/${participant}` }, code ?? `${participant}`),
      ),
      cell('', step === null ? '–' : stepWords(step)),
      cell('', condition ?? '–'),
      cell('', RULE_NAMES[setup.rule.rule]),
      cell('', outcome(episode, isMeasured(step) && this.desk.peek.coversThose(this.desk.feed.row(participant ?? -1)))),
      cell('number', flownWords(ticks, setup.task.plant, this.rates)),
      cell('number', String(seed)),
    );
    line.addEventListener('click', (event) => {
      if (open && (event.target as Element).closest('a') === null) this.desk.go(`episodes/${id}`);
    });
    return line;
  }
}
