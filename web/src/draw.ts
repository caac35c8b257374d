// Draws scenes. Knows no plant: shapes come from the loop, colours from their roles.

import type { Part, Pose, Role, Scene, Shape } from './core';

/** Colours told apart without red and green; the person's own goal is the only warm thing on the ground. */
export const COLOURS = {
  skyTop: '#0a0f1f',
  skyLow: '#24385c',
  star: '#dfe8ff',
  ground: '#3a4256',
  groundEdge: '#c3cfe8',
  body: '#e9eef8',
  bodyEdge: '#5b6b8c',
  limb: '#aab6cf',
  limbEdge: '#4a5877',
  decor: '#5f7196',
  goal: '#6f86b5',
  ownGoal: '#ffb000',
  thrustCore: '#fff4d6',
  thrustMid: '#ffb347',
  thrustEdge: '#e5533d',
} as const;

const FILL: Record<Role, [string, string]> = {
  ground: [COLOURS.ground, COLOURS.groundEdge],
  body: [COLOURS.body, COLOURS.bodyEdge],
  limb: [COLOURS.limb, COLOURS.limbEdge],
  thrust: [COLOURS.thrustMid, 'transparent'],
  goal: [COLOURS.goal, COLOURS.goal],
  decor: [COLOURS.decor, COLOURS.decor],
};

/** A canvas that shows a scene, scaled so that all of it is seen. */
export class Stage {
  private readonly pen: CanvasRenderingContext2D;
  private scene: Scene | null = null;
  private ownGoal: number | null = null;
  private view = { scale: 1, left: 0, bottom: 0, width: 0, height: 0 };

  constructor(readonly canvas: HTMLCanvasElement, private readonly calm: boolean) {
    const pen = canvas.getContext('2d');
    if (pen === null) throw new Error('this browser gives no 2D canvas; try a current Firefox, Chrome or Safari');
    this.pen = pen;
  }

  show(scene: Scene, ownGoal: number | null): void {
    this.scene = scene;
    this.ownGoal = ownGoal;
    this.fit();
  }

  /** World units to CSS pixels of the canvas. */
  toScreen(x: number, y: number): [number, number] {
    const { scale, left, bottom } = this.view;
    return [left + x * scale, bottom - y * scale];
  }

  /** Poses between two ticks: `part` 0 is the older, 1 the newer. */
  draw(older: Pose[], newer: Pose[], part: number, flicker: number): void {
    const scene = this.scene;
    if (scene === null) return;
    this.fit();
    this.sky(scene);
    this.pen.save();
    const { scale, left, bottom } = this.view;
    const ratio = devicePixelRatio || 1;
    this.pen.setTransform(scale * ratio, 0, 0, -scale * ratio, left * ratio, bottom * ratio);
    const [west, south, east, north] = scene.bounds;
    this.pen.beginPath();
    this.pen.rect(west, south, east - west, north - south);
    this.pen.clip();
    for (const piece of scene.fixed) this.part(piece, 1, flicker);
    scene.movable.forEach((piece, i) => {
      const pose = between(older[i], newer[i], part);
      if (pose === null || pose.strength <= 0) return;
      this.pen.save();
      this.pen.translate(pose.x, pose.y);
      this.pen.rotate(pose.angle_rad);
      this.part(piece, pose.strength, flicker);
      this.pen.restore();
    });
    this.pen.restore();
    this.frame(scene);
  }

  private fit(): void {
    const { canvas, scene } = this;
    const ratio = devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    if (scene === null) return;
    const [west, south, east, north] = scene.bounds;
    const scale = Math.min(width / (east - west), height / (north - south));
    const left = (width - (east - west) * scale) / 2 - west * scale;
    const bottom = (height + (north - south) * scale) / 2 + south * scale;
    this.view = { scale, left, bottom, width, height };
  }

  private sky(scene: Scene): void {
    const { pen, view } = this;
    const ratio = devicePixelRatio || 1;
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, view.width, view.height);
    const [west, south, east, north] = scene.bounds;
    const [x, y] = this.toScreen(west, north);
    const [right, low] = this.toScreen(east, south);
    const glow = pen.createLinearGradient(0, y, 0, low);
    glow.addColorStop(0, COLOURS.skyTop);
    glow.addColorStop(1, COLOURS.skyLow);
    pen.fillStyle = glow;
    pen.fillRect(x, y, right - x, low - y);
    pen.fillStyle = COLOURS.star;
    for (let i = 0; i < 90; i += 1) {
      const [u, v] = [(i * 0.618034) % 1, (i * 0.754877) % 1];
      pen.globalAlpha = 0.15 + 0.55 * ((i * 0.569840) % 1) * (1 - v);
      const size = 0.6 + 1.2 * ((i * 0.329) % 1);
      pen.fillRect(x + u * (right - x), y + v * v * (low - y) * 0.8, size, size);
    }
    pen.globalAlpha = 1;
  }

  private frame(scene: Scene): void {
    const { pen } = this;
    const ratio = devicePixelRatio || 1;
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    const [west, south, east, north] = scene.bounds;
    const [x, y] = this.toScreen(west, north);
    const [right, low] = this.toScreen(east, south);
    pen.strokeStyle = 'rgba(143, 163, 200, 0.25)';
    pen.lineWidth = 1;
    pen.strokeRect(x + 0.5, y + 0.5, right - x - 1, low - y - 1);
  }

  private part(part: Part, strength: number, flicker: number): void {
    const { pen } = this;
    const own = part.role === 'goal' && part.goal === this.ownGoal;
    const [fill, edge] = own ? [COLOURS.ownGoal, COLOURS.ownGoal] : FILL[part.role];
    if (own) {
      pen.shadowColor = COLOURS.ownGoal;
      pen.shadowBlur = 14;
    }
    if (part.role === 'thrust') {
      this.thrust(part.shapes, strength, flicker);
    } else {
      for (const shape of part.shapes) this.shape(shape, fill, edge, part.role);
    }
    pen.shadowBlur = 0;
  }

  private shape(shape: Shape, fill: string, edge: string, role: Role): void {
    const { pen } = this;
    trace(pen, shape);
    pen.lineJoin = 'round';
    pen.lineWidth = (role === 'ground' || role === 'goal' ? 2 : 1.5) / this.view.scale;
    if (shape.kind !== 'line') {
      pen.fillStyle = fill;
      pen.fill();
    }
    pen.strokeStyle = edge;
    pen.stroke();
  }

  /** A flame is its outline three times, each smaller and brighter; it breathes unless less motion is wanted. */
  private thrust(shapes: Shape[], strength: number, flicker: number): void {
    const { pen } = this;
    const breath = this.calm ? 1 : 0.86 + 0.14 * Math.sin(flicker * 1.7) * Math.cos(flicker * 0.63);
    pen.globalCompositeOperation = 'lighter';
    for (const [size, colour, alpha] of [
      [1, COLOURS.thrustEdge, 0.55],
      [0.72, COLOURS.thrustMid, 0.8],
      [0.4, COLOURS.thrustCore, 0.95],
    ] as const) {
      pen.save();
      pen.scale(size * breath, size * breath);
      pen.globalAlpha = alpha * Math.min(strength, 1);
      pen.fillStyle = colour;
      for (const shape of shapes) {
        trace(pen, shape);
        pen.fill();
      }
      pen.restore();
    }
    pen.globalCompositeOperation = 'source-over';
    pen.globalAlpha = 1;
  }
}

function trace(pen: CanvasRenderingContext2D, shape: Shape): void {
  pen.beginPath();
  if (shape.kind === 'disc') {
    pen.arc(shape.center[0], shape.center[1], shape.radius, 0, 2 * Math.PI);
    return;
  }
  shape.points.forEach(([x, y], i) => (i === 0 ? pen.moveTo(x, y) : pen.lineTo(x, y)));
  if (shape.kind === 'polygon') pen.closePath();
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
