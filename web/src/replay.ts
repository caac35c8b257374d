// A recorded flight, wound to any moment: the loop flies it again in the page, tick by tick.

import type { Core, Opening, Pose, Tick } from './core';
import { History } from './history';
import type { Stage } from './stage';

/** How long the page may be kept busy reading a record before it draws again, ms. */
const BUSY_MS = 24;
/** Numbers of a pose. */
const POSE = 4;

/** What is kept of a record to draw any moment of it: little, since records may be long. */
export interface Recording {
  opening: Opening;
  length: number;
  /** Ticks at which something else was carried out now than the record says. */
  differing: number;
  history: History;
  /** The poses before each tick, and after the last one. */
  posesAt(tick: number): Pose[];
  /** All of the last of so many ticks, flown again; null before the first. */
  tickAt(tick: number): Tick | null;
}

/**
 * Flies a record through once; null if `goOn` says no, at the beginning or in between: the loop is then somebody else's
 * and is not touched. `told` hears how much of it was read, 0 to 1.
 */
export async function readRecording(
  core: Core,
  record: Uint8Array,
  goOn: () => boolean,
  told: (part: number) => void,
): Promise<Recording | null> {
  if (!goOn()) return null;
  const opening = core.watch(record);
  const length = opening.ticks ?? 0;
  const parts = opening.poses.length;
  const poses = new Float32Array((length + 1) * parts * POSE);
  const keep = (tick: number, list: Pose[]) =>
    list.forEach((pose, i) => poses.set([pose.x, pose.y, pose.angle_rad, pose.strength], (tick * parts + i) * POSE));
  keep(0, opening.poses);
  const history = new History();
  let differing = 0;
  let busySince = performance.now();
  for (let tick = 1; tick <= length; tick += 1) {
    const report = core.seek(tick);
    if (report === null) break;
    keep(tick, report.poses);
    history.push(report);
    if (report.differs) differing += 1;
    if (performance.now() - busySince > BUSY_MS) {
      told(tick / length);
      await new Promise((resume) => setTimeout(resume));
      if (!goOn()) return null;
      busySince = performance.now();
    }
  }
  const posesAt = (tick: number): Pose[] =>
    Array.from({ length: parts }, (_, i) => {
      const at = (tick * parts + i) * POSE;
      return { x: poses[at]!, y: poses[at + 1]!, angle_rad: poses[at + 2]!, strength: poses[at + 3]! };
    });
  return { opening, length, differing, history, posesAt, tickAt: (tick) => (tick === 0 ? null : core.seek(tick)) };
}

/** A recording and the stage that it is drawn on. */
export interface Screen {
  recording: Recording;
  stage: Stage;
  /** Its end was shown. */
  over?: boolean;
}

/** Plays recordings in step, each on a stage of its own; the first one sets the pace. */
export class ReplayRun {
  speed = 1;
  /** Ticks of the longest. */
  readonly length: number;
  private position = 0;
  private frame = 0;
  private playing = false;
  private lastAt = 0;

  constructor(
    private readonly screens: readonly [Screen, ...Screen[]],
    private readonly moved: (position: number) => void,
  ) {
    this.length = Math.max(...screens.map(({ recording }) => recording.length));
    screens.forEach(prepare);
    this.frame = requestAnimationFrame((now) => this.drawFrame(now));
  }

  get isPlaying(): boolean {
    return this.playing;
  }

  /** Whole ticks from the beginning. */
  get tick(): number {
    return Math.min(Math.floor(this.position), this.length);
  }

  play(): void {
    if (this.position >= this.length) this.seek(0);
    this.playing = true;
    this.lastAt = 0;
  }

  pause(): void {
    this.playing = false;
    this.lastAt = 0;
  }

  seek(position: number): void {
    this.position = Math.min(Math.max(position, 0), this.length);
    this.tell();
  }

  dispose(): void {
    cancelAnimationFrame(this.frame);
  }

  private drawFrame(now: number): void {
    this.frame = requestAnimationFrame((next) => this.drawFrame(next));
    if (this.playing) this.advance(now);
    for (const { recording, stage, over } of this.screens) {
      const older = Math.min(this.tick, recording.length);
      const newer = Math.min(older + 1, recording.length);
      const part = Math.min(this.position, recording.length) - older;
      stage.draw(
        recording.posesAt(older),
        recording.posesAt(newer),
        part,
        now,
        this.playing || over === true,
        older + 1,
      );
    }
  }

  private advance(now: number): void {
    const passed = this.lastAt === 0 ? 0 : now - this.lastAt;
    this.lastAt = now;
    const before = this.tick;
    // As fast as the person saw it, times what was chosen.
    const { ticks_per_second, setup } = this.screens[0].recording.opening;
    const ticks = (passed * ticks_per_second * setup.time_scale * this.speed) / 1000;
    this.position = Math.min(this.position + ticks, this.length);
    if (this.position >= this.length) this.playing = false;
    if (this.tick !== before || !this.playing) this.tell();
  }

  private tell(): void {
    for (const screen of this.screens) {
      const { recording, stage } = screen;
      const ending = this.tick >= recording.length ? recording.tickAt(recording.length)?.ending : null;
      const ended = ending != null;
      if (ended && screen.over !== true) stage.end(ending);
      if (!ended && screen.over === true) stage.rewind();
      screen.over = ended;
    }
    this.moved(this.tick);
  }
}

/** Puts a recording's scene up, with the whole way that it goes. */
function prepare({ recording, stage }: Screen): void {
  const { opening, history, length, posesAt } = recording;
  stage.show(opening.scene, opening.pilot_goal, opening.setup.seed, opening.ticks_per_second);
  for (let tick = 1; tick <= length; tick += 1) {
    const changed = ['corrected', 'opposed'].includes(history.outcomes[tick - 1] ?? 'none');
    stage.note({ poses: posesAt(tick), intervention: { effective: changed, nominal: changed, opposed: false } });
  }
}
