// Outlines of scenes: traced, measured, and what of them is needed to draw more than a flat fill.

import type { Part, Pose, Scene, Shape } from './core';

export type Point = [number, number];
export type Box = [west: number, south: number, east: number, north: number];

/** Puts an outline into the pen's path. */
export function trace(pen: CanvasRenderingContext2D, shape: Shape): void {
  pen.beginPath();
  if (shape.kind === 'disc') {
    pen.arc(shape.center[0], shape.center[1], shape.radius, 0, 2 * Math.PI);
    return;
  }
  shape.points.forEach(([x, y], i) => (i === 0 ? pen.moveTo(x, y) : pen.lineTo(x, y)));
  if (shape.kind === 'polygon') pen.closePath();
}

function pointsOf(shape: Shape): Point[] {
  if (shape.kind !== 'disc') return shape.points;
  const [[x, y], r] = [shape.center, shape.radius];
  return [
    [x - r, y - r],
    [x + r, y + r],
  ];
}

/** The smallest box around shapes, in their frame. */
export function boxOf(shapes: Shape[]): Box {
  const points = shapes.flatMap(pointsOf);
  const [xs, ys] = [points.map(([x]) => x), points.map(([, y]) => y)];
  return [Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)];
}

/** A pose between two, angles by the shorter way; strength is the newer one's. */
export function between(older: Pose | undefined, newer: Pose | undefined, part: number): Pose | null {
  if (newer === undefined) return null;
  if (older === undefined) return newer;
  const mix = (a: number, b: number) => a + part * (b - a);
  const turn = newer.angle_rad - older.angle_rad;
  const shorter = turn - 2 * Math.PI * Math.round(turn / (2 * Math.PI));
  return {
    x: mix(older.x, newer.x),
    y: mix(older.y, newer.y),
    angle_rad: older.angle_rad + part * shorter,
    strength: newer.strength,
  };
}

/** A point of a part's own frame, in the world. */
export function inWorld(pose: Pose, [x, y]: Point): Point {
  const [cos, sin] = [Math.cos(pose.angle_rad), Math.sin(pose.angle_rad)];
  return [pose.x + cos * x - sin * y, pose.y + sin * x + cos * y];
}

/** An exhaust's place in its part's frame: from the middle of its mouth to its tip. */
export interface Nozzle {
  mouth: Point;
  tip: Point;
  length: number;
  /** Half the mouth's width. */
  half: number;
}

/** The nozzle of a thrust part: its tip is what lies farthest from the part's origin, its mouth is opposite the tip. */
export function nozzleOf(part: Part): Nozzle | null {
  const points = part.shapes.flatMap(pointsOf);
  if (points.length < 3) return null;
  const distance = (a: Point, b: Point) => Math.hypot(a[0] - b[0], a[1] - b[1]);
  const tip = points.reduce((best, point) => (distance(point, [0, 0]) > distance(best, [0, 0]) ? point : best));
  const [first, second] = [...points].sort((a, b) => distance(b, tip) - distance(a, tip)) as [Point, Point];
  const mouth: Point = [(first[0] + second[0]) / 2, (first[1] + second[1]) / 2];
  return { mouth, tip, length: distance(mouth, tip), half: Math.max(distance(first, second) / 2, 1e-6) };
}

/** The height of what a scene's ground parts offer to stand on, by x; −∞ where there is none. */
export class Terrain {
  private readonly edges: [Point, Point][];

  constructor(scene: Scene) {
    const outlines = scene.fixed.filter((part) => part.role === 'ground').flatMap((part) => part.shapes.map(pointsOf));
    this.edges = outlines.flatMap((points) =>
      points.map((a, i): [Point, Point] => [a, points[(i + 1) % points.length]!]),
    );
  }

  heightAt(x: number): number {
    let highest = -Infinity;
    for (const [[x0, y0], [x1, y1]] of this.edges) {
      if (x0 === x1 || x < Math.min(x0, x1) || x > Math.max(x0, x1)) continue;
      highest = Math.max(highest, y0 + ((x - x0) / (x1 - x0)) * (y1 - y0));
    }
    return highest;
  }

  get exists(): boolean {
    return this.edges.length > 0;
  }
}

/** Numbers from 0 to 1 that only decorate; the same for the same seed. */
export function decoration(seed: number): () => number {
  let state = (seed ^ (seed / 2 ** 32)) >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let mixed = Math.imul(state ^ (state >>> 15), state | 1);
    mixed ^= mixed + Math.imul(mixed ^ (mixed >>> 7), mixed | 61);
    return ((mixed ^ (mixed >>> 14)) >>> 0) / 2 ** 32;
  };
}
