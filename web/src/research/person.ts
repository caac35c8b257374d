// One participant: flights, answers, and the log that everything follows from.

import { element } from '../dom';
import { say } from '../message';
import { flownWords, ratesOfPlants, type Rates } from '../rates';
import { ENDING_WORDS, reasonOf } from '../words';
import { cell, kindBadges, lateSparkline, placeBar, saveLink, section, standing, table } from './bits';
import type { DeskEpisode, Logged, Row } from './deskapi';
import * as api from './deskapi';
import { connection, menu } from './people';
import { covered, isMeasured } from './peek';
import type { Desk, DeskView } from './place';
import { ago, clock, eventWords, stepWords } from './says';

/** Steps that ask for answers. */
const FORMS = /^demographics$|(^|\/)questionnaire\//;
/** How many flights of one person are listed. */
const MOST_EPISODES = 1000;

export class PersonView implements DeskView {
  readonly main = element('main', { class: 'person' });
  private readonly head = element('header', { class: 'person-head' });
  private readonly flights = element('div', { class: 'body' });
  private readonly answers = element('div', { class: 'body' });
  private readonly log = element('div', { class: 'body' });
  private readonly deaf: () => void;
  private seen = '';

  constructor(
    private readonly desk: Desk,
    private readonly id: number,
  ) {
    this.main.append(
      this.head,
      section('Flights', { class: 'panel-box flights' }, desk.peek.node(), this.flights),
      section('Answers', { class: 'panel-box answers' }, this.answers),
      section('Log', { class: 'panel-box log' }, this.log),
    );
    const [deafToNews, deafToPeek] = [
      desk.feed.listen((changed) => this.show(changed.has(id))),
      desk.peek.listen(() => this.show(true)),
    ];
    this.deaf = () => {
      deafToNews();
      deafToPeek();
    };
    this.show(true);
  }

  dispose(): void {
    this.deaf();
  }

  private show(changed: boolean): void {
    const row = this.desk.feed.row(this.id);
    if (row === undefined) return;
    if (this.head.querySelector('details[open]') === null) this.head.replaceChildren(...this.headOf(row));
    // Without news everything below is as it was: what somebody has unfolded stays unfolded.
    const state = JSON.stringify([row.place, row.status, row.notes, row.in_air?.episode]);
    if (!changed && state === this.seen) return;
    this.seen = state;
    void this.read();
  }

  private async read(): Promise<void> {
    try {
      const [events, { episodes }, rates] = await Promise.all([
        api.log(this.id),
        api.episodes({ participant: this.id, limit: MOST_EPISODES }),
        ratesOfPlants(),
      ]);
      const isCovered = this.desk.peek.coversThose(this.desk.feed.row(this.id));
      this.flights.replaceChildren(flightsTable({ episodes, events, rates, isCovered }));
      this.answers.replaceChildren(answersTable(events));
      this.log.replaceChildren(logList(events, isCovered));
    } catch (error) {
      say(`The log could not be read: ${reasonOf(error)}`);
    }
  }

  private headOf(row: Row): HTMLElement[] {
    const fact = (name: string, ...value: (Node | string)[]) =>
      element('div', { class: 'fact' }, element('small', {}, name), element('div', {}, ...value));
    const order = row.order.map((name) =>
      element('span', { class: name === row.condition && row.status === 'under-way' ? 'tag now' : 'tag' }, name),
    );
    return [
      element('a', { href: '#/people', class: 'back' }, '← Participants'),
      element('h2', {}, row.code, ...kindBadges(row)),
      standing(row),
      fact('place', placeBar(row)),
      fact('cell', row.cell === null ? '–' : String(row.cell + 1)),
      fact('order', element('span', { class: 'order' }, ...order)),
      fact('connection', connection(row)),
      fact('late ticks', lateSparkline(row.late_ticks)),
      ...(row.excluded === null ? [] : [fact('excluded', row.excluded.reason)]),
      ...(row.breaches.length === 0 ? [] : [fact('meets a rule of exclusion', row.breaches.join('; '))]),
      element('span', { class: 'spacer' }),
      menu(this.desk, row),
    ];
  }
}

interface Flights {
  episodes: DeskEpisode[];
  events: Logged[];
  rates: Rates;
  isCovered: boolean;
}

function flightsTable({ episodes, events, rates, isCovered }: Flights): HTMLElement {
  const interrupted = (step: string | null) =>
    events.filter(({ event, step: at }) => event === 'flight-interrupted' && at === step).length;
  const noted = (step: string | null) =>
    events.filter(({ event, step: at }) => event === 'flight-noted' && at === step).at(-1);
  const now = Date.now();
  const line = (episode: DeskEpisode) => {
    const open = episode.state === 'finished';
    const breaks = interrupted(episode.step);
    return element(
      'tr',
      {},
      cell('', open ? element('a', { href: `#/episodes/${episode.id}` }, `▶ ${episode.id}`) : String(episode.id)),
      cell('', episode.step === null ? '–' : stepWords(episode.step)),
      cell('', outcome(episode, isCovered && isMeasured(episode.step))),
      cell('number', flownWords(episode.ticks, episode.setup.task.plant, rates)),
      cell('number', lateShare(noted(episode.step), episode.ticks)),
      cell('number', breaks === 0 ? '–' : String(breaks)),
      cell('number', clock(episode.started_at_ms, now)),
    );
  };
  return table(
    [
      ['episode', ''],
      ['step', ''],
      ['outcome', ''],
      ['flown', 'number'],
      ['late', 'number'],
      ['interr.', 'number'],
      ['began', 'number'],
    ],
    episodes.map(line),
    'No flights yet.',
  );
}

function lateShare(noted: Logged | undefined, ticks: number): string {
  const telemetry = noted?.['telemetry'] as Record<string, unknown> | undefined;
  const late = telemetry?.['late_ticks'];
  if (typeof late !== 'number' || ticks === 0) return '–';
  return `${((100 * late) / ticks).toFixed(1)} %`;
}

/** How a flight ended, unless that is kept back. */
export function outcome(episode: DeskEpisode, isCovered: boolean): HTMLElement {
  if (episode.state === 'in-the-air') return element('span', {}, '… not finished');
  if (episode.state === 'refused') return element('span', { title: episode.reason }, '⚠ refused');
  if (isCovered) return covered();
  const { sign, word } = ENDING_WORDS[episode.ending];
  return element('span', { class: 'outcome', 'data-outcome': episode.ending }, `${sign} ${word}`);
}

/** Which forms were answered, and how much of them; what was answered belongs into the export, not onto a screen. */
export function answersTable(events: Logged[]): HTMLElement {
  const forms = events.flatMap((event) => {
    const data = event['data'];
    if (event.event !== 'step-done' || !FORMS.test(String(event['step']))) return [];
    if (typeof data !== 'object' || data === null) return [];
    const values = Object.values(answersOf(data as Record<string, unknown>));
    return values.length === 0 ? [] : [{ event, values }];
  });
  const line = ({ event, values }: (typeof forms)[number]) => {
    const given = values.filter((value) => value !== null).length;
    const minutes = event['page_ms'];
    return element(
      'tr',
      {},
      cell('', stepWords(String(event['step']))),
      cell('number', `${given} of ${values.length}`),
      cell('', given === values.length ? '● complete' : given === 0 ? '○ not answered' : '◐ in part'),
      cell('number', typeof minutes === 'number' ? `${Math.round(minutes / 1000)} s` : '–'),
    );
  };
  return table(
    [
      ['form', ''],
      ['answered', 'number'],
      ['', ''],
      ['took', 'number'],
    ],
    forms.map(line),
    'Nothing was answered yet.',
  );
}

/** The answers of a step's data: they may lie beside each other or under `answers`. */
function answersOf(data: Record<string, unknown>): Record<string, unknown> {
  const inner = data['answers'];
  return typeof inner === 'object' && inner !== null ? (inner as Record<string, unknown>) : data;
}

function logList(events: Logged[], isCovered: boolean): HTMLElement {
  if (events.length === 0) return element('p', { class: 'empty' }, 'Nothing was logged: invited, not yet here.');
  const now = Date.now();
  const line = (event: Logged) => {
    const { what, detail } = eventWords(event, isCovered);
    const raw = element('details', {}, element('summary', { title: 'As it is stored' }, '{ }'));
    raw.addEventListener('toggle', () => {
      if (raw.open && raw.childElementCount === 1) raw.append(element('pre', {}, JSON.stringify(event, null, 2)));
    });
    return element(
      'li',
      { 'data-event': event.event },
      element('span', { class: 'seq' }, String(event.seq)),
      element(
        'time',
        { title: `${new Date(event.at_ms).toISOString()}, ${ago(event.at_ms, now)}` },
        clock(event.at_ms, now),
      ),
      element('span', {}, what, ...(detail === '' ? [] : [' ', element('small', {}, detail)])),
      raw,
    );
  };
  const lines = events.map((event) => JSON.stringify(event)).join('\n');
  return element(
    'div',
    {},
    element('ol', { class: 'events' }, ...[...events].reverse().map(line)),
    element(
      'p',
      { class: 'note' },
      'The log is what is stored; everything above follows from it. ',
      saveLink('events.jsonl', 'application/jsonl', `${lines}\n`),
    ),
  );
}
