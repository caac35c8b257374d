// What stands around every screen: which study, how far, how long still, the language, and the way out.

import { button, element } from '../dom';
import { LANGUAGES, type Words } from './text';
import type { Session } from './steps';

export interface FrameEvents {
  withdraw(): Promise<void>;
  choose(language: string): void;
  /** Something was opened that needs the person's attention. */
  opened(): void;
}

/** The header, the place for screens, and what is said over both. */
export class Frame {
  readonly main = element('main', { class: 'study' });
  private readonly title = element('span', { class: 'brand' });
  private readonly badge = element('span', { class: 'badge', hidden: true });
  private readonly bar = element('progress', { max: '1', value: '0' });
  private readonly says = element('span', { class: 'says' });
  private readonly dot = element('span', { class: 'dot', role: 'status', hidden: true });
  private readonly languages = element('label', { class: 'languages', hidden: true });
  private readonly out = button('', { class: 'secondary small withdraw' }, () => this.ask());
  private readonly header: HTMLElement;
  private dialog: HTMLDialogElement | null = null;
  private veil: HTMLElement | null = null;

  constructor(
    private readonly root: HTMLElement,
    private words: Words,
    private readonly events: FrameEvents,
  ) {
    this.header = element(
      'header',
      { class: 'study-header' },
      this.title,
      this.badge,
      element('span', { class: 'progress' }, this.bar, this.says),
      element('span', { class: 'status' }, this.dot, this.languages, this.out),
    );
    root.replaceChildren(this.header, this.main);
    this.out.hidden = true;
  }

  /** Speaks another language from now on. */
  speak(words: Words): void {
    this.words = words;
    document.documentElement.lang = words.code;
  }

  show({ study, participant, status, place, total, minutes_left }: Session): void {
    const { words } = this;
    document.title = study.title;
    this.title.textContent = study.title;
    this.badge.hidden = !participant.test && !participant.simulated;
    this.badge.textContent = participant.simulated ? words.simulated : words.test;
    this.bar.max = Math.max(total, 1);
    this.bar.value = status === 'completed' ? total : place;
    this.bar.setAttribute('aria-label', words.progress);
    const left = minutes_left === null || status === 'completed' ? [] : [words.minutesLeft(minutes_left)];
    this.says.textContent = [words.stepOf(Math.min(place + 1, total), total), ...left].join(' · ');
    this.out.textContent = words.withdraw.open;
    this.out.hidden = !['invited', 'under-way', 'completed'].includes(status);
    this.showLanguages(study.languages, participant.language);
  }

  /** Takes away what only makes sense while the study goes on. */
  end(): void {
    this.out.hidden = true;
    this.dot.classList.add('over');
    this.languages.hidden = true;
    this.says.textContent = '';
    this.bar.hidden = true;
    this.veil?.remove();
    this.dialog?.remove();
  }

  /** While a flight is in the air nobody changes the language. */
  fly(flying: boolean): void {
    this.languages.classList.toggle('off', flying);
    this.languages.querySelector('select')?.toggleAttribute('disabled', flying);
  }

  connected(connected: boolean): void {
    this.dot.hidden = false;
    this.dot.dataset['state'] = connected ? 'on' : 'off';
    this.dot.textContent = connected ? '' : this.words.offline;
    this.dot.title = connected ? this.words.connected : this.words.offlineText;
  }

  /** Says over everything that the server is away, while something waits for it. */
  away(away: boolean, again: () => void): void {
    this.veil?.remove();
    this.veil = null;
    if (!away) return;
    const { title, text, again: label } = this.words.states.away;
    this.veil = element(
      'div',
      { class: 'veil', role: 'alert' },
      element(
        'div',
        { class: 'note-card' },
        element('span', { class: 'spinner', 'aria-hidden': 'true' }),
        element('h2', {}, title),
        element('p', {}, text),
        element('div', { class: 'actions' }, button(label, { class: 'primary' }, again)),
      ),
    );
    this.root.append(this.veil);
  }

  private showLanguages(offered: string[], chosen: string): void {
    const known = offered.filter((code) => code in LANGUAGES);
    this.languages.hidden = known.length < 2;
    const options = known.map((code) =>
      element('option', { value: code, lang: code, selected: code === chosen }, LANGUAGES[code]!.name),
    );
    const list = element('select', { 'aria-label': this.words.language }, ...options);
    list.addEventListener('change', () => this.events.choose(list.value));
    this.languages.replaceChildren(list);
  }

  /** Asks whether to withdraw; the safe answer has the focus. */
  private ask(): void {
    const { withdraw } = this.words;
    this.events.opened();
    this.dialog?.remove();
    const close = () => {
      dialog.close();
      dialog.remove();
      this.main.querySelector<HTMLElement>('.stage')?.focus();
    };
    const stay = button(withdraw.stay, { class: 'primary', autofocus: true }, close);
    const confirm = button(withdraw.confirm, { class: 'danger' }, () => {
      for (const one of [stay, confirm]) one.disabled = true;
      confirm.textContent = withdraw.working;
      void this.events.withdraw().catch(() => {
        // The page says how the session was closed.
      });
    });
    const dialog = element(
      'dialog',
      { class: 'note-card', 'aria-labelledby': 'withdraw-title' },
      element('h2', { id: 'withdraw-title' }, withdraw.title),
      element('p', {}, withdraw.text),
      element('p', { class: 'quiet' }, withdraw.pause),
      element('div', { class: 'actions' }, stay, confirm),
    );
    dialog.addEventListener('cancel', close);
    this.dialog = dialog;
    this.root.append(dialog);
    dialog.showModal();
  }
}

/** A page that has only something to say. */
export function showState(
  root: HTMLElement,
  kind: string,
  { title, text, again }: { title: string; text: string; again?: string },
  press?: () => void,
): void {
  const heading = element('h1', { tabindex: '-1' }, title);
  const actions =
    again === undefined || press === undefined
      ? []
      : [element('div', { class: 'actions' }, button(again, { class: 'primary large' }, press))];
  root.replaceChildren(
    element('article', { class: 'leaf state', 'data-screen': kind }, heading, element('p', {}, text), ...actions),
  );
  heading.focus({ preventScroll: true });
}
