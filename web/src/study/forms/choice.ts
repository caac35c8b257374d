// One of several, or any of several.

import { element } from '../../dom';
import type { ChoiceItem, ManyItem } from '../steps';
import type { Asked, Input } from './field';

export function choiceInput(item: ChoiceItem | ManyItem, asked: Asked): Input {
  const isMany = item.kind === 'many';
  const drafted = Array.isArray(asked.draft) ? asked.draft : [asked.draft];
  const boxes = item.choices.map(({ value }) => {
    const box = element('input', { type: isMany ? 'checkbox' : 'radio', name: `item-${item.id}`, value });
    box.checked = drafted.includes(value);
    return box;
  });
  const chosen = () => boxes.filter((box) => box.checked).map((box) => box.value);
  const answer = () => (isMany ? (chosen().length > 0 ? chosen() : null) : (chosen()[0] ?? null));
  const options = item.choices.map(({ text }, i) =>
    element('label', { class: 'option' }, boxes[i]!, element('span', {}, text)),
  );
  const node = element(
    'div',
    {
      class: 'choices-list',
      role: isMany ? 'group' : 'radiogroup',
      'aria-labelledby': asked.labelledBy,
      'aria-describedby': asked.describedBy,
      ...(isMany ? {} : { 'aria-required': String(item.required) }),
    },
    ...options,
  );
  node.addEventListener('change', () => asked.changed(answer()));
  return { node, answer, focus: () => boxes[0]?.focus() };
}
