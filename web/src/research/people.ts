// The table of participants.

import { button, element, select } from '../dom';
import * as actions from './actions';
import { cell, endingSigns, kindBadges, lateSparkline, placeBar, refill, standing, table } from './bits';
import type { Row } from './deskapi';
import { covered } from './peek';
import type { Desk, DeskView } from './place';
import { filtered, type Filter } from './roll';
import { ago, STATUS, STATUSES } from './says';

const HEADS: [name: string, kind: string][] = [
  ['participant', ''],
  ['status', ''],
  ['cell', 'number'],
  ['place', ''],
  ['condition now', ''],
  ['connection', ''],
  ['late ticks', ''],
  ['endings', ''],
  ['interr.', 'number'],
  ['min', 'number'],
  ['notes', 'number'],
  ['', ''],
];

export class PeopleView implements DeskView {
  readonly main = element('main', { class: 'people' });
  private readonly filter: Filter = { code: '', status: 'all', others: true };
  private readonly body = element('div', { class: 'body' });
  private readonly count = element('span', { class: 'note' });
  /** Lines that were made, by participant, and of what: with hundreds of rows few change at a time. */
  private readonly lines = new Map<number, { of: string; line: HTMLElement }>();
  private readonly deaf: () => void;

  constructor(private readonly desk: Desk) {
    this.main.append(this.toolbar(), this.body);
    const [deafToNews, deafToPeek] = [desk.feed.listen(() => this.show()), desk.peek.listen(() => this.show())];
    this.deaf = () => {
      deafToNews();
      deafToPeek();
    };
    this.show();
  }

  dispose(): void {
    this.deaf();
  }

  private toolbar(): HTMLElement {
    const search = element('input', { type: 'search', placeholder: 'code', 'aria-label': 'Part of a code' });
    search.addEventListener('input', () => this.change({ code: search.value }));
    const choices: [string, string][] = [
      ['all', 'any status'],
      ['here', 'connected now'],
      ...STATUSES.map((status): [string, string] => [status, STATUS[status].word]),
    ];
    const status = select('', choices, 'all', (chosen) => this.change({ status: chosen as Filter['status'] }));
    status.querySelector('select')!.setAttribute('aria-label', 'Status');
    const others = element('input', { type: 'checkbox', checked: true });
    others.addEventListener('change', () => this.change({ others: others.checked }));
    return element(
      'div',
      { class: 'toolbar' },
      search,
      status,
      element('label', {}, others, 'tests and bots'),
      this.count,
      this.desk.peek.node(),
      element('span', { class: 'spacer' }),
      button('New participant…', { class: 'primary' }, () => actions.create(this.desk.feed)),
    );
  }

  private change(change: Partial<Filter>): void {
    Object.assign(this.filter, change);
    this.show();
  }

  private show(): void {
    const { rows } = this.desk.feed;
    const shown = filtered(rows, this.filter);
    this.count.textContent = shown.length === rows.length ? `${rows.length}` : `${shown.length} of ${rows.length}`;
    const empty = rows.length === 0 ? 'Nobody was invited yet. Make the first link.' : 'Nobody fits the filter.';
    refill(
      this.body,
      table(
        HEADS,
        shown.map((row) => this.lineOf(row)),
        empty,
        { class: 'people-table' },
      ),
    );
  }

  private lineOf(row: Row): HTMLElement {
    const of = JSON.stringify([
      row,
      this.desk.peek.covers,
      row.last_seen_ms === null ? '' : ago(row.last_seen_ms, Date.now()),
    ]);
    const known = this.lines.get(row.id);
    if (known?.of === of) return known.line;
    const line = this.line(row);
    this.lines.set(row.id, { of, line });
    return line;
  }

  private line(row: Row): HTMLElement {
    const line = element(
      'tr',
      { class: 'opens' },
      cell('code', element('a', { href: `#/people/${row.id}` }, row.code), ...kindBadges(row)),
      cell('', standing(row)),
      cell('number', row.cell === null ? '–' : String(row.cell + 1)),
      cell('wide', placeBar(row)),
      cell('', conditionNow(row)),
      cell('', connection(row)),
      cell('', lateSparkline(row.late_ticks)),
      cell('', this.desk.peek.coversThose(row) ? covered() : endingSigns(row.endings)),
      cell('number', row.interruptions === 0 ? '–' : String(row.interruptions)),
      cell('number', row.minutes === null ? '–' : String(Math.round(row.minutes))),
      cell('number', row.notes === 0 ? '–' : String(row.notes)),
      cell('menu-cell', menu(this.desk, row)),
    );
    line.addEventListener('click', (event) => {
      if ((event.target as Element).closest('a, button, details') === null) this.desk.go(`people/${row.id}`);
    });
    return line;
  }
}

/** The order of conditions, the present one marked. */
function conditionNow({ order, condition, status }: Row): HTMLElement {
  const tags = order.map((name) => {
    const now = name === condition && status === 'under-way';
    return element('span', { class: now ? 'tag now' : 'tag' }, name);
  });
  return element('span', { class: 'order' }, ...(tags.length === 0 ? ['–'] : tags));
}

export function connection({ id, connected, in_air, last_seen_ms }: Row): HTMLElement {
  if (in_air !== null) return element('a', { href: `#/watch/${id}`, class: 'watch' }, '▶ in a flight');
  if (connected) return element('span', { class: 'here' }, '◆ here');
  return element('span', { class: 'away' }, last_seen_ms === null ? 'never here' : ago(last_seen_ms, Date.now()));
}

/** What can be done to a participant now. */
export function menu(desk: Desk, row: Row): HTMLElement {
  const { feed } = desk;
  const entry = (label: string, act: () => void) =>
    button(label, {}, () => {
      box.open = false;
      act();
    });
  const gone = row.status === 'withdrawn';
  const entries = [
    entry('Note…', () => actions.note(feed, row)),
    entry('New link…', () => actions.newLink(row)),
    row.status === 'excluded'
      ? entry('Reinstate…', () => actions.reinstate(feed, row))
      : entry('Exclude…', () => actions.exclude(feed, row)),
    entry('Withdraw…', () => actions.withdraw(feed, row, () => desk.go('people'))),
  ];
  const summary = element('summary', { 'aria-label': `What to do with ${row.code}` }, '⋯');
  const box = element('details', { class: 'menu', hidden: gone }, summary, element('div', {}, ...entries));
  box.addEventListener('focusout', (event) => {
    if (!box.contains(event.relatedTarget as Node | null)) box.open = false;
  });
  return box;
}
