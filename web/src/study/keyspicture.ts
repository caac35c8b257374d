// A keyboard with the keys that fly, drawn from the plant's controls; they light up when they are pressed, and can be
// changed.

import type { Control } from '../core';
import { button, element } from '../dom';
import { keyCap } from '../keys';
import { isUsable, type KeyChoice } from './keychoice';
import type { Words } from './text';

/** A key on the picture: its code, and where it lies in units of a key's width. */
interface Place {
  code: string;
  x: number;
  y: number;
  width: number;
}

const ROWS: [offset: number, codes: string[]][] = [
  [0, ['Digit1', 'Digit2', 'Digit3', 'Digit4', 'Digit5', 'Digit6', 'Digit7', 'Digit8', 'Digit9', 'Digit0']],
  [0.5, [...'QWERTYUIOP'].map((letter) => `Key${letter}`)],
  [0.75, [...'ASDFGHJKL'].map((letter) => `Key${letter}`)],
  [1.25, [...'ZXCVBNM'].map((letter) => `Key${letter}`)],
];
const [ARROWS_X, ARROWS_Y] = [11.4, 3];
const PLACES: Place[] = [
  ...ROWS.flatMap(([offset, codes], y) => codes.map((code, i) => ({ code, x: offset + i, y, width: 1 }))),
  { code: 'Space', x: 2.6, y: 4, width: 5.2 },
  { code: 'ArrowUp', x: ARROWS_X + 1, y: ARROWS_Y, width: 1 },
  { code: 'ArrowLeft', x: ARROWS_X, y: ARROWS_Y + 1, width: 1 },
  { code: 'ArrowDown', x: ARROWS_X + 1, y: ARROWS_Y + 1, width: 1 },
  { code: 'ArrowRight', x: ARROWS_X + 2, y: ARROWS_Y + 1, width: 1 },
];
const [UNIT, GAP, WIDTH, HEIGHT] = [46, 5, 14.4, 5];

/** What this keyboard prints on its keys, as far as the browser says. */
export type Layout = ReadonlyMap<string, string>;

/** The picture, its list of controls, and the buttons to change keys. */
export class KeysPicture {
  readonly node = element('figure', { class: 'keys-picture' });
  private readonly listeners = new AbortController();
  private readonly held = new Set<string>();
  private waiting: string | null = null;
  private layout: Layout = new Map();

  constructor(
    private readonly controls: Control[],
    private readonly choice: KeyChoice,
    private readonly words: Words,
  ) {
    const { signal } = this.listeners;
    window.addEventListener('keydown', (event) => this.down(event), { signal });
    window.addEventListener('keyup', (event) => this.light(event.code, false), { signal });
    window.addEventListener('blur', () => [...this.held].forEach((code) => this.light(code, false)), { signal });
    this.show();
    void layoutOf().then((layout) => {
      this.layout = layout;
      this.show();
    });
  }

  dispose(): void {
    this.listeners.abort();
  }

  private show(): void {
    const bound = this.choice.bind(this.controls);
    const { words } = this;
    const change = this.controls.map((control) =>
      this.row(
        control,
        bound.find(({ name }) => name === control.name)!,
      ),
    );
    const reset = button(words.instructions.usual, { class: 'secondary small' }, () => {
      this.choice.reset();
      this.waiting = null;
      this.show();
    });
    reset.hidden = !this.choice.isRemapped(this.controls);
    this.node.replaceChildren(
      keyboard(bound, this.layout, words),
      element('figcaption', {}, `${words.instructions.try} ${words.instructions.pad}`),
      element('div', { class: 'bindings' }, ...change, reset),
    );
    this.held.forEach((code) => this.light(code, true));
  }

  private row(control: Control, bound: Control): HTMLElement {
    const { words } = this;
    const name = words.flight.control(control.name);
    const isWaiting = this.waiting === control.name;
    const caps = bound.keys.flatMap((code, i) => [
      ...(i === 0 ? [] : [` ${words.instructions.or} `]),
      element('kbd', { 'data-code': code }, this.cap(code)),
    ]);
    const press = button(
      isWaiting ? words.instructions.press : words.instructions.change,
      { class: 'secondary small', 'aria-label': words.instructions.changeFor(name), 'data-control': control.name },
      () => {
        this.waiting = isWaiting ? null : control.name;
        this.show();
        this.node.querySelector<HTMLElement>(`[data-control="${control.name}"]`)?.focus();
      },
    );
    press.classList.toggle('waiting', isWaiting);
    return element('div', { class: 'binding' }, element('b', {}, name), element('span', {}, ...caps), press);
  }

  private cap(code: string): string {
    return this.layout.get(code)?.toUpperCase() ?? keyCap(code);
  }

  private down(event: KeyboardEvent): void {
    const { waiting } = this;
    if (waiting !== null && !event.repeat) this.take(event, waiting);
    else if (this.isBound(event.code)) {
      if (['Space', 'ArrowUp', 'ArrowDown'].includes(event.code) && event.target === document.body)
        event.preventDefault();
      this.light(event.code, true);
    }
  }

  private take(event: KeyboardEvent, control: string): void {
    event.preventDefault();
    if (event.code === 'Tab') return;
    this.waiting = null;
    if (isUsable(event.code)) this.choice.choose(this.controls, control, event.code);
    this.show();
    this.node.querySelector<HTMLElement>(`[data-control="${control}"]`)?.focus();
  }

  private isBound(code: string): boolean {
    return this.choice.bind(this.controls).some(({ keys }) => keys.includes(code));
  }

  private light(code: string, on: boolean): void {
    if (on) this.held.add(code);
    else this.held.delete(code);
    this.node.querySelectorAll(`[data-code="${code}"]`).forEach((key) => key.classList.toggle('held', on));
  }
}

/** A drawn keyboard; the keys that fly carry a colour, and the control's name below their letter. */
function keyboard(bound: Control[], layout: Layout, words: Words): SVGElement {
  const picture = svg('svg', {
    viewBox: `0 0 ${WIDTH * UNIT} ${HEIGHT * UNIT}`,
    role: 'img',
    'aria-label': words.instructions.keysLabel,
  });
  for (const place of PLACES) picture.append(drawnKey(place, bound, layout, words));
  return picture;
}

function drawnKey({ code, x, y, width }: Place, bound: Control[], layout: Layout, words: Words): SVGElement {
  const control = bound.find(({ keys }) => keys.includes(code));
  const [left, top, wide] = [x * UNIT, y * UNIT, width * UNIT - GAP];
  const group = svg('g', { class: control === undefined ? 'key' : 'key flies', 'data-code': code });
  group.append(svg('rect', { x: left, y: top, width: wide, height: UNIT - GAP, rx: 7 }));
  const middle = left + wide / 2;
  const isNamed = control !== undefined;
  const letter = svg('text', { x: middle, y: top + (isNamed ? 17 : 25), class: 'cap' });
  letter.textContent = code === 'Space' ? (isNamed ? '␣' : '') : (layout.get(code)?.toUpperCase() ?? keyCap(code));
  group.append(letter);
  if (isNamed) {
    const name = svg('text', { x: middle, y: top + 33, class: 'name' });
    const text = words.instructions.short(control.name);
    name.textContent = text.length > 8 && width === 1 ? `${text.slice(0, 6)}…` : text;
    group.append(name);
  }
  return group;
}

function svg(name: string, attributes: Record<string, string | number>): SVGElement {
  const made = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [attribute, value] of Object.entries(attributes)) made.setAttribute(attribute, String(value));
  return made;
}

async function layoutOf(): Promise<Layout> {
  try {
    type WithLayout = Navigator & { keyboard?: { getLayoutMap(): Promise<Layout> } };
    return (await (navigator as WithLayout).keyboard?.getLayoutMap()) ?? new Map();
  } catch {
    return new Map();
  }
}
