// One line at the bottom for what went wrong and what to do.

import { button, element } from './dom';

const text = element('span', {});
const box = element(
  'div',
  { class: 'message', role: 'alert', hidden: true },
  text,
  button('✕', { 'aria-label': 'Close this message' }, hush),
);
let timer = 0;

/** Says something went wrong; it goes after a while, or when it is closed. */
export function say(words: string, seconds = 14): void {
  if (!box.isConnected) document.body.append(box);
  text.textContent = words;
  box.hidden = false;
  clearTimeout(timer);
  timer = window.setTimeout(hush, seconds * 1000);
}

function hush(): void {
  box.hidden = true;
}
