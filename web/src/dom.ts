// Elements in one line each.

/** An element with attributes and children. */
export function element<Name extends keyof HTMLElementTagNameMap>(
  name: Name,
  attributes: Record<string, string | boolean>,
  ...children: (Node | string)[]
): HTMLElementTagNameMap[Name] {
  const made = document.createElement(name);
  for (const [attribute, value] of Object.entries(attributes)) {
    if (value === true) made.setAttribute(attribute, '');
    else if (value !== false) made.setAttribute(attribute, value);
  }
  made.append(...children);
  return made;
}

/** A button that does something. */
export function button(
  label: string,
  attributes: Record<string, string | boolean>,
  press: () => void,
): HTMLButtonElement {
  const made = element('button', { type: 'button', ...attributes }, label);
  made.addEventListener('click', press);
  return made;
}

/** A list to choose from, with its label. A choice with a reason why not is shown and cannot be chosen. */
export function select(
  label: string,
  choices: [value: string, text: string, whyNot?: string | null][],
  chosen: string,
  choose: (value: string) => void,
): HTMLLabelElement {
  const options = choices.map(([value, text, whyNot]) =>
    element(
      'option',
      { value, selected: value === chosen, disabled: whyNot != null },
      whyNot == null ? text : `${text} (${whyNot})`,
    ),
  );
  const box = element('select', { disabled: choices.length < 2, 'data-name': label }, ...options);
  box.addEventListener('change', () => choose(box.value));
  return element('label', {}, label, box);
}

/** Whether a key is one of the two that confirm. */
export function isEnter({ code }: KeyboardEvent): boolean {
  return code === 'Enter' || code === 'NumpadEnter';
}

/** Whether what has the focus uses this key itself: fields all keys, lists all but Enter, buttons and links what presses them. */
export function isTheirs(event: KeyboardEvent): boolean {
  const at = event.target as Element | null;
  const within = (selector: string) => at?.closest?.(selector) != null;
  if (within('input, textarea') || (within('select') && !isEnter(event))) return true;
  return within('button, a, summary') && (event.code === 'Space' || isEnter(event));
}

/** Whether the person asked their system for less motion. */
export function wantsCalm(): boolean {
  return matchMedia('(prefers-reduced-motion: reduce)').matches;
}
