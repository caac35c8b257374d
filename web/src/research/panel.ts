// One of the pictures of a replay: its stage, its title, and the strip of what happened on it.

import { element } from '../dom';
import type { Recording } from '../replay';
import { Stage } from '../stage';
import { MEANINGFUL_S, type Branch } from './branching';

/** What the picture says to somebody who looks on. */
export const AT_THE_DESK = { away: 'away', own: 'THEIR GOAL' };

/** A stage with its title, and the strip of what happened on it. */
export class Panel {
  readonly strip = element('canvas', { class: 'strip', 'aria-hidden': 'true' });
  readonly stage: Stage;
  readonly node: HTMLElement;
  private readonly title = element('div', { class: 'title' });
  private readonly head = element('b', {});
  private readonly words = element('div', { class: 'words' });
  private readonly links = element('div', { class: 'links' });
  private readonly now = element('div', { class: 'moment' });

  constructor(readonly what: string) {
    const canvas = element('canvas', { class: 'front', role: 'img', 'aria-label': `The flight, ${what}` });
    const back = element('canvas', { class: 'back', 'aria-hidden': 'true' });
    this.stage = new Stage(back, canvas, AT_THE_DESK);
    this.title.append(this.head, this.words, this.links);
    this.node = element('div', { class: 'stage', 'data-what': what }, back, canvas, this.title, this.now);
  }

  begin(recording: Recording): void {
    const { opening } = recording;
    this.stage.show(opening.scene, opening.pilot_goal, opening.setup.seed, opening.ticks_per_second);
  }

  name(words: string, to: string | null): void {
    this.head.replaceChildren(to === null ? words : element('a', { href: to }, words));
  }

  lead(...links: HTMLElement[]): void {
    this.links.replaceChildren(...links);
  }

  say(...words: HTMLElement[]): void {
    this.words.replaceChildren(...words);
  }

  moment({ words, state }: { words: string; state: string }): void {
    this.now.textContent = words;
    this.now.dataset['state'] = state;
  }
}

/** Marks on a strip where the branch begins, and dims what means little. */
export function markBranch(canvas: HTMLCanvasElement, branch: Branch, length: number): void {
  const pen = canvas.getContext('2d');
  if (pen === null) return;
  const { clientWidth: width, clientHeight: height } = canvas;
  const x = (tick: number) => (tick / Math.max(length, 1)) * width;
  const { wish, opening } = branch;
  const until = wish.at + MEANINGFUL_S * opening.ticks_per_second * opening.setup.time_scale;
  pen.fillStyle = 'rgba(11, 17, 34, 0.6)';
  pen.fillRect(0, 0, x(wish.at), height);
  if (wish.pilot.pilot === 'recorded') {
    pen.strokeStyle = 'rgba(160, 176, 210, 0.5)';
    pen.lineWidth = 1;
    pen.beginPath();
    for (let at = x(until) - height; at < width; at += 7) {
      pen.moveTo(Math.max(at, x(until)), at < x(until) ? height - (x(until) - at) : height);
      pen.lineTo(at + height, 0);
    }
    pen.stroke();
  }
  pen.fillStyle = '#ffb000';
  pen.fillRect(x(wish.at) - 1, 0, 2, height);
}
