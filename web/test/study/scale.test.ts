// @vitest-environment jsdom
// Questions of a form: nothing is answered that was not touched.

import { describe, expect, it } from 'vitest';
import { Field } from '../../src/study/forms/field';
import type { Answer, Item, ScaleItem } from '../../src/study/steps';
import { en } from '../../src/study/text/en';

const SCALE: ScaleItem = {
  id: 'mental',
  kind: 'scale',
  text: 'How mentally demanding was the task?',
  required: true,
  least: 0,
  most: 100,
  step: 5,
  left: 'Very low',
  right: 'Very high',
  labels: [],
};

function ask(item: Item, draft: Answer = null) {
  const heard: Answer[] = [];
  const field = new Field(item, en, draft, (answer) => heard.push(answer));
  document.body.replaceChildren(field.node);
  const find = <Found extends HTMLElement>(selector: string) => field.node.querySelector<Found>(selector)!;
  const strike = (key: string) => {
    const event = new KeyboardEvent('keydown', { key, cancelable: true });
    find('input').dispatchEvent(event);
    return event;
  };
  return { field, heard, find, strike };
}

describe('a scale with many points', () => {
  it('has the twenty-one gradations of NASA-TLX, the ends and the middle longer', () => {
    const { field } = ask(SCALE);
    expect(field.node.querySelectorAll('.marks i').length).toBe(21);
    expect(field.node.querySelectorAll('.marks i.long').length).toBe(3);
  });

  it('starts unset and says so', () => {
    const { field, find } = ask(SCALE);
    expect(field.answer()).toBeNull();
    expect(find('input').getAttribute('aria-valuetext')).toBe('not answered yet');
    expect(field.check()).toBe(false);
    expect(find('.complaint').textContent).toBe('Please answer this question.');
  });

  it('is answered by a press just where the unset slider stands', () => {
    const { field, find, heard } = ask(SCALE);
    find('input').dispatchEvent(new Event('pointerup'));
    expect(field.answer()).toBe(50);
    expect(heard).toEqual([50]);
    expect(field.check()).toBe(true);
  });

  it('is answered by the keyboard: the first key sets the middle, and moves nothing that was not seen', () => {
    const { field, strike } = ask(SCALE);
    expect(strike('Tab').defaultPrevented).toBe(false);
    expect(field.answer()).toBeNull();
    expect(strike('ArrowRight').defaultPrevented).toBe(true);
    expect(field.answer()).toBe(50);
    expect(strike('ArrowRight').defaultPrevented).toBe(false);
  });

  it('is labelled by its question, and speaks its value with the word at an end', () => {
    const { field, find } = ask(SCALE);
    const slider = find<HTMLInputElement>('input');
    expect(document.getElementById(slider.getAttribute('aria-labelledby')!)!.textContent).toBe(SCALE.text);
    slider.value = '100';
    slider.dispatchEvent(new Event('input'));
    expect(field.answer()).toBe(100);
    expect(slider.getAttribute('aria-valuetext')).toBe('100 of 100, Very high');
  });

  it('stands where the draft left it', () => {
    expect(ask(SCALE, 35).field.answer()).toBe(35);
  });

  it('has no marks that could not be told apart', () => {
    expect(ask({ ...SCALE, step: 1 }).field.node.querySelectorAll('.marks i').length).toBe(3);
  });
});

describe('a scale with few points', () => {
  const ELEVEN = { ...SCALE, most: 10, step: 1 };

  it('is a row of buttons, none of them chosen', () => {
    const { field, find } = ask(ELEVEN);
    expect(field.node.querySelectorAll('input[type=radio]').length).toBe(11);
    expect(field.answer()).toBeNull();
    const last = field.node.querySelectorAll<HTMLInputElement>('input')[10]!;
    expect(last.getAttribute('aria-label')).toBe('10, Very high');
    last.click();
    expect(field.answer()).toBe(10);
    expect(find('.complaint').hidden).toBe(true);
  });

  it('has the words of its points, where it has some', () => {
    const labels = ['no', 'hardly', 'yes'];
    const { field } = ask({ ...SCALE, least: 1, most: 3, step: 1, labels });
    expect([...field.node.querySelectorAll('.point')].map((point) => point.textContent)).toEqual(labels);
  });
});

describe('other questions', () => {
  it('take a number with a comma, and refuse what is none or out of range', () => {
    const { field, find } = ask({
      id: 'age',
      kind: 'number',
      text: 'Age?',
      required: true,
      least: 18,
      most: 99,
      unit: 'years',
    });
    const type = (text: string) => {
      find<HTMLInputElement>('input').value = text;
      return field.check();
    };
    expect([type(''), type('abc'), type('17'), type('18,5'), type('99')]).toEqual([false, false, false, true, true]);
    type('abc');
    expect(find('.complaint').textContent).toBe('A number from 18 to 99.');
  });

  it('may be left open where that is allowed', () => {
    const { field } = ask({ id: 'note', kind: 'text', text: 'Anything else?', required: false, most_chars: 200 });
    expect(field.check()).toBe(true);
    expect(field.answer()).toBeNull();
  });

  it('give all that were ticked, or nothing', () => {
    const choices = ['drone', 'plane'].map((value) => ({ value, text: value }));
    const { field } = ask({ id: 'flown', kind: 'many', text: 'Flown?', required: false, choices });
    expect(field.answer()).toBeNull();
    field.node.querySelectorAll<HTMLInputElement>('input').forEach((box) => box.click());
    expect(field.answer()).toEqual(['drone', 'plane']);
  });
});
