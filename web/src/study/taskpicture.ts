// A picture of the task: the plant's scene before its first tick, with words for what one sees.

import type { Setup } from '../core';
import { element } from '../dom';
import { Stage } from '../stage';
import type { Study } from './study';

/** Any terrain does; everybody sees the same one. */
const SEED = 11;

/** The picture; `drawn` is to be called once it is in the page. */
export function taskPicture(setup: Setup, study: Study): { node: HTMLElement; draw(): void } {
  const { words, deck } = study;
  const front = element('canvas', { class: 'front', role: 'img', 'aria-label': words.instructions.taskLabel });
  const back = element('canvas', { class: 'back', 'aria-hidden': 'true' });
  const key = (kind: string, text: string) => element('span', { 'data-key': kind }, text);
  const legend = element(
    'figcaption',
    {},
    key('craft', words.instructions.craft),
    key('goal', words.instructions.goal),
    key('others', words.instructions.others),
  );
  const node = element('figure', { class: 'task-picture' }, element('div', { class: 'stage' }, back, front), legend);
  const draw = () => {
    const stage = new Stage(back, front, words.flight);
    const opening = deck.core.begin(unassisted(setup, SEED));
    stage.show(opening.scene, opening.pilot_goal, SEED, opening.ticks_per_second);
    const paint = () => {
      if (!node.isConnected) return;
      stage.draw(opening.poses, opening.poses, 0, performance.now(), false);
      requestAnimationFrame(paint);
    };
    paint();
  };
  return { node, draw };
}

/** The same task without a co-pilot and without models: for looking at it, and for trying the device. */
export function unassisted(setup: Setup, seed: number): Setup {
  return { ...setup, seed, rule: { rule: 'hic' }, inference: 'nearest', values: null, intent: null };
}
