// Numbers and free text.

import { element } from '../../dom';
import type { NumberItem, TextItem } from '../steps';
import type { Asked, Input } from './field';

export function numberInput(item: NumberItem, asked: Asked): Input {
  const box = element('input', {
    type: 'text',
    inputmode: 'decimal',
    autocomplete: 'off',
    size: '8',
    'aria-labelledby': asked.labelledBy,
    'aria-describedby': asked.describedBy,
    'aria-required': String(item.required),
  });
  if (asked.draft !== null) box.value = String(asked.draft);
  // A comma is the decimal sign of many; what is no number at all is kept as NaN, so that it is complained about.
  const answer = () => (box.value.trim() === '' ? null : Number(box.value.trim().replace(',', '.')));
  box.addEventListener('input', () => asked.changed(answer()));
  const unit = item.unit === null ? [] : [element('span', { class: 'unit' }, item.unit)];
  return { node: element('div', { class: 'entry' }, box, ...unit), answer, focus: () => box.focus() };
}

/** More characters than this want more than a line. */
const LINE_CHARS = 80;

export function textInput(item: TextItem, asked: Asked): Input {
  const attributes = {
    maxlength: String(item.most_chars),
    autocomplete: 'off',
    'aria-labelledby': asked.labelledBy,
    'aria-describedby': asked.describedBy,
    'aria-required': String(item.required),
  };
  const box =
    item.most_chars > LINE_CHARS
      ? element('textarea', { rows: '4', ...attributes })
      : element('input', { type: 'text', ...attributes });
  if (typeof asked.draft === 'string') box.value = asked.draft;
  const left = element('span', { class: 'left', 'aria-hidden': 'true' });
  const answer = () => (box.value.trim() === '' ? null : box.value);
  const count = () => {
    const chars = item.most_chars - [...box.value].length;
    left.textContent = chars <= 0.2 * item.most_chars ? asked.words.form.charsLeft(chars) : '';
  };
  box.addEventListener('input', () => {
    count();
    asked.changed(answer());
  });
  count();
  return { node: element('div', { class: 'entry' }, box, left), answer, focus: () => box.focus() };
}
