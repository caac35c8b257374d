// Whether the instructions were understood; the right answers stay on the server.

import { element } from '../../dom';
import { Field } from '../forms/field';
import type { QuizStep } from '../steps';
import { handIn, showSheet, type Screen } from '../study';
import { submitted } from './form';

export const quiz: Screen<'quiz'> = async (root, step, study) => {
  const { words, place } = study;
  const shownAt = performance.now();
  const fields = step.questions.map(
    ({ id, text, choices }) => new Field({ id, kind: 'choice', text, required: true, choices }, words, null, () => {}),
  );
  const summary = element('p', { class: 'summary', role: 'alert' });
  const go = element('button', { type: 'submit', class: 'primary large' }, words.quiz.check);
  const sheet = element(
    'form',
    { novalidate: true },
    ...fields.map((field) => field.node),
    summary,
    element('div', { class: 'actions' }, go),
  );
  showSheet(root, 'quiz', words.quiz.title, element('p', {}, words.quiz.text), sheet);
  for (;;) {
    await submitted(sheet);
    const open = fields.filter((field) => !field.check());
    open[0]?.focus();
    if (open.length > 0) continue;
    const data = Object.fromEntries(fields.map((field) => [field.item.id, field.answer()]));
    go.disabled = true;
    await handIn(study, step, data, shownAt);
    go.disabled = false;
    const [now] = place.session.steps;
    if (now?.id !== step.id || now.kind !== 'quiz') return;
    summary.textContent = words.quiz.wrong(now.attempts);
    showHints(fields, step, place.session.wrong);
  }
};

/** Says of each wrong answer, or of all if nobody says which are, what to look at again. */
function showHints(fields: Field[], step: QuizStep, wrong: string[] | undefined): void {
  const isWrong = (id: string) => wrong === undefined || wrong.includes(id);
  step.questions.forEach(({ id, hint }, i) => fields[i]!.complain(isWrong(id) && hint !== '' ? hint : null));
  fields.find(({ item }) => isWrong(item.id))?.focus();
}
