// Pages to read, with a picture of the keys or of the task.

import { button, element } from '../../dom';
import { KeysPicture } from '../keyspicture';
import { prose } from '../prose';
import type { InstructionsStep } from '../steps';
import { forward, handIn, nextFlight, showSheet, type Screen, type Study } from '../study';
import { taskPicture, unassisted } from '../taskpicture';

export const instructions: Screen<'instructions'> = async (root, step, study) => {
  const shownAt = performance.now();
  for (let page = 0; page < step.pages.length;) page += await turn(root, step, page, study);
  await handIn(study, step, {}, shownAt);
};

/** Shows a page; 1 leads to the next, −1 back. */
function turn(root: HTMLElement, step: InstructionsStep, index: number, study: Study): Promise<1 | -1> {
  const { words } = study;
  const { title, text, picture } = step.pages[index]!;
  const drawn = pictureOf(picture, study);
  return new Promise((resolve) => {
    const leave = (by: 1 | -1) => {
      drawn?.dispose();
      resolve(by);
    };
    const isLast = index === step.pages.length - 1;
    const next = forward(isLast ? words.instructions.done : words.next);
    next.addEventListener('click', () => leave(1));
    const back = button(words.back, { class: 'secondary large' }, () => leave(-1));
    const of = words.instructions.pageOf(index + 1, step.pages.length);
    showSheet(
      root,
      'instructions',
      title,
      ...(drawn === null ? [] : [drawn.node]),
      prose(text),
      element(
        'div',
        { class: 'actions' },
        next,
        ...(index === 0 ? [] : [back]),
        ...(step.pages.length === 1 ? [] : [element('span', { class: 'quiet' }, of)]),
      ),
    );
    drawn?.draw();
  });
}

function pictureOf(picture: 'controls' | 'task' | null, study: Study) {
  const flight = nextFlight(study);
  if (picture === null || flight === null) return null;
  if (picture === 'task') return { ...taskPicture(flight.setup, study), dispose: () => {} };
  const { controls } = study.deck.core.begin(unassisted(flight.setup, 1));
  const keys = new KeysPicture(controls, study.keys, study.words);
  return { node: keys.node, draw: () => {}, dispose: () => keys.dispose() };
}
