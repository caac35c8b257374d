// Screens that are read: a block that begins, a break, the last words, the thanks.

import { button, element } from '../../dom';
import { prose } from '../prose';
import { forward, handIn, pressed, showSheet, type Screen } from '../study';

/** How long before a participant is taken back to the panel, s. */
const BACK_S = 20;

export const block: Screen<'block'> = async (root, step, study) => {
  const { words } = study;
  const shownAt = performance.now();
  const go = forward(words.goOn);
  const counts = [
    ...(step.practice > 0 ? [words.block.practice(step.practice)] : []),
    ...(step.measured > 0 ? [words.block.measured(step.measured)] : []),
  ];
  showSheet(
    root,
    'block',
    step.label,
    element('ul', { class: 'counts' }, ...counts.map((text) => element('li', {}, text))),
    prose(step.text),
    element('p', { class: 'quiet' }, words.block.pause),
    element('div', { class: 'actions' }, go),
  );
  await pressed(go);
  await handIn(study, step, {}, shownAt);
};

export const pause: Screen<'break'> = async (root, step, study) => {
  const { words } = study;
  const shownAt = performance.now();
  const go = forward(words.break.go);
  const says = element('p', { class: 'clock', role: 'timer' });
  showSheet(root, 'break', words.break.title, prose(step.text), says, element('div', { class: 'actions' }, go));
  const tick = () => {
    const passed = (performance.now() - shownAt) / 1000;
    const wait = Math.max(Math.ceil(step.at_least_s - passed), 0);
    const isLate = step.at_most_s !== null && passed > step.at_most_s;
    go.disabled = wait > 0;
    says.textContent = wait > 0 ? words.break.wait(wait) : isLate ? words.break.late : words.break.free;
    says.classList.toggle('late', isLate);
  };
  tick();
  const timer = setInterval(tick, 250);
  await pressed(go);
  clearInterval(timer);
  await handIn(study, step, {}, shownAt);
};

export const debrief: Screen<'debrief'> = async (root, step, study) => {
  const { words } = study;
  const shownAt = performance.now();
  const go = forward(words.goOn);
  showSheet(
    root,
    'debrief',
    words.debrief.title,
    prose(step.text),
    element('p', { class: 'quiet' }, words.askUs(step.contact)),
    element('div', { class: 'actions' }, go),
  );
  await pressed(go);
  await handIn(study, step, {}, shownAt);
};

/** The participant stays here. */
export const thanks: Screen<'thanks'> = (root, step, { words }) => {
  const content: Node[] = [prose(step.text)];
  if (step.code !== null && step.code !== '') content.push(codeOf(step.code, words));
  if (step.return_address === null) content.push(element('p', { class: 'quiet' }, words.thanks.close));
  else content.push(wayBack(step.return_address, step.button, words));
  content.push(element('p', { class: 'quiet' }, words.askUs(step.contact)));
  showSheet(root, 'thanks', words.thanks.title, ...content);
  return new Promise(() => {});
};

type Words = Parameters<Screen<'thanks'>>[2]['words'];

function codeOf(code: string, words: Words): HTMLElement {
  const copy = button(words.thanks.copy, { class: 'secondary' }, () => {
    void navigator.clipboard?.writeText(code).then(() => (copy.textContent = words.thanks.copied));
  });
  return element('div', { class: 'code' }, element('span', {}, words.thanks.code), element('output', {}, code), copy);
}

/** The button back to the panel, which presses itself after a while. */
function wayBack(address: string, label: string, words: Words): HTMLElement {
  let left = BACK_S;
  const link = element('a', { class: 'primary large', href: address }, label);
  const says = element('span', { class: 'quiet', role: 'timer' }, words.thanks.back(left));
  const stay = button(words.thanks.stay, { class: 'secondary large' }, () => {
    clearInterval(timer);
    says.remove();
    stay.remove();
  });
  const timer = setInterval(() => {
    left -= 1;
    says.textContent = words.thanks.back(left);
    if (left > 0) return;
    clearInterval(timer);
    location.assign(address);
  }, 1000);
  return element('div', { class: 'actions' }, link, stay, says);
}
