// The study at a glance: who has done what of what was planned, who is where now, what just happened.

import { button, element } from '../dom';
import { cell, kindBadges, placeBar, refill, section, statusChip, table } from './bits';
import type { Cell, Logged, Row, StudyReport } from './deskapi';
import * as api from './deskapi';
import { parametersOf } from '../words';
import type { Desk, DeskView } from './place';
import { isGone, isQuiet } from './roll';
import { ago, clock, eventWords, isNews, STATUS, STATUSES } from './says';

/** Logs that are read for what just happened, and events that are shown. */
const [RECENT_PEOPLE, RECENT_EVENTS] = [12, 40];
/** Most places of a cell that are drawn one by one. */
const MOST_SLOTS = 14;

export class OverviewView implements DeskView {
  readonly main = element('main', { class: 'overview' });
  private readonly tally = element('div', { class: 'tally' });
  private readonly cells = element('div', { class: 'body' });
  private readonly now = element('div', { class: 'body' });
  private readonly quiet = element('div', { class: 'body' });
  private readonly recent = element('div', { class: 'body' });
  private readonly design = element('div', { class: 'body' });
  private readonly logs = new Map<number, Logged[]>();
  private readonly deaf: () => void;
  private designOf = '';

  constructor(private readonly desk: Desk) {
    this.main.append(
      this.tally,
      element(
        'div',
        { class: 'column' },
        section('Where everybody is', { class: 'panel-box' }, this.now),
        section('Plan and progress', { class: 'panel-box' }, this.cells),
        section('Dropped out, or quiet', { class: 'panel-box' }, this.quiet),
      ),
      element(
        'div',
        { class: 'column' },
        section('What just happened', { class: 'panel-box recent' }, this.recent),
        section('Design', { class: 'panel-box' }, this.design),
      ),
    );
    this.deaf = desk.feed.listen((changed) => void this.show(changed));
    void this.show(new Set());
  }

  dispose(): void {
    this.deaf();
  }

  private async show(changed: ReadonlySet<number>): Promise<void> {
    const { study, rows } = this.desk.feed;
    if (study === null) return;
    refill(this.tally, ...tally(study, rows));
    refill(this.cells, cellsTable(study.cells));
    refill(this.now, this.nowTable(rows));
    refill(this.quiet, this.quietTable(rows));
    if (this.designOf !== study.hash) this.design.replaceChildren(designOf(study));
    this.designOf = study.hash;
    await this.readLogs(rows, changed);
    refill(this.recent, this.recentList(rows));
  }

  private nowTable(rows: Row[]): HTMLElement {
    const there = rows.filter((row) => row.connected || row.in_air !== null);
    const line = (row: Row) =>
      this.opens(
        row,
        cell('code', row.code, ...kindBadges(row)),
        cell('', row.condition ?? '–'),
        cell('wide', placeBar(row)),
        cell('', this.airOf(row)),
      );
    return table(
      [
        ['who', ''],
        ['condition', ''],
        ['place', ''],
        ['', ''],
      ],
      there.sort((a, b) => Number(b.in_air !== null) - Number(a.in_air !== null)).map(line),
      'Nobody is connected.',
    );
  }

  private airOf({ id, in_air }: Row): HTMLElement | string {
    if (in_air === null) return '';
    return element('a', { href: `#/watch/${id}`, class: 'watch', title: 'Watch this flight' }, '▶ in a flight');
  }

  private quietTable(rows: Row[]): HTMLElement {
    const now = Date.now();
    const left = rows.filter((row) => isGone(row) || isQuiet(row, now));
    const line = (row: Row) =>
      this.opens(
        row,
        cell('code', row.code, ...kindBadges(row)),
        cell('', statusChip(row.status)),
        cell('wide', placeBar(row)),
        cell('number', row.last_seen_ms === null ? '' : ago(row.last_seen_ms, now)),
      );
    return table(
      [
        ['who', ''],
        ['', ''],
        ['got to', ''],
        ['last seen', 'number'],
      ],
      left.map(line),
      'Nobody dropped out, and nobody under way has been away for half an hour.',
    );
  }

  private opens(row: Row, ...cells: HTMLElement[]): HTMLElement {
    const line = element('tr', { class: 'opens' }, ...cells);
    line.addEventListener('click', (event) => {
      if ((event.target as Element).closest('a, button') === null) this.desk.go(`people/${row.id}`);
    });
    return line;
  }

  /** Reads the logs of those that were seen last, and again those of whom there is news. */
  private async readLogs(rows: Row[], changed: ReadonlySet<number>): Promise<void> {
    const newest = [...rows].sort((a, b) => (b.last_seen_ms ?? 0) - (a.last_seen_ms ?? 0)).slice(0, RECENT_PEOPLE);
    const wanted = newest.filter(({ id }) => changed.has(id) || !this.logs.has(id));
    const read = async ({ id }: Row) => {
      const events = await api.log(id).catch(() => null);
      if (events !== null) this.logs.set(id, events);
    };
    await Promise.all(wanted.map(read));
  }

  private recentList(rows: Row[]): HTMLElement {
    const all = rows.flatMap((row) => (this.logs.get(row.id) ?? []).filter(isNews).map((event) => ({ row, event })));
    const newest = all.sort((a, b) => b.event.at_ms - a.event.at_ms).slice(0, RECENT_EVENTS);
    const now = Date.now();
    const line = ({ row, event }: (typeof all)[number]) => {
      const { what, detail } = eventWords(event, this.desk.peek.coversThose(row));
      return element(
        'li',
        { 'data-event': event.event },
        element('time', { title: new Date(event.at_ms).toLocaleString() }, clock(event.at_ms, now)),
        element('a', { href: `#/people/${row.id}` }, row.code),
        element('span', {}, what, ...(detail === '' ? [] : [' ', element('small', {}, detail)])),
      );
    };
    if (newest.length === 0) return element('p', { class: 'empty' }, 'Nothing yet.');
    return element('ol', { class: 'events' }, ...newest.map(line));
  }
}

/** What is counted where the word alone leaves it open. */
const MEANINGS: Record<string, string> = {
  air: 'Flights in the air at this moment',
  'under-way': 'Participants who have begun and not finished, here or not',
  others: 'They are in none of the other numbers',
};

/** One number a status, and how much of the plan is done. */
function tally(study: StudyReport, rows: Row[]): HTMLElement[] {
  const finished = study.cells.reduce((sum, { finished }) => sum + finished, 0);
  const bar = element('progress', { max: String(Math.max(study.planned, 1)), value: String(finished) });
  const plan = element(
    'div',
    { class: 'plan' },
    element('b', {}, String(finished)),
    element('span', {}, study.planned > 0 ? `of ${study.planned} planned have finished` : 'have finished'),
    bar,
  );
  const number = (count: number, word: string, kind: string, sign = '') =>
    element(
      'div',
      { class: 'number-box', 'data-status': kind, title: MEANINGS[kind] ?? '' },
      element('b', {}, String(count)),
      `${sign} ${word}`.trim(),
    );
  const air = rows.filter((row) => row.in_air !== null).length;
  const here = rows.filter((row) => row.connected).length;
  return [
    plan,
    number(air, 'in a flight', 'air', '▶'),
    number(here, 'connected', 'connected', '◆'),
    ...STATUSES.map((status) => number(study.counts[status] ?? 0, STATUS[status].word, status, STATUS[status].sign)),
    number(study.tests + study.simulated, 'tests and bots', 'others', '⚙'),
  ];
}

/** Cells with a place for everybody who is planned: taken, being taken, open. */
function cellsTable(cells: Cell[]): HTMLElement {
  const line = ({ cell: number, order, planned, finished, in_progress }: Cell) =>
    element(
      'tr',
      {},
      cell('number', String(number + 1)),
      cell('', ...order.flatMap((name, i) => [...(i > 0 ? [element('i', { class: 'then' }, '→')] : []), chip(name)])),
      cell('wide', slots(planned, finished, in_progress)),
      cell('number', `${finished} / ${planned}`),
    );
  const total = cells.reduce((sum, { in_progress }) => sum + in_progress, 0);
  return element(
    'div',
    {},
    table(
      [
        ['cell', 'number'],
        ['order of conditions', ''],
        ['places', ''],
        ['finished', 'number'],
      ],
      cells.map(line),
      'The design has no cells.',
    ),
    element(
      'p',
      { class: 'note' },
      element('i', { class: 'slot done' }),
      'finished ',
      element('i', { class: 'slot going' }),
      `under way (${total}) `,
      element('i', { class: 'slot' }),
      'open. Tests, bots and who was excluded fill no cell; the next participant goes where most are missing.',
    ),
  );
}

const chip = (name: string) => element('span', { class: 'tag' }, name);

function slots(planned: number, finished: number, going: number): HTMLElement {
  const all = Math.max(planned, finished + going);
  const words = `${finished} finished, ${going} under way, ${planned} planned`;
  if (all > MOST_SLOTS) {
    const part = (kind: string, count: number) => {
      const made = element('i', { class: kind });
      made.style.width = `${(100 * count) / all}%`;
      return made;
    };
    return element('span', { class: 'track two', title: words }, part('done', finished), part('going', going));
  }
  const slot = (i: number) =>
    element('i', { class: `slot ${i < finished ? 'done' : i < finished + going ? 'going' : ''}` });
  return element('span', { class: 'slots', title: words }, ...Array.from({ length: all }, (_, i) => slot(i)));
}

/** The rows of the design, those of the conditions with the parameters of their rules. */
export function designRows({ rows, conditions }: Pick<StudyReport, 'rows' | 'conditions'>): [string, string][] {
  const rules = new Map(conditions.map(({ name, rule }) => [`Condition ${name}`, rule]));
  return rows.map(([name, words]) => {
    const rule = rules.get(name);
    const parameters = rule === undefined ? '' : parametersOf(rule);
    return [name, parameters === '' ? words : words.replace(`rule ${rule!.rule}`, (said) => `${said} (${parameters})`)];
  });
}

function designOf(study: StudyReport): HTMLElement {
  const { hash, text, name } = study;
  const file = element('details', {}, element('summary', {}, `${name}.toml`), element('pre', {}, text));
  const copy = button(
    'Copy',
    { class: 'quiet-button', title: 'Copy the hash' },
    () => void navigator.clipboard?.writeText(hash),
  );
  return element(
    'div',
    {},
    element(
      'dl',
      {},
      ...designRows(study).flatMap(([name, words]) => [element('dt', {}, name), element('dd', {}, words)]),
      element('dt', {}, 'hash'),
      element('dd', { class: 'hash' }, element('code', { title: hash }, `${hash.slice(0, 16)}…`), copy),
    ),
    file,
  );
}
