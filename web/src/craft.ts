// What is steered: body, limbs and what decorates them, each painted in its own frame by its role.

import type { Part, Shape } from './core';
import { BODY, GLASS, LIMB } from './palette';
import { boxOf, trace } from './shapes';

type Pen = CanvasRenderingContext2D;

/** Paints a part at the pen's place; `unit` is how many world units a CSS pixel is. */
export function paintPart(pen: Pen, part: Part, unit: number): void {
  const paint = { body: paintBody, limb: paintLimb, decor: paintDecor }[part.role as 'body' | 'limb' | 'decor'];
  if (paint === undefined) return;
  pen.lineJoin = 'round';
  pen.lineCap = 'round';
  for (const shape of part.shapes) paint(pen, shape, unit);
}

/** Lit from above; what has corners has a belt, so that one sees which way is up. */
function paintBody(pen: Pen, shape: Shape, unit: number): void {
  const [west, south, east, north] = boxOf([shape]);
  const [width, height] = [east - west, north - south];
  const fill = pen.createLinearGradient(west, north, east - 0.2 * width, south);
  fill.addColorStop(0, BODY.light);
  fill.addColorStop(0.45, BODY.mid);
  fill.addColorStop(1, BODY.dark);
  trace(pen, shape);
  pen.fillStyle = fill;
  pen.fill();
  if (shape.kind === 'polygon') {
    pen.save();
    pen.clip();
    pen.fillStyle = BODY.belt;
    pen.fillRect(west, south + 0.1 * height, width, 0.1 * height);
    pen.fillStyle = 'rgba(255, 255, 255, 0.35)';
    pen.fillRect(west, north - 0.08 * height, width, 0.08 * height);
    pen.restore();
  }
  outline(pen, shape, BODY.edge, 1.6 * unit);
}

function paintLimb(pen: Pen, shape: Shape, unit: number): void {
  const [west, south, east, north] = boxOf([shape]);
  if (shape.kind === 'line') {
    outline(pen, shape, LIMB.edge, 4.4 * unit);
    outline(pen, shape, LIMB.dark, 2.4 * unit);
    return;
  }
  const fill = pen.createLinearGradient(west, north, east, south);
  fill.addColorStop(0, LIMB.light);
  fill.addColorStop(1, LIMB.dark);
  trace(pen, shape);
  pen.fillStyle = fill;
  pen.fill();
  outline(pen, shape, LIMB.edge, 1.4 * unit);
}

/** Discs look like glass, all else like paint. */
function paintDecor(pen: Pen, shape: Shape, unit: number): void {
  if (shape.kind === 'disc') {
    const [[x, y], r] = [shape.center, shape.radius];
    const glass = pen.createRadialGradient(x - 0.35 * r, y + 0.4 * r, 0.1 * r, x, y, 1.1 * r);
    glass.addColorStop(0, GLASS.light);
    glass.addColorStop(0.45, GLASS.mid);
    glass.addColorStop(1, GLASS.dark);
    pen.fillStyle = glass;
  } else {
    pen.fillStyle = LIMB.dark;
  }
  trace(pen, shape);
  if (shape.kind !== 'line') pen.fill();
  outline(pen, shape, GLASS.edge, 1.4 * unit);
}

function outline(pen: Pen, shape: Shape, colour: string, width: number): void {
  trace(pen, shape);
  pen.strokeStyle = colour;
  pen.lineWidth = width;
  pen.stroke();
}
