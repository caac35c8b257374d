// The door: one secret, given when the study was started.

import { button, element } from '../dom';
import { reasonOf, sentence } from '../words';
import * as api from './deskapi';
import type { DeskView } from './place';

export class LoginView implements DeskView {
  readonly main = element('main', { class: 'door' });
  private readonly secret = element('input', {
    type: 'password',
    name: 'secret',
    autocomplete: 'current-password',
    required: true,
    'aria-label': 'Secret of the desk',
  });
  private readonly remark = element('p', { class: 'remark', role: 'alert' });

  constructor(private readonly letIn: () => void) {
    const enter = element('button', { type: 'submit', class: 'primary' }, 'Open the desk');
    const form = element(
      'form',
      { class: 'sheet' },
      element('img', { src: '/favicon.svg', alt: '' }),
      element('h2', {}, 'The researcher’s desk'),
      element(
        'p',
        { class: 'note' },
        'The secret was printed when the study was started, or lies in the file that was named then.',
      ),
      this.secret,
      enter,
      this.remark,
    );
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      void this.enter(enter);
    });
    this.main.append(form);
    queueMicrotask(() => this.secret.focus());
  }

  dispose(): void {}

  private async enter(pressed: HTMLButtonElement): Promise<void> {
    pressed.disabled = true;
    this.remark.textContent = '';
    try {
      await api.login(this.secret.value);
      this.letIn();
    } catch (error) {
      this.remark.textContent = sentence(reasonOf(error));
      this.secret.select();
    } finally {
      pressed.disabled = false;
    }
  }
}

/** A page in the place of a view that cannot be shown. */
export function troubleView(error: unknown): DeskView {
  const again = button('Try again', { class: 'primary' }, () => location.reload());
  const sheet = element(
    'article',
    { class: 'sheet' },
    element('h2', {}, 'The desk could not be opened'),
    element('p', {}, sentence(reasonOf(error))),
    element('div', { class: 'actions' }, again),
  );
  return { main: element('main', { class: 'door' }, sheet), dispose: () => {} };
}
