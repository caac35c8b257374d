// A recorded flight, with a scrubber: the loop flies it again in the page, tick by tick.

import type { Core, Opening, Tick } from './core';
import type { Stage } from './draw';

/** Ticks of history that the overlay shows. */
const HISTORY = 250;

/** Plays a record on a stage. */
export class ReplayRun {
  readonly opening: Opening;
  private readonly ticks: Tick[] = [];
  private position = 0;
  private frame = 0;
  private playing = false;
  private lastAt = 0;
  speed = 1;

  constructor(
    core: Core,
    record: Uint8Array,
    private readonly stage: Stage,
    private readonly moved: (tick: Tick | null, position: number, history: Tick[] | null) => void,
  ) {
    this.opening = core.watch(record);
    for (let tick = 1; tick <= this.length; tick += 1) {
      const report = core.seek(tick);
      if (report !== null) this.ticks.push(report);
    }
    stage.show(this.opening.scene, this.opening.pilot_goal);
    this.frame = requestAnimationFrame((now) => this.drawFrame(now));
  }

  get length(): number {
    return this.opening.ticks ?? 0;
  }

  /** True if some tick carried out something else than the record says. */
  get differs(): boolean {
    return this.ticks.some((tick) => tick.differs);
  }

  get isPlaying(): boolean {
    return this.playing;
  }

  play(): void {
    if (this.position >= this.length) this.position = 0;
    this.playing = true;
    this.lastAt = 0;
  }

  pause(): void {
    this.playing = false;
  }

  seek(position: number): void {
    this.position = Math.min(Math.max(position, 0), this.length);
    const whole = Math.floor(this.position);
    this.moved(this.ticks[whole - 1] ?? null, whole, this.ticks.slice(Math.max(whole - HISTORY, 0), whole));
  }

  dispose(): void {
    cancelAnimationFrame(this.frame);
  }

  private drawFrame(now: number): void {
    this.frame = requestAnimationFrame((next) => this.drawFrame(next));
    if (this.playing) this.advance(now);
    const whole = Math.min(Math.floor(this.position), this.length);
    const older = this.posesAfter(whole);
    const newer = this.posesAfter(Math.min(whole + 1, this.length));
    this.stage.draw(older, newer, this.position - whole, this.playing ? now / 16 : 0);
  }

  private advance(now: number): void {
    const passed = this.lastAt === 0 ? 0 : now - this.lastAt;
    this.lastAt = now;
    const before = Math.floor(this.position);
    const rate = (this.opening.ticks_per_second * this.opening.setup.time_scale * this.speed) / 1000;
    this.position = Math.min(this.position + passed * rate, this.length);
    const whole = Math.floor(this.position);
    for (let tick = before + 1; tick <= whole; tick += 1) this.moved(this.ticks[tick - 1] ?? null, tick, null);
    if (this.position >= this.length) {
      this.playing = false;
      this.moved(this.ticks[whole - 1] ?? null, whole, null);
    }
  }

  private posesAfter(ticks: number) {
    return ticks === 0 ? this.opening.poses : (this.ticks[ticks - 1]?.poses ?? this.opening.poses);
  }
}
