// Consent: what the study is, how long it takes, and that one may leave.

import { button, element } from '../../dom';
import { prose } from '../prose';
import { forward, handIn, pressed, showSheet, type Screen } from '../study';

export const consent: Screen<'consent'> = async (root, step, study) => {
  const { words } = study;
  const shownAt = performance.now();
  const box = element('input', { type: 'checkbox', id: 'agree' });
  const start = forward(words.consent.start, { disabled: true });
  box.addEventListener('change', () => (start.disabled = !box.checked));
  const minutes = step.minutes === null ? [] : [words.consent.minutes(step.minutes)];
  const declined = new Promise<boolean>((resolve) => {
    const decline = button(words.consent.decline, { class: 'secondary large' }, () => resolve(false));
    showSheet(
      root,
      'consent',
      words.consent.title,
      element('p', { class: 'facts' }, [...minutes, words.consent.version(step.version)].join(' ')),
      prose(step.text),
      element('p', { class: 'quiet' }, words.consent.leave),
      element('p', { class: 'quiet' }, words.askUs(step.contact)),
      element('label', { class: 'option agree' }, box, element('span', {}, words.consent.agree)),
      element('div', { class: 'actions' }, start, decline),
    );
  });
  const agreed = await Promise.race([pressed(start).then(() => true), declined]);
  await handIn(study, step, { agreed }, shownAt);
};
