// The list of stored flights.

import { listEpisodes, type EpisodeEntry } from './api';
import type { Context, View } from './context';
import { button, element } from './dom';
import { flownWords, plantWords, ratesOfPlants, type Rates } from './rates';
import { ENDING_WORDS, reasonOf, RULE_NAMES } from './words';

const HEAD: [name: string, kind: string][] = [
  ['', 'number'],
  ['when', ''],
  ['plant', ''],
  ['rule', ''],
  ['pilot', ''],
  ['outcome', ''],
  ['flown', 'number'],
  ['speed', 'number'],
  ['seed', 'number'],
];

export class EpisodesView implements View {
  readonly main = element('main', { class: 'page' });
  readonly footer = element('footer', {});
  private readonly body = element('tbody', {});
  private readonly remark = element('p', { class: 'note', role: 'status' });
  private readonly older = button('Older', { class: 'secondary', hidden: true }, () => void this.load(this.next));
  private next: number | null = null;
  /** How often was asked: only the answer to the last question counts. */
  private asked = 0;
  private rates: Rates = new Map();
  private readonly onStored = () => void this.load(null);

  constructor(private readonly context: Context) {
    const head = element('tr', {}, ...HEAD.map(([name, kind]) => element('th', { class: kind, scope: 'col' }, name)));
    this.main.append(
      element('h2', {}, 'Episodes'),
      this.remark,
      element('table', {}, element('thead', {}, head), this.body),
      this.older,
    );
    this.footer.append(
      button('← Fly', { class: 'secondary' }, () => context.go('fly')),
      element('span', { class: 'spacer' }),
      element(
        'span',
        { class: 'note' },
        'Every flight can be watched again: flown anew in this page from its keys, or, where the plant was elsewhere, shown from its recorded states.',
      ),
    );
    context.onStored.add(this.onStored);
    void this.load(null);
  }

  dispose(): void {
    this.context.onStored.delete(this.onStored);
  }

  /** Adds a part of the list, or begins it anew. */
  private async load(before: number | null): Promise<void> {
    const mine = (this.asked += 1);
    this.older.disabled = true;
    try {
      const [{ episodes, next }, rates] = await Promise.all([listEpisodes(before), ratesOfPlants()]);
      if (mine !== this.asked) return;
      this.rates = rates;
      if (before === null) this.body.replaceChildren();
      this.body.append(...episodes.map((episode) => this.row(episode)));
      this.next = next;
      this.older.hidden = next === null;
      this.remark.textContent = this.body.childElementCount === 0 ? 'Nothing was flown yet.' : '';
    } catch (error) {
      if (mine === this.asked) this.remark.textContent = `The episodes could not be read: ${reasonOf(error)}.`;
    } finally {
      if (mine === this.asked) this.older.disabled = false;
    }
  }

  private row(episode: EpisodeEntry): HTMLElement {
    const { id, ticks, plant, rule, pilot, seed, time_scale, started_at_ms, setup } = episode;
    const actions = setup.task?.options?.['actions'];
    const cell = (kind: string, ...content: (Node | string)[]) => element('td', { class: kind }, ...content);
    const open = episode.state === 'finished';
    const name = open ? element('a', { href: `#/episodes/${id}` }, String(id)) : String(id);
    const row = element(
      'tr',
      { class: open ? 'opens' : '' },
      cell('number', name),
      cell('', new Date(started_at_ms).toLocaleString()),
      cell('', typeof actions === 'string' ? `${plant} · ${actions}` : plantWords(setup.task)),
      cell('', RULE_NAMES[rule as keyof typeof RULE_NAMES] ?? rule),
      cell('', pilot),
      cell('', outcome(episode)),
      cell('number', flownWords(ticks, plant, this.rates)),
      cell('number', `${time_scale}×`),
      cell('number', String(seed)),
    );
    if (open) row.addEventListener('click', () => this.context.go(`episodes/${id}`));
    return row;
  }
}

function outcome(episode: EpisodeEntry): HTMLElement {
  if (episode.state === 'in-the-air') return element('span', { title: 'under way, or interrupted' }, '… not finished');
  if (episode.state === 'refused') return element('span', { title: episode.reason }, '⚠ refused');
  const { sign, word } = ENDING_WORDS[episode.ending];
  return element('span', { class: 'outcome', 'data-outcome': episode.ending }, `${sign} ${word}`);
}
