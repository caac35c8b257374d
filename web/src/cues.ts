// What helps to fly: where the craft is heading, where it is when it is out of sight, that a side is near, which goal
// is one's own. Cues say by shape what they say by colour.

import type { Pose, Scene } from './core';
import { CORRECTED, CUE, OWN, TRAIL } from './palette';
import type { Box, Point } from './shapes';
import type { View } from './view';

type Pen = CanvasRenderingContext2D;

/** Seconds ahead that the arrow points: where the craft would be if it went on like this. */
const AHEAD_S = 0.7;
/** The arrow is at most this share of the view's height. */
const LONGEST_ARROW = 0.24;
/** Seconds of the way flown that are shown in flight. */
const TAIL_S = 2.5;
/** The share of the scene's width within which a side counts as near. */
const NEAR = 0.12;

/** What the craft is doing. */
export interface Motion {
  at: Point;
  /** World units a second. */
  velocity: Point;
  /** How large it is, world units. */
  size: number;
}

/** The way flown: one point a tick, and whether the co-pilot changed something there. */
export interface Way {
  points: Point[];
  corrected: boolean[];
}

/** The way: its tail in flight, all of it afterwards; what the co-pilot corrected is amber and wider. */
export function paintWay(pen: Pen, view: View, way: Way, upTo: number, whole: boolean, ticksPerSecond: number): void {
  const tail = Math.round(TAIL_S * ticksPerSecond);
  const from = whole ? 1 : Math.max(1, upTo - tail);
  pen.lineCap = 'round';
  for (let i = from; i < Math.min(upTo, way.points.length); i += 1) {
    const [[x0, y0], [x1, y1]] = [way.points[i - 1]!, way.points[i]!];
    const fade = whole ? 0.6 : 0.5 * (1 - (upTo - i) / tail);
    pen.strokeStyle = `rgba(${way.corrected[i] === true ? CORRECTED : TRAIL}, ${fade})`;
    pen.lineWidth = (way.corrected[i] === true ? 3.2 : 1.6) * view.line;
    pen.beginPath();
    pen.moveTo(view.x(x0), view.y(y0));
    pen.lineTo(view.x(x1), view.y(y1));
    pen.stroke();
  }
}

/** Another way, dashed. */
export function paintOther(pen: Pen, view: View, points: Point[]): void {
  if (points.length === 0) return;
  pen.strokeStyle = `rgba(${TRAIL}, 0.75)`;
  pen.lineWidth = 1.6 * view.line;
  pen.setLineDash([2 * view.line, 6 * view.line]);
  pen.beginPath();
  points.forEach(([x, y]) => pen.lineTo(view.x(x), view.y(y)));
  pen.stroke();
  pen.setLineDash([]);
}

/** An arrow from the craft's edge to where it is heading. */
export function paintHeading(pen: Pen, view: View, { at, velocity, size }: Motion): void {
  const [vx, vy] = [velocity[0] * AHEAD_S, -velocity[1] * AHEAD_S];
  const whole = Math.hypot(vx, vy) * view.scale;
  if (whole < 7) return;
  const [ux, uy] = [(vx * view.scale) / whole, (vy * view.scale) / whole];
  const length = Math.min(whole, LONGEST_ARROW * view.height);
  const start = 0.62 * size * view.scale;
  const [x, y] = [view.x(at[0]) + ux * start, view.y(at[1]) + uy * start];
  const [tx, ty] = [x + ux * length, y + uy * length];
  pen.strokeStyle = CUE;
  pen.fillStyle = CUE;
  pen.globalAlpha = 0.8;
  pen.lineWidth = 2 * view.line;
  pen.setLineDash([3 * view.line, 5 * view.line]);
  pen.beginPath();
  pen.moveTo(x, y);
  pen.lineTo(tx, ty);
  pen.stroke();
  pen.setLineDash([]);
  pen.beginPath();
  const [tip, wing] = [8 * view.line, 4.5 * view.line];
  pen.moveTo(tx + tip * ux, ty + tip * uy);
  pen.lineTo(tx - wing * uy, ty + wing * ux);
  pen.lineTo(tx + wing * uy, ty - wing * ux);
  pen.fill();
  pen.globalAlpha = 1;
}

/** Where the craft is while it cannot be seen, and how far beyond the edge. */
export function paintOutOfSight(pen: Pen, view: View, { at, size }: Motion, away: string): void {
  const [x, y] = [view.x(at[0]), view.y(at[1])];
  const beyond = 0.5 * size * view.scale;
  if (x > -beyond && x < view.width + beyond && y > -beyond && y < view.height + beyond) return;
  const margin = 26 * view.line;
  const [px, py] = [
    Math.min(Math.max(x, margin), view.width - margin),
    Math.min(Math.max(y, margin), view.height - margin),
  ];
  const angle = Math.atan2(y - py, x - px);
  pen.save();
  pen.translate(px, py);
  pen.scale(view.line, view.line);
  pen.save();
  pen.rotate(angle);
  pen.fillStyle = CUE;
  pen.beginPath();
  pen.moveTo(18, 0);
  pen.lineTo(-6, 11);
  pen.lineTo(-1, 0);
  pen.lineTo(-6, -11);
  pen.fill();
  pen.restore();
  pen.fillStyle = '#fff';
  pen.font = '600 13px system-ui, sans-serif';
  pen.textAlign = py > view.height / 2 ? 'center' : px > view.width / 2 ? 'right' : 'left';
  pen.textBaseline = 'middle';
  pen.fillText(`${(Math.hypot(x - px, y - py) / view.scale).toFixed(1)} ${away}`, px > view.width / 2 ? -22 : 22, 12);
  pen.restore();
}

/** The sides of the scene: faint, and hatched when the craft comes near. */
export function paintSides(pen: Pen, view: View, scene: Scene, motion: Motion | null): void {
  const [west, , east] = scene.bounds;
  const near = NEAR * (east - west);
  for (const [side, distance, outwards] of [
    [west, motion === null ? Infinity : motion.at[0] - west, -1],
    [east, motion === null ? Infinity : east - motion.at[0], 1],
  ] as const) {
    const alarm = Math.min(Math.max(1 - distance / near, 0), 1);
    const x = view.x(side);
    pen.strokeStyle = `rgba(214, 226, 255, ${0.13 + 0.7 * alarm})`;
    pen.lineWidth = (1 + alarm) * view.line;
    pen.setLineDash([2 * view.line, 9 * view.line]);
    pen.beginPath();
    pen.moveTo(x, 0);
    pen.lineTo(x, view.height);
    pen.stroke();
    pen.setLineDash([]);
    if (alarm > 0) hatch(pen, view, x, outwards, alarm);
  }
}

function hatch(pen: Pen, view: View, x: number, outwards: -1 | 1, alarm: number): void {
  const width = Math.min(18 * view.line, Math.max(outwards < 0 ? x : view.width - x, 8 * view.line));
  pen.save();
  pen.beginPath();
  pen.rect(outwards < 0 ? x - width : x, 0, width, view.height);
  pen.clip();
  pen.strokeStyle = `rgba(255, 255, 255, ${0.5 * alarm})`;
  pen.lineWidth = 4 * view.line;
  pen.beginPath();
  for (let y = -width; y < view.height + width; y += 14 * view.line) {
    pen.moveTo(x - width, y + width);
    pen.lineTo(x + width, y - width);
  }
  pen.stroke();
  pen.restore();
}

/** A pointer over the person's own goal; it bobs unless less motion is wanted. */
export function paintPointer(pen: Pen, view: View, [west, , east, north]: Box, nowMs: number, calm: boolean): void {
  const bob = calm ? 0 : 4 * Math.sin(nowMs / 380);
  const size = Math.max(9, view.height * 0.018);
  const [x, y] = [view.x((west + east) / 2), view.y(north) - 0.9 * size + bob];
  pen.fillStyle = OWN.fill;
  pen.strokeStyle = 'rgba(20, 14, 0, 0.7)';
  pen.lineWidth = 1.5 * view.line;
  pen.beginPath();
  pen.moveTo(x, y);
  pen.lineTo(x - size, y - 1.25 * size);
  pen.lineTo(x, y - 0.85 * size);
  pen.lineTo(x + size, y - 1.25 * size);
  pen.closePath();
  pen.stroke();
  pen.fill();
}

/** A shadow below the craft, smaller and darker the nearer the ground: it tells the height. */
export function paintShadow(pen: Pen, view: View, { at, size }: Motion, ground: number): void {
  const height = at[1] - ground;
  if (!Number.isFinite(height) || height > 7 * size) return;
  const near = 1 - Math.max(height, 0) / (7 * size);
  pen.fillStyle = `rgba(3, 6, 14, ${0.5 * near})`;
  pen.beginPath();
  pen.ellipse(
    view.x(at[0]),
    view.y(ground) + 4,
    size * view.scale * (0.75 - 0.35 * near),
    2 + 3 * near,
    0,
    0,
    2 * Math.PI,
  );
  pen.fill();
}

/** How the craft moves, from two poses a tick apart and the pose that is shown. */
export function motionOf(
  older: Pose | undefined,
  newer: Pose | undefined,
  shown: Pose,
  size: number,
  ticksPerSecond: number,
): Motion {
  const speed = (a: number | undefined, b: number | undefined) =>
    a === undefined || b === undefined ? 0 : (b - a) * ticksPerSecond;
  return { at: [shown.x, shown.y], velocity: [speed(older?.x, newer?.x), speed(older?.y, newer?.y)], size };
}
