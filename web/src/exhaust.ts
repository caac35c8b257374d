// Flames, rotors, and what flies off: only to be looked at. Nothing here changes a flight.

import type { Part, Pose, Scene, Shape } from './core';
import { AIR, DUST, FLAME } from './palette';
import { boxOf, inWorld, nozzleOf, Terrain, type Nozzle } from './shapes';

type Pen = CanvasRenderingContext2D;

/** Most particles at once. */
const MOST = 320;
/** Seconds in which a flame grows and in which it dies down. */
const [GROW_S, DIE_S] = [0.035, 0.09];
/** Particles a second at full strength. */
const PER_SECOND = 95;

type Kind = 'spark' | 'dust' | 'shard' | 'ember';

interface Particle {
  kind: Kind;
  x: number;
  y: number;
  vx: number;
  vy: number;
  age: number;
  life: number;
  size: number;
  turn: number;
}

/** The flames and rotors of a scene's thrust parts, and all particles. */
export class Exhaust {
  private readonly thrusts: boolean[];
  /** Of thrusts that blow; one that is only a line spins. */
  private readonly nozzles: (Nozzle | null)[];
  private readonly shown: number[];
  private readonly particles: Particle[] = [];
  private readonly terrain: Terrain;

  /** With `calm` flames stand still and nothing flies. */
  constructor(
    scene: Scene,
    private readonly calm: boolean,
  ) {
    this.thrusts = scene.movable.map((part) => part.role === 'thrust');
    this.nozzles = scene.movable.map((part) => (part.role === 'thrust' ? nozzleOf(part) : null));
    this.shown = scene.movable.map(() => 0);
    this.terrain = new Terrain(scene);
  }

  /** Lets a little time pass. */
  advance(poses: (Pose | null)[], seconds: number): void {
    this.nozzles.forEach((nozzle, i) => {
      const pose = poses[i];
      if (!this.thrusts[i] || pose == null) return;
      const wanted = Math.min(Math.max(pose.strength, 0), 1);
      const shown = this.shown[i]!;
      const step = seconds / (wanted > shown ? GROW_S : DIE_S);
      this.shown[i] = this.calm ? wanted : shown + Math.min(Math.max(wanted - shown, -step), step);
      if (nozzle !== null && !this.calm) this.blow(nozzle, pose, this.shown[i]!, seconds);
    });
    this.move(seconds);
  }

  /** One flame or rotor, at the place of its part. */
  paintThrust(pen: Pen, part: Part, index: number, nowMs: number): void {
    const [nozzle, strength] = [this.nozzles[index], this.shown[index] ?? 0];
    if (part.role !== 'thrust' || strength <= 0.01) return;
    if (nozzle == null) {
      for (const shape of part.shapes) paintRotor(pen, shape, strength, this.calm ? 0 : nowMs);
      return;
    }
    const flicker = this.calm ? 1 : 1 + 0.09 * Math.sin(nowMs / 23 + index) + 0.07 * Math.sin(nowMs / 9.1 + 2 * index);
    const [dx, dy] = [nozzle.tip[0] - nozzle.mouth[0], nozzle.tip[1] - nozzle.mouth[1]];
    pen.save();
    pen.translate(...nozzle.mouth);
    pen.rotate(Math.atan2(dy, dx));
    pen.globalCompositeOperation = 'lighter';
    const length = nozzle.length * (0.35 + 0.65 * strength) * flicker * 1.18;
    glow(pen, length, nozzle.half, strength);
    plume(pen, length, nozzle.half * 1.12, FLAME.edge, 0.75);
    plume(pen, length * 0.74, nozzle.half * 0.86, FLAME.middle, 0.9);
    plume(pen, length * 0.46, nozzle.half * 0.58, FLAME.heart, 1);
    pen.restore();
  }

  /** All particles; the pen's units are the world's. */
  paintParticles(pen: Pen): void {
    for (const particle of this.particles) {
      const left = 1 - particle.age / particle.life;
      if (particle.kind === 'shard') {
        pen.globalCompositeOperation = 'source-over';
        pen.globalAlpha = Math.min(3 * left, 1);
        shard(pen, particle);
        continue;
      }
      const { sprite, glows, alpha, size } = look(particle, left);
      pen.globalCompositeOperation = glows ? 'lighter' : 'source-over';
      pen.globalAlpha = alpha;
      pen.drawImage(sprite, particle.x - size, particle.y - size, 2 * size, 2 * size);
    }
    pen.globalAlpha = 1;
    pen.globalCompositeOperation = 'source-over';
  }

  /** Where a nozzle's blow meets the ground, and how strongly, 0 to 1: light falls there. */
  *blownGround(poses: (Pose | null)[]): Generator<[x: number, y: number, strength: number, reach: number]> {
    for (const [i, nozzle] of this.nozzles.entries()) {
      const pose = poses[i];
      const strength = this.shown[i] ?? 0;
      if (nozzle === null || pose == null || strength < 0.05) continue;
      const [mouth, tip] = [inWorld(pose, nozzle.mouth), inWorld(pose, nozzle.tip)];
      const height = tip[1] - this.terrain.heightAt(tip[0]);
      const reach = nozzle.length * 2.6;
      if (Number.isFinite(height) && tip[1] < mouth[1] && height < reach) {
        yield [tip[0], this.terrain.heightAt(tip[0]), strength * (1 - Math.max(height, 0) / reach), nozzle.length];
      }
    }
  }

  /** Something broke here: shards, embers and dust. */
  burst([x, y]: [number, number], size: number): void {
    if (this.calm) return;
    for (let i = 0; i < 90; i += 1) {
      const kind: Kind = i % 5 === 0 ? 'shard' : i % 5 < 3 ? 'ember' : 'dust';
      const [angle, speed] = [Math.PI * (0.04 + 0.92 * Math.random()), size * (1.2 + 6.5 * Math.random() ** 1.6)];
      this.add({
        kind,
        x: x + size * (Math.random() - 0.5),
        y: y + 0.3 * size * Math.random(),
        vx: Math.cos(angle) * speed,
        vy: Math.sin(angle) * speed,
        age: 0,
        life: kind === 'dust' ? 1.6 : 0.7 + 0.9 * Math.random(),
        size: size * (kind === 'dust' ? 0.16 : 0.05 + 0.07 * Math.random()),
        turn: 6.3 * Math.random(),
      });
    }
  }

  /** Something went well here: embers rise. */
  cheer([x, y]: [number, number], size: number): void {
    if (this.calm) return;
    for (let i = 0; i < 70; i += 1) {
      const side = Math.random() - 0.5;
      this.add({
        kind: 'ember',
        x: x + 2.6 * size * side,
        y: y - 0.3 * size,
        vx: 1.2 * size * side,
        vy: size * (1.6 + 3.4 * Math.random()),
        age: -0.5 * Math.random(),
        life: 1.2 + 0.8 * Math.random(),
        size: size * (0.02 + 0.04 * Math.random()),
        turn: 0,
      });
    }
  }

  private blow(nozzle: Nozzle, pose: Pose, strength: number, seconds: number): void {
    const [mouth, tip] = [inWorld(pose, nozzle.mouth), inWorld(pose, nozzle.tip)];
    const wanted = PER_SECOND * strength * seconds * Math.min(nozzle.half / nozzle.length, 0.35) * 4;
    const count = Math.floor(wanted) + (Math.random() < wanted % 1 ? 1 : 0);
    for (let i = 0; i < count; i += 1) {
      const [along, aside] = [0.35 + 0.5 * Math.random(), (Math.random() - 0.5) * 0.55];
      const [dx, dy] = [tip[0] - mouth[0], tip[1] - mouth[1]];
      const speed = 3.6 + 2.6 * Math.random();
      this.add({
        kind: 'spark',
        x: mouth[0] + along * dx,
        y: mouth[1] + along * dy,
        vx: speed * (dx - aside * dy),
        vy: speed * (dy + aside * dx),
        age: 0,
        life: 0.28 + 0.3 * Math.random(),
        size: nozzle.half * (0.1 + 0.16 * Math.random()),
        turn: 0,
      });
    }
  }

  private add(particle: Particle): void {
    if (this.particles.length < MOST) this.particles.push(particle);
  }

  private move(seconds: number): void {
    let kept = 0;
    for (const particle of this.particles) {
      particle.age += seconds;
      if (particle.age >= particle.life) continue;
      if (particle.age > 0) this.carry(particle, seconds);
      this.particles[kept] = particle;
      kept += 1;
    }
    this.particles.length = kept;
  }

  private carry(particle: Particle, seconds: number): void {
    const falls = particle.kind === 'shard' ? 9 : particle.kind === 'ember' ? 2.2 : 0;
    particle.vy -= falls * seconds;
    if (particle.kind === 'dust') {
      particle.vx *= 1 - Math.min(2.2 * seconds, 1);
      particle.vy *= 1 - Math.min(3 * seconds, 1);
    }
    particle.x += particle.vx * seconds;
    particle.y += particle.vy * seconds;
    particle.turn += 7 * seconds;
    const ground = this.terrain.heightAt(particle.x);
    if (particle.y >= ground) return;
    // What meets the ground is turned aside: exhaust raises dust, shards bounce.
    particle.y = ground;
    particle.vy = Math.abs(particle.vy) * (0.12 + 0.2 * Math.random());
    particle.vx =
      particle.vx * 0.4 + (particle.kind === 'spark' ? Math.abs(particle.vy) * 4 * (Math.random() - 0.5) : 0);
    if (particle.kind === 'spark')
      Object.assign(particle, { kind: 'dust', age: 0, life: 0.7 + 0.5 * Math.random(), size: particle.size * 1.5 });
  }
}

/** What a soft particle looks like when this part of its life is left. */
function look(
  { kind, age, size }: Particle,
  left: number,
): { sprite: HTMLCanvasElement; glows: boolean; alpha: number; size: number } {
  if (age < 0) return { sprite: SPRITES.ember, glows: true, alpha: 0, size };
  if (kind === 'dust')
    return { sprite: SPRITES.dust, glows: false, alpha: 0.34 * left, size: size * (2.2 + 4 * (1 - left)) };
  if (kind === 'ember') return { sprite: SPRITES.ember, glows: true, alpha: left, size: 2 * size };
  return {
    sprite: left > 0.55 ? SPRITES.ember : SPRITES.spark,
    glows: true,
    alpha: 0.75 * left,
    size: size * (1.2 + 2 * left),
  };
}

/** Soft round spots, painted once. */
const SPRITES = { dust: spot(DUST), ember: spot(FLAME.middle), spark: spot(FLAME.edge) };

function spot(colour: string): HTMLCanvasElement {
  const canvas = document.createElement('canvas');
  const half = 24;
  [canvas.width, canvas.height] = [2 * half, 2 * half];
  const pen = canvas.getContext('2d');
  if (pen === null) return canvas;
  const fill = pen.createRadialGradient(half, half, 0, half, half, half);
  fill.addColorStop(0, `rgba(${colour}, 1)`);
  fill.addColorStop(0.35, `rgba(${colour}, 0.6)`);
  fill.addColorStop(1, `rgba(${colour}, 0)`);
  pen.fillStyle = fill;
  pen.fillRect(0, 0, 2 * half, 2 * half);
  return canvas;
}

/** A line that spins, seen from the side: a blurred disc, a blade now and then, and the air that it throws down. */
function paintRotor(pen: Pen, shape: Shape, strength: number, nowMs: number): void {
  const [west, south, east, north] = boxOf([shape]);
  const [x, y, half] = [(west + east) / 2, (south + north) / 2, (east - west) / 2];
  const wash = half * (0.6 + 4.2 * strength * strength);
  const air = pen.createLinearGradient(0, y, 0, y - wash);
  air.addColorStop(0, `rgba(${AIR}, ${0.1 + 0.4 * strength})`);
  air.addColorStop(1, `rgba(${AIR}, 0)`);
  pen.save();
  pen.fillStyle = air;
  pen.beginPath();
  pen.moveTo(x - 0.92 * half, y);
  pen.quadraticCurveTo(x - 0.5 * half, y - 0.4 * wash, x - 0.72 * half, y - wash);
  pen.lineTo(x + 0.72 * half, y - wash);
  pen.quadraticCurveTo(x + 0.5 * half, y - 0.4 * wash, x + 0.92 * half, y);
  pen.fill();
  pen.fillStyle = `rgba(${AIR}, 0.45)`;
  pen.beginPath();
  pen.ellipse(x, y, half, 0.16 * half, 0, 0, 2 * Math.PI);
  pen.fill();
  pen.fillStyle = `rgba(${AIR}, 0.95)`;
  pen.beginPath();
  pen.ellipse(x, y, half * Math.abs(Math.cos(nowMs / 21)), 0.07 * half, 0, 0, 2 * Math.PI);
  pen.fill();
  pen.restore();
}

/** A flame's body: round at the mouth, pointed at its tip, brightest at the mouth. */
function plume(pen: Pen, length: number, half: number, colour: string, alpha: number): void {
  const fill = pen.createLinearGradient(-0.05 * length, 0, length, 0);
  fill.addColorStop(0, `rgba(${colour}, ${alpha})`);
  fill.addColorStop(0.5, `rgba(${colour}, ${0.62 * alpha})`);
  fill.addColorStop(1, `rgba(${colour}, 0)`);
  pen.fillStyle = fill;
  pen.beginPath();
  pen.moveTo(0, half * 0.8);
  pen.bezierCurveTo(0.24 * length, half * 1.3, 0.62 * length, half * 0.62, length, 0);
  pen.bezierCurveTo(0.62 * length, -half * 0.62, 0.24 * length, -half * 1.3, 0, -half * 0.8);
  pen.fill();
}

function glow(pen: Pen, length: number, half: number, strength: number): void {
  const radius = Math.max(length * 1.25, 4 * half);
  const light = pen.createRadialGradient(0.3 * length, 0, 0, 0.3 * length, 0, radius);
  light.addColorStop(0, `rgba(${FLAME.edge}, ${0.34 * strength})`);
  light.addColorStop(0.4, `rgba(${FLAME.edge}, ${0.12 * strength})`);
  light.addColorStop(1, `rgba(${FLAME.edge}, 0)`);
  pen.fillStyle = light;
  pen.fillRect(0.3 * length - radius, -radius, 2 * radius, 2 * radius);
}

function shard(pen: Pen, { x, y, turn, size }: Particle): void {
  pen.fillStyle = '#c6d0e6';
  pen.beginPath();
  for (const corner of [0, 2.2, 4.1])
    pen.lineTo(x + size * Math.cos(turn + corner), y + size * Math.sin(turn + corner));
  pen.fill();
}
