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

/** Where a card is: in the middle, or beside what is to be seen. */
export type Side = 'middle' | 'left' | 'right';

/** The side of a picture that leaves a place in it free; shares of its width and height, from the left and from the top. */
export function sideFor(place: readonly [number, number] | null): Side {
  // Low down the card in the middle, which is at the top, is in nobody's way.
  if (place === null || place[1] > 0.6) return 'middle';
  return place[0] < 0.5 ? 'right' : 'left';
}

/** One card at a time. */
export class Card {
  readonly node = element('div', { class: 'card', hidden: true });
  /** Says to those who hear the page what the card says to those who see it. It never goes: what comes anew is not read. */
  readonly voice = element('p', { class: 'voice', role: 'status' });
  private readonly remark = element('p', { class: 'remark', hidden: true });
  private timer = 0;
  private side: Side = 'middle';

  /** The next card stands there. */
  stand(side: Side): void {
    this.side = side;
  }

  /** Shows a card, perhaps after a moment. `kind` is a word for its looks, such as an ending's. */
  show(kind: string, title: string, content: Node[], actions: CardAction[], afterMs = 0): void {
    this.hide();
    const buttons = actions.map(({ label, key, primary, press }) => {
      const made = button(label, { class: primary === true ? 'primary' : 'secondary' }, press);
      if (key !== undefined) made.append(' ', element('kbd', {}, key));
      return made;
    });
    this.remark.hidden = true;
    const { side } = this;
    this.side = 'middle';
    const fill = () => {
      this.node.dataset['kind'] = kind;
      this.node.dataset['side'] = side;
      this.node.replaceChildren(
        element('h2', {}, title),
        ...content,
        this.remark,
        element('div', { class: 'actions' }, ...buttons),
      );
      this.node.hidden = false;
      this.voice.textContent = [`${title}.`, ...content.map(spoken)].join(' ');
    };
    if (afterMs === 0) fill();
    else this.timer = window.setTimeout(fill, afterMs);
  }

  /** Adds a line to the card that is shown. */
  note(text: string): void {
    this.remark.textContent = text;
    this.remark.hidden = false;
    this.voice.textContent = text;
  }

  /** Presses the first button of the card that is shown; false if there is none. */
  pressPrimary(): boolean {
    const primary = this.node.hidden ? null : this.node.querySelector<HTMLButtonElement>('button.primary');
    primary?.click();
    return primary !== null;
  }

  /** Shows again what was hidden last. */
  reshow(): void {
    this.node.hidden = false;
  }

  hide(): void {
    clearTimeout(this.timer);
    this.node.hidden = true;
  }
}

/** What a part of a card says: the labels in it, if there are any, otherwise its text. */
function spoken(part: Node): string {
  const labelled = part instanceof Element ? [...part.querySelectorAll('[aria-label]')] : [];
  const labels = labelled.map((node) => node.getAttribute('aria-label'));
  return labels.length > 0 ? `${labels.join(', ')}.` : (part.textContent ?? '');
}
