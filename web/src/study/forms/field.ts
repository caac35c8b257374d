// One question of a form: its text, its way of answering, and what is wrong with the answer.

import { element } from '../../dom';
import type { Answer, Item } from '../steps';
import type { Words } from '../text';
import { choiceInput } from './choice';
import { numberInput, textInput } from './entry';
import { scaleInput } from './scale';

/** A way of answering. */
export interface Input {
  node: HTMLElement;
  /** What is answered now; null if nothing. */
  answer(): Answer;
  /** Puts the keyboard there. */
  focus(): void;
}

/** What an input needs. */
export interface Asked {
  words: Words;
  /** What was answered before, or null. */
  draft: Answer;
  /** Id of the element with the question's text, which labels the input. */
  labelledBy: string;
  /** Id of the element that says what is wrong. */
  describedBy: string;
  changed(answer: Answer): void;
}

/** A question on the page. */
export class Field {
  readonly node: HTMLElement;
  private readonly input: Input;
  private readonly complaint = element('p', { class: 'complaint', hidden: true, role: 'alert' });

  constructor(
    readonly item: Item,
    private readonly words: Words,
    draft: Answer,
    changed: (answer: Answer) => void,
  ) {
    const [question, complaint] = [`question-${item.id}`, `complaint-${item.id}`];
    this.complaint.id = complaint;
    this.input = inputOf(item, {
      words,
      draft,
      labelledBy: question,
      describedBy: complaint,
      changed: (answer) => {
        if (answer !== null) this.complain(null);
        changed(answer);
      },
    });
    const optional = item.required ? [] : [' ', element('span', { class: 'optional' }, words.form.optional)];
    this.node = element(
      'div',
      { class: 'field', 'data-item': item.id, 'data-kind': item.kind },
      element('p', { class: 'question', id: question }, item.text, ...optional),
      this.input.node,
      this.complaint,
    );
  }

  answer(): Answer {
    return this.input.answer();
  }

  get isAnswered(): boolean {
    const answer = this.answer();
    return answer !== null && !(Array.isArray(answer) && answer.length === 0);
  }

  /** Says what is wrong; null: nothing. */
  complain(text: string | null): void {
    this.complaint.textContent = text ?? '';
    this.complaint.hidden = text === null;
    this.node.classList.toggle('wrong', text !== null);
  }

  focus(): void {
    this.node.scrollIntoView?.({ block: 'center' });
    this.input.focus();
  }

  /** Complains, if the answer is missing or cannot be right; true if it may be handed in. */
  check(): boolean {
    const problem = this.problem();
    this.complain(problem);
    return problem === null;
  }

  private problem(): string | null {
    const { item, words } = this;
    if (!this.isAnswered) return item.required ? words.form.required : null;
    const answer = this.answer();
    if (item.kind !== 'number') return null;
    const isRight =
      typeof answer === 'number' &&
      Number.isFinite(answer) &&
      answer >= (item.least ?? -Infinity) &&
      answer <= (item.most ?? Infinity);
    return isRight ? null : words.form.between(item.least, item.most);
  }
}

function inputOf(item: Item, asked: Asked): Input {
  switch (item.kind) {
    case 'scale':
      return scaleInput(item, asked);
    case 'choice':
    case 'many':
      return choiceInput(item, asked);
    case 'number':
      return numberInput(item, asked);
    case 'text':
      return textInput(item, asked);
  }
}
