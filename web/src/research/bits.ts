// Small pictures and parts that several views of the desk show.

import type { Ending } from '../core';
import { button, element } from '../dom';
import { ENDING_WORDS } from '../words';
import type { Row, Status } from './deskapi';
import { STATUS, stepWords } from './says';

const SVG = 'http://www.w3.org/2000/svg';

export function svg(name: string, attributes: Record<string, string | number>, ...children: Node[]): SVGElement {
  const made = document.createElementNS(SVG, name);
  for (const [attribute, value] of Object.entries(attributes)) made.setAttribute(attribute, String(value));
  made.append(...children);
  return made;
}

export function statusChip(status: Status): HTMLElement {
  const { sign, word } = STATUS[status];
  return element('span', { class: 'status-chip', 'data-status': status }, element('i', {}, sign), word);
}

/** Status, and what the study's rules of exclusion have to say. */
export function standing({ status, breaches, excluded }: Pick<Row, 'status' | 'breaches' | 'excluded'>): HTMLElement {
  const chip = statusChip(status);
  if (excluded !== null) chip.title = `${excluded.reason} (${excluded.by})`;
  else if (breaches.length > 0 && status !== 'withdrawn') {
    const title = `By the study’s rules this participant may have to be excluded: ${breaches.join('; ')}`;
    chip.append(element('span', { class: 'breach', title }, '⚠'));
  }
  return chip;
}

/** What sets a row apart from people's: a trial of the experimenter's, or no person at all. */
export function kindBadges({ test, simulated }: Pick<Row, 'test' | 'simulated'>): HTMLElement[] {
  const badge = (word: string, title: string) => element('span', { class: 'badge', title }, word);
  return [
    ...(test ? [badge('test', 'A trial run: it fills no cell and is in no result')] : []),
    ...(simulated ? [badge('bot', 'A simulated pilot, not a person: it fills no cell and is in no result')] : []),
  ];
}

/** A bar of how far somebody is, with the step in words. */
export function placeBar({ place, total, step, status }: Row): HTMLElement {
  const part = status === 'completed' ? 1 : total === 0 ? 0 : place / total;
  const fill = element('i', {});
  fill.style.width = `${100 * part}%`;
  const words = status === 'completed' ? 'all done' : step === null ? '' : stepWords(step);
  return element(
    'span',
    { class: 'place', title: `${place} of ${total} steps done` },
    element('span', { class: 'track' }, fill),
    element('span', { class: 'words' }, words),
  );
}

/** Late ticks flight by flight, as bars of their share; what is over 2 % stands out. */
export function lateSparkline(shares: number[]): HTMLElement {
  if (shares.length === 0) return element('span', { class: 'none' }, '–');
  const [bar, height, most] = [4, 18, 30];
  const last = shares.slice(-most);
  const worst = Math.max(...last);
  const full = Math.max(worst, 0.02);
  const bars = last.map((share, i) =>
    svg('rect', {
      x: i * bar,
      width: bar - 1,
      y: height - Math.max(1, (share / full) * height),
      height: Math.max(1, (share / full) * height),
      class: share > 0.02 ? 'much' : '',
    }),
  );
  const percent = `${(100 * worst).toFixed(worst > 0 && worst < 0.01 ? 1 : 0)} %`;
  const picture = svg('svg', { width: last.length * bar, height, 'aria-hidden': 'true' }, ...bars);
  return element(
    'span',
    { class: 'sparkline', title: `Share of late ticks in the last ${last.length} flights; at worst ${percent}` },
    picture,
    element('small', {}, `max ${percent}`),
  );
}

/** How flights ended, each by its sign and how often. */
export function endingSigns(endings: Row['endings']): HTMLElement {
  const seen = (Object.keys(ENDING_WORDS) as Ending[]).filter((ending) => (endings[ending] ?? 0) > 0);
  if (seen.length === 0) return element('span', { class: 'none' }, '–');
  const sign = (ending: Ending) =>
    element(
      'span',
      { class: 'outcome', 'data-outcome': ending, title: `${endings[ending]} × ${ENDING_WORDS[ending].word}` },
      `${ENDING_WORDS[ending].sign} ${endings[ending]}`,
    );
  return element('span', { class: 'endings' }, ...seen.map(sign));
}

/** A section of a view with its heading. */
export function section(title: string, attributes: Record<string, string>, ...content: (Node | string)[]): HTMLElement {
  return element('section', attributes, element('h3', {}, title), ...content);
}

/** A table with its head; `kinds` are classes of columns. */
export function table(
  heads: [name: string, kind: string][],
  rows: HTMLElement[],
  empty: string,
  attributes: Record<string, string> = {},
): HTMLElement {
  const head = element('tr', {}, ...heads.map(([name, kind]) => element('th', { class: kind, scope: 'col' }, name)));
  const none = element('tr', {}, element('td', { class: 'empty', colspan: String(heads.length) }, empty));
  return element(
    'table',
    attributes,
    element('thead', {}, head),
    element('tbody', {}, ...(rows.length === 0 ? [none] : rows)),
  );
}

export function cell(kind: string, ...content: (Node | string)[]): HTMLTableCellElement {
  return element('td', { class: kind }, ...content);
}

/** A button that copies a text, and says that it did. */
export function copyButton(text: string, label = 'Copy'): HTMLButtonElement {
  const made = button(label, { class: 'primary' }, () => {
    void navigator.clipboard?.writeText(text).then(
      () => (made.textContent = 'Copied'),
      () => (made.textContent = 'Select it and press Ctrl-C'),
    );
    setTimeout(() => (made.textContent = label), 2500);
  });
  return made;
}

/** A file to save, made here. */
export function saveLink(name: string, type: string, text: string): HTMLAnchorElement {
  const link = element('a', { class: 'secondary', download: name, href: '#' }, 'Save');
  link.addEventListener('click', () => {
    link.href = URL.createObjectURL(new Blob([text], { type }));
    setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
  });
  return link;
}

/** Fills a part anew, unless somebody is selecting text in it or has a menu open there; the focus stays where it was. */
export function refill(part: HTMLElement, ...content: Node[]): void {
  const selection = getSelection();
  const selecting = selection !== null && !selection.isCollapsed && part.contains(selection.anchorNode);
  if (selecting || part.querySelector('details.menu[open]') !== null) return;
  const [scroll, focus] = [part.scrollTop, focusIn(part)];
  part.replaceChildren(...content);
  part.scrollTop = scroll;
  if (focus !== null) part.querySelector<HTMLElement>(focus)?.focus();
}

/** What finds the focused link or menu again after it was made anew. */
function focusIn(part: HTMLElement): string | null {
  const at = document.activeElement;
  if (at === null || !part.contains(at)) return null;
  for (const name of ['href', 'aria-label']) {
    const value = at.getAttribute(name);
    if (value !== null) return `[${name}="${CSS.escape(value)}"]`;
  }
  return null;
}
