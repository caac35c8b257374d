// One flight in the page: the loop ticks by the clock, keys act at the next tick, the canvas draws in between.

import { TickClock } from './clock';
import type { Core, Ending, KeyKind, Opening, Setup, Tick } from './core';
import { Stage } from './draw';
import { KeyListener } from './keys';

/** What the flight tells whoever shows it. */
export interface FlightEvents {
  /** A tick was flown. */
  tick(tick: Tick): void;
  /** It was paused (hidden tab, lost focus) or goes on. */
  paused(paused: boolean): void;
  /** It ended. */
  ended(summary: FlightSummary): void;
}

/** What is said after a flight. */
export interface FlightSummary {
  ending: Ending;
  ticks: number;
  seconds: number;
  commands: number;
  corrected: number;
  lateTicks: number;
  droppedFrames: number;
}

/** Where the key log goes while the flight runs, a second at a time. */
export interface KeyLogSink {
  chunk(fromTick: number, toTick: number, events: Uint8Array, digests: { plant: string; decisions: string }): void;
}

const CHUNK_TICKS = 50;

/** A flight from its opening to its end. */
export class FlightRun {
  readonly opening: Opening;
  private readonly clock: TickClock;
  private readonly listener: KeyListener;
  private older;
  private newer;
  private frame = 0;
  private state: 'ready' | 'flying' | 'paused' | 'ended' = 'ready';
  private startedAt = 0;
  private counts = { ticks: 0, commands: 0, corrected: 0, droppedFrames: 0 };
  private lastFrameAt = 0;
  private chunkFrom = 0;
  private eventsSent = 0;
  private eventsMade = 0;

  constructor(
    private readonly core: Core,
    setup: Setup,
    private readonly stage: Stage,
    private readonly events: FlightEvents,
    private readonly sink: KeyLogSink | null,
  ) {
    this.opening = core.begin(setup);
    this.older = this.opening.poses;
    this.newer = this.opening.poses;
    this.clock = new TickClock(1000 / (this.opening.ticks_per_second * setup.time_scale));
    this.listener = new KeyListener(this.opening.controls, (kind, control, at) => this.key(kind, control, at));
    stage.show(this.opening.scene, this.opening.pilot_goal);
    this.frame = requestAnimationFrame((now) => this.drawFrame(now));
  }

  start(): void {
    if (this.state !== 'ready' && this.state !== 'paused') return;
    const now = performance.now();
    if (this.state === 'ready') {
      this.startedAt = now;
      this.listener.attach(window);
    }
    this.state = 'flying';
    this.lastFrameAt = 0;
    this.clock.start(now);
    this.events.paused(false);
  }

  pause(): void {
    if (this.state !== 'flying') return;
    this.listener.releaseAll(performance.now());
    this.clock.pause();
    this.state = 'paused';
    this.events.paused(true);
  }

  /** Ends the flight as it is. */
  abandon(): void {
    if (this.state === 'flying' || this.state === 'paused') this.end('abandoned');
  }

  /** Lets go of window, clock and canvas. */
  dispose(): void {
    cancelAnimationFrame(this.frame);
    this.listener.detach();
  }

  get isOver(): boolean {
    return this.state === 'ended';
  }

  get isPaused(): boolean {
    return this.state === 'paused';
  }

  get isReady(): boolean {
    return this.state === 'ready';
  }

  /** Ticks flown. */
  get ticks(): number {
    return this.counts.ticks;
  }

  /** Controls that are held now. */
  held(): ReadonlySet<number> {
    return this.listener.heldControls();
  }

  private key(kind: KeyKind, control: number, timeStamp: number): void {
    if (this.state !== 'flying') return;
    this.core.key(kind, control, timeStamp - this.startedAt);
    this.eventsMade += 1;
  }

  private drawFrame(now: number): void {
    this.frame = requestAnimationFrame((next) => this.drawFrame(next));
    if (this.state === 'flying') this.fly(now);
    this.stage.draw(this.older, this.newer, this.clock.between(now), this.state === 'flying' ? now / 16 : 0);
  }

  private fly(now: number): void {
    if (this.lastFrameAt > 0 && now - this.lastFrameAt > 34) this.counts.droppedFrames += 1;
    this.lastFrameAt = now;
    for (let due = this.clock.due(now); due > 0 && this.state === 'flying'; due -= 1) this.tick();
  }

  private tick(): void {
    const tick = this.core.tick();
    if (tick === null) return;
    this.counts.ticks += 1;
    if (tick.asked !== null) this.counts.commands += 1;
    if (tick.intervention?.effective === true) this.counts.corrected += 1;
    this.older = this.newer;
    this.newer = tick.poses;
    this.events.tick(tick);
    if (this.counts.ticks % CHUNK_TICKS === 0) this.sendChunk();
    if (tick.ending !== null) this.end(tick.ending);
  }

  private sendChunk(): void {
    if (this.sink === null || this.counts.ticks === this.chunkFrom) return;
    const digests = this.core.digests();
    this.sink.chunk(this.chunkFrom, this.counts.ticks, this.core.eventsFrom(this.eventsSent), digests);
    this.chunkFrom = this.counts.ticks;
    this.eventsSent = this.eventsMade;
  }

  private end(ending: Ending): void {
    this.sendChunk();
    this.state = 'ended';
    this.clock.pause();
    this.listener.detach();
    const { ticks, commands, corrected, droppedFrames } = this.counts;
    const seconds = ticks / this.opening.ticks_per_second;
    const summary = { ending, ticks, seconds, commands, corrected, lateTicks: this.clock.late, droppedFrames };
    this.core.finish();
    this.events.ended(summary);
  }
}
