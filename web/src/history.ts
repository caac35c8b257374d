// What happened at each tick, as strips show it: how sure the co-pilot was, and whether it changed anything.

import type { Tick } from './core';

/** What became of what was asked. */
export type Outcome = 'none' | 'asked' | 'corrected' | 'opposed';

/** Colours of strips; taller bars say the same by their height. */
const COLOURS: Record<Outcome, string> = {
  none: 'transparent',
  asked: '#56b4e9',
  corrected: '#ffb000',
  opposed: '#ff6a4d',
};
const HEIGHTS: Record<Outcome, number> = { none: 0, asked: 0.34, corrected: 0.67, opposed: 1 };

export function outcomeOf(tick: Pick<Tick, 'intervention'> | null): Outcome {
  const seen = tick?.intervention ?? null;
  if (seen === null) return 'none';
  return seen.opposed ? 'opposed' : seen.effective ? 'corrected' : 'asked';
}

/** Grows by one entry a tick. */
export class History {
  readonly outcomes: Outcome[] = [];
  readonly confidences: number[] = [];

  push(tick: Tick): void {
    this.outcomes.push(outcomeOf(tick));
    this.confidences.push(tick.belief.confidence);
  }
}

/** Draws the entries `from` to `to` of a history over the whole width of a canvas; the line is c, from 0 to 1. */
export function drawStrip(canvas: HTMLCanvasElement, history: History, from: number, to: number, upTo = to): void {
  const ratio = devicePixelRatio || 1;
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  const pen = canvas.getContext('2d');
  if (width === 0 || pen === null) return;
  const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  const x = (tick: number) => ((tick - from) / Math.max(to - from, 1)) * width;
  const lane = Math.min(0.3 * height, 14);
  const last = Math.min(to, upTo, history.outcomes.length);
  for (let tick = Math.max(from, 0); tick < last; tick += 1) {
    const outcome = history.outcomes[tick] ?? 'none';
    pen.fillStyle = COLOURS[outcome];
    const tall = lane * HEIGHTS[outcome];
    pen.fillRect(x(tick), height - tall, x(tick + 1) - x(tick) + 0.4, tall);
  }
  pen.strokeStyle = '#dfe8ff';
  pen.lineWidth = 1.5;
  pen.beginPath();
  for (let tick = Math.max(from, 0); tick < last; tick += 1) {
    pen.lineTo(x(tick), 2 + (height - lane - 5) * (1 - (history.confidences[tick] ?? 0)));
  }
  pen.stroke();
}
