// One line at the bottom for what went wrong and what to do.

import { element } from './dom';

const box = element('div', { class: 'message', role: 'alert', hidden: true });
let timer = 0;

/** Says something went wrong; it fades after a while. */
export function say(text: string, seconds = 12): void {
  if (!box.isConnected) document.body.append(box);
  box.textContent = text;
  box.hidden = false;
  clearTimeout(timer);
  timer = window.setTimeout(() => (box.hidden = true), seconds * 1000);
}
