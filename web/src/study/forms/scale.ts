// A scale with a word at each end. Nothing is chosen beforehand: what is not touched is not answered. Few points are
// buttons in a row, one a point; many are a line that is touched, with a mark for each gradation where they can be told
// apart, as NASA-TLX has them.

import { element } from '../../dom';
import type { ScaleItem } from '../steps';
import type { Asked, Input } from './field';

/** Up to so many points stand side by side. */
const MOST_BUTTONS = 11;
/** Up to so many points have a mark each. */
const MOST_MARKS = 51;
/** Keys that choose on a line; the others leave it as it is. */
const CHOOSES = ['ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown', 'Home', 'End', 'PageUp', 'PageDown', ' ', 'Enter'];

export function scaleInput(item: ScaleItem, asked: Asked): Input {
  return pointsOf(item) <= MOST_BUTTONS ? buttons(item, asked) : line(item, asked);
}

/** How many points a scale has. */
export function pointsOf({ least, most, step }: ScaleItem): number {
  return Math.round((most - least) / step) + 1;
}

/** A number of a scale without the noise of its sum. */
function point(item: ScaleItem, index: number): number {
  return Number((item.least + index * item.step).toFixed(9));
}

function buttons(item: ScaleItem, asked: Asked): Input {
  const values = Array.from({ length: pointsOf(item) }, (_, i) => point(item, i));
  const boxes = values.map((value) => {
    const box = element('input', { type: 'radio', name: `item-${item.id}`, value: String(value) });
    box.checked = asked.draft === value;
    return box;
  });
  const answer = () => {
    const chosen = boxes.find((box) => box.checked);
    return chosen === undefined ? null : Number(chosen.value);
  };
  const hasLabels = item.labels.length === values.length;
  const options = values.map((value, i) => {
    const end = i === 0 ? item.left : i === values.length - 1 ? item.right : '';
    if (!hasLabels) boxes[i]!.setAttribute('aria-label', end === '' ? String(value) : `${value}, ${end}`);
    return element(
      'label',
      { class: 'point' },
      boxes[i]!,
      element('span', {}, hasLabels ? item.labels[i]! : String(value)),
    );
  });
  const row = element(
    'div',
    {
      class: hasLabels ? 'points labelled' : 'points',
      role: 'radiogroup',
      'aria-labelledby': asked.labelledBy,
      'aria-describedby': asked.describedBy,
      'aria-required': String(item.required),
    },
    ...options,
  );
  row.addEventListener('change', () => asked.changed(answer()));
  const node = element('div', { class: 'scale' }, row, ...(hasLabels && item.left === '' ? [] : [ends(item)]));
  return { node, answer, focus: () => (boxes.find((box) => box.checked) ?? boxes[0])?.focus() };
}

function line(item: ScaleItem, asked: Asked): Input {
  const slider = element('input', {
    type: 'range',
    class: 'line',
    min: String(item.least),
    max: String(item.most),
    step: String(item.step),
    'aria-labelledby': asked.labelledBy,
    'aria-describedby': asked.describedBy,
    'aria-required': String(item.required),
  });
  let isSet = typeof asked.draft === 'number';
  slider.value = String(isSet ? asked.draft : (item.least + item.most) / 2);
  const hint = element('span', { class: 'unset-hint', 'aria-hidden': 'true' }, asked.words.form.unsetHint);
  const show = () => {
    slider.classList.toggle('unset', !isSet);
    hint.hidden = isSet;
    slider.setAttribute('aria-valuetext', isSet ? spoken(item, Number(slider.value), asked) : asked.words.form.unset);
  };
  const answer = () => (isSet ? Number(slider.value) : null);
  const touch = () => {
    isSet = true;
    show();
    asked.changed(answer());
  };
  slider.addEventListener('input', touch);
  // A press just where the unset slider stands changes no value, and is an answer all the same.
  slider.addEventListener('pointerup', touch);
  slider.addEventListener('keydown', (event) => {
    if (isSet || !CHOOSES.includes(event.key)) return;
    // The first key sets the middle (or an end), so that nothing is chosen that was not seen.
    if (!['Home', 'End'].includes(event.key)) event.preventDefault();
    touch();
  });
  show();
  const node = element(
    'div',
    { class: 'scale' },
    element('div', { class: 'track' }, marks(item), slider, hint),
    ends(item),
  );
  return { node, answer, focus: () => slider.focus() };
}

/** What those hear who do not see where on the line it stands. */
function spoken(item: ScaleItem, value: number, { words }: Asked): string {
  const label = item.labels[Math.round((value - item.least) / item.step)];
  const end = value === item.least ? item.left : value === item.most ? item.right : '';
  return [words.form.of(String(value), String(item.most)), label ?? end].filter((part) => part !== '').join(', ');
}

function ends(item: ScaleItem): HTMLElement {
  return element(
    'div',
    { class: 'ends', 'aria-hidden': 'true' },
    element('span', {}, item.left),
    element('span', {}, item.right),
  );
}

/** Gradations; the middle one and the ends are longer. */
function marks(item: ScaleItem): HTMLElement {
  const points = pointsOf(item);
  const shown = points <= MOST_MARKS ? points : 3;
  const isLong = (i: number) => i === 0 || i === shown - 1 || 2 * i === shown - 1;
  const ticks = Array.from({ length: shown }, (_, i) => element('i', isLong(i) ? { class: 'long' } : {}));
  return element('div', { class: 'marks', 'aria-hidden': 'true' }, ...ticks);
}
