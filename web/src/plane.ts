// The candidates of a decision on axes, in the plane of the first two: where they lie, which are allowed, what is done.

import type { Named, Tick } from './core';

/** More candidates than this are drawn as points instead of rows of bars. */
export const MOST_ROWS = 16;

/** A point of the picture: its place, from −1 to 1 on both axes, and what is drawn there. */
export interface Spot {
  x: number;
  y: number;
  /** Its value, from 0 (the worst) to 1 (the best). */
  worth: number;
  allowed: boolean;
}

/** What the picture shows. */
export interface Plane {
  names: string[];
  spots: Spot[];
  asked: [number, number] | null;
  executed: [number, number] | null;
}

/** The picture of a tick; null where actions have no axes. */
export function planeOf(tick: Tick): Plane | null {
  const candidates = tick.candidates.filter(({ action }) => action.axes !== undefined);
  if (candidates.length <= MOST_ROWS) return null;
  const names = candidates[0]!.action.label.split(', ').map((part) => part.slice(0, part.lastIndexOf(' ')));
  const along = (axis: number) => candidates.map(({ action }) => action.axes![axis]!);
  const scale = [0, 1].map((axis) => {
    const [low, high] = [Math.min(...along(axis)), Math.max(...along(axis))];
    return (value: number) => (high > low ? (2 * (value - low)) / (high - low) - 1 : 0);
  });
  const place = ({ axes }: Named): [number, number] => [scale[0]!(axes![0]), scale[1]!(axes![1])];
  const most = Math.max(...candidates.map((candidate) => candidate.above_worst), 1e-9);
  const spots = candidates.map(({ action, above_worst, allowed }) => {
    const [x, y] = place(action);
    return { x, y, worth: above_worst / most, allowed };
  });
  const of = (action: Named | null) => (action?.axes === undefined ? null : place(action));
  return { names: names.slice(0, 2), spots, asked: of(tick.asked), executed: of(tick.executed) };
}

/** The value of an action among the candidates, above that of the worst; null if it is none of them. */
export function worthOf(tick: Tick, action: Named | null): number | null {
  const same = (other: Named) => other.axes?.every((value, axis) => value === action?.axes?.[axis]);
  return tick.candidates.find((candidate) => same(candidate.action))?.above_worst ?? null;
}

/** Draws the picture: a point a candidate, larger the more it is worth; a ring where the pilot asks, a cross at what is done. */
export function drawPlane(canvas: HTMLCanvasElement, plane: Plane): void {
  const context = canvas.getContext('2d');
  const { clientWidth: width, clientHeight: height } = canvas;
  if (context === null || width === 0) return;
  const ratio = window.devicePixelRatio;
  if (canvas.width !== Math.round(width * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const style = getComputedStyle(canvas);
  const colour = (name: string, otherwise: string) => style.getPropertyValue(name).trim() || otherwise;
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  const at = ([x, y]: [number, number]): [number, number] => [
    ((x + 1) / 2) * (width - 24) + 12,
    ((1 - y) / 2) * (height - 24) + 12,
  ];
  for (const { x, y, worth, allowed } of plane.spots) {
    context.globalAlpha = allowed ? 0.9 : 0.35;
    context.fillStyle = allowed ? colour('--green', '#43d3a0') : colour('--dim', '#9fb0d2');
    disc(context, at([x, y]), 1.2 + 2.6 * worth);
    context.fill();
  }
  context.globalAlpha = 1;
  context.strokeStyle = style.color;
  context.lineWidth = 1.6;
  if (plane.asked !== null) {
    disc(context, at(plane.asked), 7);
    context.stroke();
  }
  if (plane.executed !== null) cross(context, at(plane.executed), 5);
  context.fillStyle = style.color;
  context.font = '10px sans-serif';
  const [across, upwards] = plane.names;
  context.fillText(`${across ?? ''} →`, width - 12 - context.measureText(`${across ?? ''} →`).width, height - 1);
  if (upwards !== undefined) context.fillText(`↑ ${upwards}`, 1, 9);
}

function disc(context: CanvasRenderingContext2D, [x, y]: [number, number], radius: number): void {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
}

function cross(context: CanvasRenderingContext2D, [x, y]: [number, number], arm: number): void {
  context.beginPath();
  context.moveTo(x - arm, y);
  context.lineTo(x + arm, y);
  context.moveTo(x, y - arm);
  context.lineTo(x, y + arm);
  context.stroke();
}
