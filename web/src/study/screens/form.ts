// Forms and questionnaires: items one below the other, handed in together.

import { element } from '../../dom';
import { Draft } from '../drafts';
import { Field } from '../forms/field';
import { prose } from '../prose';
import type { FormStep, Problem, QuestionnaireStep } from '../steps';
import { handIn, showSheet, type Study } from '../study';

/** Shows a form or a questionnaire until the server took it. */
export async function form(root: HTMLElement, step: FormStep | QuestionnaireStep, study: Study): Promise<void> {
  const { words, place } = study;
  const shownAt = performance.now();
  const draft = new Draft(place.session.participant.code, step.id);
  const fields = step.items.map(
    (item) => new Field(item, words, draft.of(item.id), (answer) => draft.set(item.id, answer)),
  );
  const summary = element('p', { class: 'summary', role: 'status', 'aria-live': 'polite' });
  const go = element('button', { type: 'submit', class: 'primary large' }, words.goOn);
  const sheet = element(
    'form',
    { novalidate: true },
    ...fields.map((field) => field.node),
    summary,
    element('div', { class: 'actions' }, go),
  );
  const intro = step.kind === 'questionnaire' && step.intro !== '' ? [prose(step.intro)] : [];
  showSheet(root, step.kind, step.title, ...intro, sheet);
  let mayLeaveOpen = false;
  for (;;) {
    await submitted(sheet);
    if (!complete(fields, words, summary)) continue;
    const open = fields.filter((field) => !field.isAnswered);
    if (open.length > 0 && !mayLeaveOpen) {
      mayLeaveOpen = true;
      summary.textContent = words.form.open(open.length);
      continue;
    }
    const data = Object.fromEntries(fields.map((field) => [field.item.id, field.answer()]));
    go.disabled = true;
    const taken = await handIn(study, step, data, shownAt);
    go.disabled = false;
    if (taken.taken) {
      draft.clear();
      return;
    }
    refuse(fields, taken.problems, study);
    summary.textContent = taken.error;
  }
}

/** Whether nothing is wrong or missing; otherwise says what, and goes to the first. */
function complete(fields: Field[], words: Study['words'], summary: HTMLElement): boolean {
  const wrong = fields.filter((field) => !field.check());
  summary.textContent = wrong.length === 0 ? '' : words.form.missing(wrong.length);
  wrong[0]?.focus();
  return wrong.length === 0;
}

function refuse(fields: Field[], problems: Record<string, Problem>, { words }: Study): void {
  const wrong = fields.filter((field) => field.item.id in problems);
  wrong.forEach((field) => field.complain(words.form.problems[problems[field.item.id]!] ?? words.form.required));
  wrong[0]?.focus();
}

export function submitted(sheet: HTMLFormElement): Promise<void> {
  return new Promise((resolve) => {
    const submit = (event: Event) => {
      event.preventDefault();
      resolve();
    };
    sheet.addEventListener('submit', submit, { once: true });
  });
}
