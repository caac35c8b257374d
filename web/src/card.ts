// The card over the flight: ready, paused, ended, not possible.

import { button, element } from './dom';

/** Something to press on the card. */
export interface CardAction {
  label: string;
  /** The key that does the same, as it is shown. */
  key?: string;
  primary?: boolean;
  press: () => void;
}

/** One card at a time; what it says is also read out. */
export class Card {
  readonly node = element('div', { class: 'card', role: 'status', 'aria-live': 'polite', hidden: true });
  private readonly remark = element('p', { class: 'remark', hidden: true });
  private timer = 0;

  /** Shows a card, perhaps after a moment. `kind` is a word for its looks, such as an ending's. */
  show(kind: string, title: string, content: Node[], actions: CardAction[], afterMs = 0): void {
    this.hide();
    const buttons = actions.map(({ label, key, primary, press }) => {
      const made = button(label, { class: primary === true ? 'primary' : 'secondary' }, press);
      if (key !== undefined) made.append(' ', element('kbd', {}, key));
      return made;
    });
    this.remark.hidden = true;
    const fill = () => {
      this.node.dataset['kind'] = kind;
      this.node.replaceChildren(element('h2', {}, title), ...content, this.remark, element('div', { class: 'actions' }, ...buttons));
      this.node.hidden = false;
    };
    if (afterMs === 0) fill();
    else this.timer = window.setTimeout(fill, afterMs);
  }

  /** Adds a line to the card that is shown. */
  note(text: string): void {
    this.remark.textContent = text;
    this.remark.hidden = false;
  }

  hide(): void {
    clearTimeout(this.timer);
    this.node.hidden = true;
  }
}
