// What never moves during an episode: sky, ranges, ground, goals. Painted once a size, on a canvas of its own.

import type { Part, Scene, Shape } from './core';
import { GOAL, GROUND, OWN, PLANET, RANGE_FOOT, RANGES, SKY, STAR } from './palette';
import { boxOf, decoration, Terrain, trace } from './shapes';
import type { View } from './view';

type Pen = CanvasRenderingContext2D;
type Random = () => number;

/** Paints it all. `seed` only decorates. */
export function paintBackdrop(
  pen: Pen,
  view: View,
  scene: Scene,
  own: { goal: number | null; words: string },
  seed: number,
): void {
  const ownGoal = own.goal;
  const terrain = new Terrain(scene);
  // A stream of its own for each: a larger canvas with more stars moves no planet.
  const random = (stream: number) => decoration(8 * (seed % 2 ** 40) + stream);
  view.useScreen(pen);
  pen.clearRect(0, 0, view.width, view.height);
  paintSky(pen, view, terrain.exists);
  if (terrain.exists) {
    paintStars(pen, view, random(1));
    paintPlanet(pen, view, random(2));
    paintRanges(pen, view, scene, terrain, random(3));
  } else paintGrid(pen, view, scene);
  const goals = scene.fixed.filter((part) => part.role === 'goal');
  const ownParts = goals.filter((part) => part.goal === ownGoal);
  if (terrain.exists) ownParts.forEach((part) => paintBeam(pen, view, part));
  for (const part of scene.fixed) {
    if (part.role === 'ground') paintGround(pen, view, scene, part, random(4));
    else if (part.role === 'goal') paintGoal(pen, view, part, part.goal === ownGoal);
    else paintDecor(pen, view, part);
  }
  goals.forEach((part, i) =>
    paintLabel(
      pen,
      view,
      part,
      part.goal === ownGoal ? ownLabel(own.words, i + 1, goals.length) : String(i + 1),
      part.goal === ownGoal,
      terrain.exists,
    ),
  );
}

function paintSky(pen: Pen, view: View, hasGround: boolean): void {
  const sky = pen.createLinearGradient(0, 0, 0, view.height);
  sky.addColorStop(0, SKY.top);
  sky.addColorStop(0.35, SKY.high);
  sky.addColorStop(hasGround ? 0.66 : 1, SKY.low);
  if (hasGround) sky.addColorStop(0.82, SKY.horizon);
  pen.fillStyle = sky;
  pen.fillRect(0, 0, view.width, view.height);
}

function paintStars(pen: Pen, view: View, random: Random): void {
  const count = Math.round(Math.min((view.width * view.height) / 3600, 420));
  pen.fillStyle = STAR;
  for (let i = 0; i < count; i += 1) {
    const [x, depth, bright] = [random() * view.width, random() ** 1.6, random()];
    const size = (0.5 + 1.1 * bright ** 6) * (view.height / 900 + 0.4);
    pen.globalAlpha = (0.2 + 0.75 * bright ** 3) * (1 - depth) ** 0.8;
    pen.beginPath();
    pen.arc(x, depth * view.height * 0.68, size, 0, 2 * Math.PI);
    pen.fill();
  }
  pen.globalAlpha = 1;
}

/** A lit ball far away, on the side where no readings stand. */
function paintPlanet(pen: Pen, view: View, random: Random): void {
  const radius = view.height * (0.055 + 0.045 * random());
  const [x, y] = [view.width * (0.66 + 0.26 * random()), view.height * (0.14 + 0.12 * random())];
  const glow = pen.createRadialGradient(x, y, radius, x, y, radius * 2.6);
  glow.addColorStop(0, 'rgba(150, 180, 240, 0.16)');
  glow.addColorStop(1, 'rgba(150, 180, 240, 0)');
  pen.fillStyle = glow;
  pen.fillRect(x - 3 * radius, y - 3 * radius, 6 * radius, 6 * radius);
  pen.save();
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.clip();
  const ball = pen.createRadialGradient(x - 0.55 * radius, y - 0.5 * radius, 0.1 * radius, x, y, 1.25 * radius);
  ball.addColorStop(0, PLANET.lit);
  ball.addColorStop(0.5, PLANET.mid);
  ball.addColorStop(1, PLANET.dark);
  pen.fillStyle = ball;
  pen.fillRect(x - radius, y - radius, 2 * radius, 2 * radius);
  pen.translate(x, y);
  pen.rotate(-0.35);
  for (let i = 0; i < 5; i += 1) {
    pen.fillStyle = `rgba(14, 24, 52, ${0.05 + 0.1 * random()})`;
    pen.fillRect(-radius, radius * (-0.9 + 0.38 * i + 0.1 * random()), 2 * radius, radius * (0.06 + 0.14 * random()));
  }
  pen.restore();
}

/** Ridges behind the ground, the farther the paler. */
function paintRanges(pen: Pen, view: View, scene: Scene, terrain: Terrain, random: Random): void {
  const [west, south, east] = scene.bounds;
  const samples = [0.1, 0.3, 0.5, 0.7, 0.9].map((part) => terrain.heightAt(west + part * (east - west)));
  const ground = samples.reduce((sum, height) => sum + Math.max(height, south), 0) / samples.length;
  const unit = (east - west) / 20;
  RANGES.forEach((colour, layer) => {
    const ridge = ridgeLine(random, (0.75 + 0.65 * layer) / (4.6 * unit));
    const [foot, height] = [ground + (0.75 - 0.45 * layer) * unit, (3.1 - 0.75 * layer) * unit];
    const fill = pen.createLinearGradient(0, view.y(foot + height), 0, view.y(foot - 0.9 * unit));
    fill.addColorStop(0, colour);
    fill.addColorStop(1, RANGE_FOOT);
    pen.fillStyle = fill;
    pen.beginPath();
    pen.moveTo(0, view.height);
    const step = Math.max(view.width / 480, 2);
    for (let x = 0; x <= view.width + step; x += step) {
      pen.lineTo(x, view.y(foot + height * ridge((x - view.x(0)) / view.scale)));
    }
    pen.lineTo(view.width, view.height);
    pen.fill();
  });
}

/** A jagged line from 0 to 1: noise of five octaves, folded so that it has crests. */
function ridgeLine(random: Random, frequency: number): (x: number) => number {
  const heights = Array.from({ length: 256 }, random);
  const noise = (x: number) => {
    const cell = Math.floor(x);
    const part = x - cell;
    const [a, b] = [heights[cell & 255]!, heights[(cell + 1) & 255]!];
    return a + (b - a) * part * part * (3 - 2 * part);
  };
  const octaves = [0, 1, 2, 3, 4].map((octave) => ({
    frequency: frequency * 2 ** octave,
    weight: 0.5 ** octave,
    shift: 37 * octave,
  }));
  const most = octaves.reduce((sum, octave) => sum + octave.weight, 0);
  return (x) =>
    octaves.reduce(
      (sum, { frequency, weight, shift }) => sum + weight * (1 - Math.abs(2 * noise(x * frequency + shift) - 1)),
      0,
    ) / most;
}

/** Where nothing else gives a hold, lines do. */
function paintGrid(pen: Pen, view: View, scene: Scene): void {
  const [west, south, east, north] = scene.bounds;
  pen.strokeStyle = 'rgba(150, 180, 240, 0.13)';
  pen.lineWidth = 1;
  pen.beginPath();
  for (let i = 0; i <= 10; i += 1) {
    const [x, y] = [view.x(west + (i / 10) * (east - west)), view.y(south + (i / 10) * (north - south))];
    pen.moveTo(x, view.y(south));
    pen.lineTo(x, view.y(north));
    pen.moveTo(view.x(west), y);
    pen.lineTo(view.x(east), y);
  }
  pen.stroke();
}

function paintGround(pen: Pen, view: View, scene: Scene, part: Part, random: Random): void {
  for (const shape of part.shapes.map((shape) => widened(shape, scene, view))) {
    const [, south, , north] = boxOf([shape]);
    const fill = pen.createLinearGradient(0, view.y(north), 0, view.y(Math.max(south, scene.bounds[1])));
    fill.addColorStop(0, GROUND.top);
    fill.addColorStop(1, GROUND.deep);
    pen.save();
    view.useWorld(pen);
    trace(pen, shape);
    view.useScreen(pen);
    pen.fillStyle = fill;
    pen.fill();
    pen.clip();
    paintStones(pen, view, grain(view, scene), random);
    paintRim(pen, view, grain(view, scene), shape);
    pen.restore();
    strokeWorld(pen, view, shape, GROUND.edge, 2);
  }
}

/** How coarse the ground is painted, in pixels: by the share of the scene, since worlds have units of their own. */
function grain(view: View, scene: Scene): number {
  const [west, , east] = scene.bounds;
  return (view.scale * (east - west)) / 800;
}

/** Light that falls on the ground's edge, and layers below it. */
function paintRim(pen: Pen, view: View, unit: number, shape: Shape): void {
  for (const [width, alpha] of [
    [46, 0.05],
    [26, 0.07],
    [12, 0.1],
  ] as const) {
    strokeWorld(pen, view, shape, `rgba(${GROUND.rim}, ${alpha})`, (width * unit) / view.line);
  }
  for (const [down, alpha] of [
    [34, 0.1],
    [62, 0.07],
    [96, 0.05],
  ] as const) {
    strokeWorld(pen, view, shape, `rgba(${GROUND.rim}, ${alpha})`, 1.2, down * unit);
  }
}

function paintStones(pen: Pen, view: View, size: number, random: Random): void {
  for (let i = 0; i < 260; i += 1) {
    const [x, y, large] = [random() * view.width, view.height * (0.55 + 0.45 * random()), random() ** 3];
    pen.fillStyle = random() < 0.55 ? 'rgba(8, 12, 24, 0.3)' : 'rgba(190, 208, 245, 0.1)';
    pen.beginPath();
    pen.ellipse(x, y, (1 + 7 * large) * size, (0.6 + 3 * large) * size, 0, 0, 2 * Math.PI);
    pen.fill();
  }
}

/** Ground that ends at or beyond the side of the scene goes on to the edge of the canvas. */
function widened(shape: Shape, scene: Scene, view: View): Shape {
  if (shape.kind === 'disc') return shape;
  const [west, south, east] = scene.bounds;
  const [left, right] = view.span;
  const [farWest, farSouth, farEast] = boxOf([shape]);
  const x = (at: number) =>
    at === farWest && at <= west ? Math.min(at, left - 1) : at === farEast && at >= east ? Math.max(at, right + 1) : at;
  const y = (at: number) => (at === farSouth && at <= south ? at - 1 : at);
  return { ...shape, points: shape.points.map(([px, py]) => [x(px), y(py)]) };
}

/** Light over the person's own goal: a column without edges, brightest in its middle and at its foot. */
function paintBeam(pen: Pen, view: View, part: Part): void {
  const [west, south, east, north] = boxOf(part.shapes);
  const width = 1.5 * (east - west) * view.scale;
  const [left, foot] = [view.x((west + east) / 2) - width / 2, view.y(south)];
  const height = foot - view.y(north + 2.4 * (east - west));
  const column = document.createElement('canvas');
  [column.width, column.height] = [Math.ceil(width), Math.ceil(height)];
  const light = column.getContext('2d');
  if (light === null) return;
  const across = light.createLinearGradient(0, 0, width, 0);
  [0, 0.3, 0.8, 1, 0.8, 0.3, 0].forEach((alpha, i) =>
    across.addColorStop(i / 6, `rgba(${OWN.light}, ${0.42 * alpha})`),
  );
  light.fillStyle = across;
  light.fillRect(0, 0, width, height);
  const upwards = light.createLinearGradient(0, height, 0, 0);
  [1, 0.5, 0.22, 0.07, 0].forEach((alpha, i) => upwards.addColorStop(i / 4, `rgba(0, 0, 0, ${alpha})`));
  light.globalCompositeOperation = 'destination-in';
  light.fillStyle = upwards;
  light.fillRect(0, 0, width, height);
  pen.save();
  pen.globalCompositeOperation = 'lighter';
  pen.drawImage(column, left, foot - height);
  pen.restore();
}

/** A goal: the person's own is filled and bright, others are outlines. */
export function paintGoal(pen: Pen, view: View, part: Part, own: boolean): void {
  pen.save();
  if (own) {
    pen.shadowColor = OWN.fill;
    pen.shadowBlur = 16 * view.ratio;
  }
  for (const shape of part.shapes) {
    if (shape.kind !== 'line') {
      pen.save();
      view.useWorld(pen);
      trace(pen, shape);
      pen.restore();
      pen.fillStyle = own ? OWN.fill : GOAL.fill;
      pen.fill();
    }
    strokeWorld(pen, view, shape, own ? OWN.edge : GOAL.edge, own ? 2.5 : 1.8);
  }
  pen.restore();
}

/** Numbers as in the overlay, and in words which is the person's own. */
function ownLabel(words: string, number: number, count: number): string {
  return `★ ${words}${count > 1 ? ` (${number})` : ''}`;
}

/** Below the goal, in the ground, where it is calm. */
function paintLabel(pen: Pen, view: View, part: Part, label: string, own: boolean, hasGround: boolean): void {
  const [west, south, east] = boxOf(part.shapes);
  const size = Math.max(11, view.height * 0.021);
  const middle = view.x((west + east) / 2);
  const y = Math.min(view.y(south) + size * (hasGround ? 1.7 : 1.3), view.height - size);
  pen.textAlign = 'center';
  pen.textBaseline = 'middle';
  pen.font = `${own ? 700 : 500} ${size}px system-ui, 'Noto Sans', 'DejaVu Sans', sans-serif`;
  pen.fillStyle = own ? OWN.ink : GOAL.ink;
  pen.globalAlpha = own ? 1 : 0.75;
  pen.fillText(label, within(middle, 0.5 * pen.measureText(label).width + 4, view.width), y);
  pen.globalAlpha = 1;
}

/** The middle of something so wide to each side of it, moved as far as it must be to be seen whole. */
export function within(middle: number, half: number, width: number): number {
  return Math.max(Math.min(middle, width - half), half);
}

function paintDecor(pen: Pen, view: View, part: Part): void {
  part.shapes.forEach((shape) => strokeWorld(pen, view, shape, GOAL.edge, 1.5));
}

/** Strokes a shape of the world with a line of so many thin lines' width, so many CSS pixels below its place. */
function strokeWorld(pen: Pen, view: View, shape: Shape, colour: string, width: number, below = 0): void {
  pen.save();
  view.useWorld(pen);
  pen.translate(0, -below / view.scale);
  trace(pen, shape);
  pen.restore();
  pen.lineJoin = 'round';
  pen.lineWidth = width * view.line;
  pen.strokeStyle = colour;
  pen.stroke();
}
