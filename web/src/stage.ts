// A scene on the screen: what stands still on one canvas, what moves on another above it. Knows no plant: shapes come
// from the loop, and what they look like follows from their roles.

import { paintBackdrop, paintGoal } from './backdrop';
import type { Ending, Part, Pose, Scene, Tick } from './core';
import { paintPart } from './craft';
import * as cues from './cues';
import { wantsCalm } from './dom';
import { Exhaust } from './exhaust';
import { FLAME, OWN } from './palette';
import { between, boxOf, Terrain, type Box, type Point } from './shapes';
import { View } from './view';

/** Longest time that may pass between two frames, s: after a pause particles do not leap. */
const LONGEST_FRAME_S = 0.1;
/** How long an ending is shown, ms. */
const ENDING_MS = 900;

/** Everything that stays the same while one scene is shown. */
interface Shown {
  scene: Scene;
  ownGoal: number | null;
  seed: number;
  ticksPerSecond: number;
  exhaust: Exhaust;
  terrain: Terrain;
  /** Index of the part that counts as the craft, and how large that is. */
  body: number;
  size: number;
  ownBox: Box | null;
  way: cues.Way;
  /** Another way to compare with. */
  other: Point[];
}

/** What is written into the picture. */
export interface StageWords {
  /** Behind the distance of a craft that is out of sight. */
  away: string;
  /** Below the person's own goal. */
  own: string;
}

/** Draws a scene. */
export class Stage {
  private readonly back: CanvasRenderingContext2D;
  private readonly front: CanvasRenderingContext2D;
  private readonly view = new View();
  private readonly calm = wantsCalm();
  private shown: Shown | null = null;
  private stale = true;
  private lastAt = 0;
  private ending: { how: Ending; at: Point; since: number } | null = null;
  private motion: cues.Motion | null = null;
  private tilt_rad = 0;

  /** `back` lies below `front`; `words` for another language than English. */
  constructor(
    private readonly backCanvas: HTMLCanvasElement,
    readonly canvas: HTMLCanvasElement,
    private readonly words: StageWords = { away: 'away', own: 'YOUR GOAL' },
  ) {
    this.back = penOf(backCanvas);
    this.front = penOf(canvas);
  }

  /** From now on this scene, whose world has so many ticks a second; `seed` decorates. */
  show(scene: Scene, ownGoal: number | null, seed: number, ticksPerSecond: number): void {
    const body = Math.max(
      scene.movable.findIndex((part) => part.role === 'body'),
      0,
    );
    this.shown = {
      scene,
      ownGoal,
      seed,
      ticksPerSecond,
      body,
      exhaust: new Exhaust(scene, this.calm),
      terrain: new Terrain(scene),
      size: sizeOf(scene.movable[body]),
      ownBox: boxOfGoal(scene, ownGoal),
      way: { points: [], corrected: [] },
      other: [],
    };
    this.ending = null;
    this.motion = null;
    this.tilt_rad = 0;
    this.stale = true;
  }

  /** A tick was flown: its place is kept for the way, and the goal that the person wants from now on is marked. */
  note(tick: Pick<Tick, 'poses' | 'intervention'> & Partial<Pick<Tick, 'pilot_goal'>>): void {
    if (tick.pilot_goal !== undefined) this.want(tick.pilot_goal);
    const pose = tick.poses[this.shown?.body ?? 0];
    if (pose === undefined) return;
    this.shown?.way.points.push([pose.x, pose.y]);
    this.shown?.way.corrected.push(tick.intervention?.effective === true);
  }

  private want(goal: number | null): void {
    if (this.shown === null || this.shown.ownGoal === goal) return;
    this.shown.ownGoal = goal;
    this.shown.ownBox = boxOfGoal(this.shown.scene, goal);
    this.stale = true;
  }

  /** Another way through the same scene, drawn for comparison: the poses of each of its ticks. */
  compare(ticks: Pose[][]): void {
    if (this.shown === null) return;
    const { body } = this.shown;
    this.shown.other = ticks.flatMap((poses): Point[] => {
      const pose = poses[body];
      return pose === undefined ? [] : [[pose.x, pose.y]];
    });
  }

  /** Shows how it ended. */
  end(how: Ending): void {
    if (this.shown === null || this.motion === null) return;
    const { at } = this.motion;
    this.ending = { how, at, since: performance.now() };
    if (how === 'crash') this.shown.exhaust.burst(at, this.shown.size);
    if (how === 'goal') this.shown.exhaust.cheer(at, this.shown.size);
  }

  /** Takes an ending back: the record was wound to before it. */
  rewind(): void {
    this.ending = null;
  }

  /** Speed across and upwards, world units a second, and tilt to the left, rad. */
  get readings(): { across: number; upwards: number; tilt_rad: number } {
    const [across, upwards] = this.motion?.velocity ?? [0, 0];
    return { across, upwards, tilt_rad: this.tilt_rad };
  }

  /** Where what is steered is in the picture: shares of its width and height, from the left and from the top. */
  get place(): [number, number] | null {
    const { motion, view } = this;
    if (motion === null || view.width === 0) return null;
    return [view.x(motion.at[0]) / view.width, view.y(motion.at[1]) / view.height];
  }

  /** Poses between two ticks: `part` 0 is the older, 1 the newer. While nothing `lives`, flames stand still too. */
  draw(older: Pose[], newer: Pose[], part: number, nowMs: number, lives: boolean, upTo = Infinity): void {
    const { shown, front } = this;
    if (shown === null || !this.fit(shown)) return;
    const seconds = lives ? Math.min(Math.max((nowMs - this.lastAt) / 1000, 0), LONGEST_FRAME_S) : 0;
    this.lastAt = nowMs;
    const poses = shown.scene.movable.map((moving, i) => {
      const pose = between(older[i], newer[i], part);
      return pose !== null && moving.role === 'thrust' && this.ending !== null ? { ...pose, strength: 0 } : pose;
    });
    this.move(shown, older, newer, poses);
    shown.exhaust.advance(poses, seconds);
    this.view.useScreen(front);
    front.clearRect(0, 0, this.view.width, this.view.height);
    front.save();
    this.shake(nowMs);
    this.paintBelow(shown, poses, nowMs, upTo);
    this.paintCraft(shown, poses, nowMs);
    this.paintAbove(nowMs);
    front.restore();
  }

  private fit(shown: Shown): boolean {
    const { canvas, backCanvas, view } = this;
    const changed = view.fit(shown.scene, canvas.clientWidth, canvas.clientHeight, devicePixelRatio || 1);
    if (view.width === 0 || view.height === 0) return false;
    if (changed || this.stale) {
      for (const one of [canvas, backCanvas]) {
        one.width = Math.round(view.width * view.ratio);
        one.height = Math.round(view.height * view.ratio);
      }
      paintBackdrop(this.back, view, shown.scene, { goal: shown.ownGoal, words: this.words.own }, shown.seed);
      this.stale = false;
    }
    return true;
  }

  private move(shown: Shown, older: Pose[], newer: Pose[], poses: (Pose | null)[]): void {
    const pose = poses[shown.body];
    if (pose == null) return;
    this.motion = cues.motionOf(older[shown.body], newer[shown.body], pose, shown.size, shown.ticksPerSecond);
    this.tilt_rad = pose.angle_rad;
  }

  private shake(nowMs: number): void {
    if (this.calm || this.ending?.how !== 'crash') return;
    const left = 1 - (nowMs - this.ending.since) / (0.5 * ENDING_MS);
    if (left > 0) this.front.translate(7 * left * Math.sin(nowMs / 17), 5 * left * Math.sin(nowMs / 13));
  }

  private paintBelow(shown: Shown, poses: (Pose | null)[], nowMs: number, upTo: number): void {
    const { front, view, motion } = this;
    const over = this.ending !== null || upTo !== Infinity;
    cues.paintSides(front, view, shown.scene, over ? null : motion);
    cues.paintOther(front, view, shown.other);
    cues.paintWay(front, view, shown.way, Math.min(upTo, shown.way.points.length), over, shown.ticksPerSecond);
    if (shown.ownBox !== null) cues.paintPointer(front, view, shown.ownBox, nowMs, this.calm);
    if (motion === null) return;
    if (shown.terrain.exists) cues.paintShadow(front, view, motion, shown.terrain.heightAt(motion.at[0]));
    for (const [x, y, strength, reach] of shown.exhaust.blownGround(poses)) this.lightGround(x, y, strength, reach);
  }

  private lightGround(x: number, y: number, strength: number, reach: number): void {
    const { front, view } = this;
    const [sx, sy, r] = [view.x(x), view.y(y), 1.7 * reach * view.scale];
    const light = front.createRadialGradient(sx, sy, 0, sx, sy, r);
    light.addColorStop(0, `rgba(${FLAME.middle}, ${0.42 * strength})`);
    light.addColorStop(1, `rgba(${FLAME.edge}, 0)`);
    front.save();
    front.globalCompositeOperation = 'lighter';
    front.fillStyle = light;
    front.fillRect(sx - r, sy - 0.35 * r, 2 * r, 1.35 * r);
    front.restore();
  }

  private paintCraft(shown: Shown, poses: (Pose | null)[], nowMs: number): void {
    const { front, view } = this;
    front.save();
    front.transform(view.scale, 0, 0, -view.scale, view.x(0), view.y(0));
    shown.exhaust.paintParticles(front);
    shown.scene.movable.forEach((part, i) => {
      const pose = poses[i];
      if (pose == null || (part.role !== 'thrust' && pose.strength <= 0)) return;
      front.save();
      front.translate(pose.x, pose.y);
      front.rotate(pose.angle_rad);
      if (part.role === 'thrust') shown.exhaust.paintThrust(front, part, i, nowMs);
      else if (part.role !== 'goal') paintPart(front, part, view.line / view.scale);
      front.restore();
    });
    front.restore();
    this.paintMovingGoals(shown, poses);
  }

  private paintMovingGoals(shown: Shown, poses: (Pose | null)[]): void {
    shown.scene.movable.forEach((part, i) => {
      const pose = poses[i];
      if (part.role !== 'goal' || pose == null || pose.strength <= 0) return;
      paintGoal(this.front, this.view, moved(part, pose), part.goal === shown.ownGoal);
    });
  }

  private paintAbove(nowMs: number): void {
    const { front, view, motion, ending } = this;
    if (motion !== null && ending === null) cues.paintHeading(front, view, motion);
    if (motion !== null) cues.paintOutOfSight(front, view, motion, this.words.away);
    if (ending !== null) this.paintEnding(ending, nowMs);
  }

  /** A ring that runs outwards, for an ending that one should not miss. */
  private paintEnding({ how, at, since }: { how: Ending; at: Point; since: number }, nowMs: number): void {
    const passed = (nowMs - since) / ENDING_MS;
    if (this.calm || passed >= 1 || passed < 0 || !['goal', 'elsewhere', 'crash'].includes(how)) return;
    const { front, view } = this;
    const colour = how === 'goal' ? OWN.light : how === 'crash' ? FLAME.edge : '185, 200, 234';
    for (const lag of how === 'goal' ? [0, 0.18] : [0]) {
      const grown = passed - lag;
      if (grown <= 0) continue;
      front.strokeStyle = `rgba(${colour}, ${0.8 * (1 - grown) ** 2})`;
      front.lineWidth = (1 + 7 * (1 - grown) ** 2) * view.line;
      front.beginPath();
      front.arc(
        view.x(at[0]),
        view.y(at[1]),
        (this.shown?.size ?? 1) * view.scale * (0.5 + 3.4 * Math.sqrt(grown)),
        0,
        2 * Math.PI,
      );
      front.stroke();
    }
  }
}

function penOf(canvas: HTMLCanvasElement): CanvasRenderingContext2D {
  const pen = canvas.getContext('2d');
  if (pen === null) throw new Error('this browser gives no 2D canvas; try a current Firefox, Chrome or Safari');
  return pen;
}

/** The box around the parts of a goal. */
function boxOfGoal(scene: Scene, goal: number | null): Box | null {
  const part = [...scene.fixed, ...scene.movable].find((part) => part.role === 'goal' && part.goal === goal);
  return part === undefined ? null : boxOf(part.shapes);
}

function sizeOf(part: Part | undefined): number {
  if (part === undefined) return 1;
  const [west, south, east, north] = boxOf(part.shapes);
  return Math.max(east - west, north - south);
}

/** A part where its pose puts it, as if it had been made there. */
function moved(part: Part, pose: Pose): Part {
  const [cos, sin] = [Math.cos(pose.angle_rad), Math.sin(pose.angle_rad)];
  const place = ([x, y]: [number, number]): [number, number] => [
    pose.x + cos * x - sin * y,
    pose.y + sin * x + cos * y,
  ];
  const shapes = part.shapes.map((shape) =>
    shape.kind === 'disc' ? { ...shape, center: place(shape.center) } : { ...shape, points: shape.points.map(place) },
  );
  return { ...part, shapes };
}
