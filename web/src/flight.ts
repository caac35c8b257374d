// One flight in the page: the loop ticks by the clock, keys and sticks act at the next tick, the canvas draws in between.

import { TickClock } from './clock';
import type { Control, Core, Ending, KeyKind, Opening, Setup, Tick } from './core';
import { PadListener } from './gamepad';
import { KeyListener } from './keys';
import { Meter, type Measured } from './meter';
import { PointerStick } from './pointer';
import { eventsBefore, keyEvents, type LoggedKey } from './record';
import type { Stage } from './stage';
import { TouchKeys } from './touch';
import { directionOf } from './words';

/** What the flight tells whoever shows it. */
export interface FlightEvents {
  /** A tick was flown. */
  tick(tick: Tick): void;
  /** It was paused (hidden tab, lost focus, Esc) or goes on. */
  paused(paused: boolean): void;
  /** It ended. */
  ended(summary: FlightSummary): void;
  /** The loop stopped; the flight ends where its log was last handed on. */
  failed(error: unknown): void;
}

/** What is said after a flight. */
export interface FlightSummary {
  ending: Ending;
  ticks: number;
  seconds: number;
  commands: number;
  corrected: number;
  lateTicks: number;
  lateFrames: number;
  record: Uint8Array;
}

/** What a flight may be told besides; everything may be left out. */
export interface FlightOptions {
  /** The keys that the person chose, for the controls of the plant. */
  bind?: (controls: Control[]) => Control[];
  /** What a control is called for people. */
  nameOf?: (control: string) => string;
  /** True if nothing of what the co-pilot did may be drawn. */
  plain?: boolean;
  /** When the flight began, ms since 1970, if that was before now. */
  begunAt?: number;
  /** Takes the measures of how it went; one of its own if left out. */
  meter?: Meter;
}

/** A flight as far as it was flown: its key log and how many ticks that is good for. */
export interface KeyLog {
  ticks: number;
  /** The events with tick < `ticks`, as in a record. */
  events: Uint8Array;
}

/** Where the key log goes while the flight runs, a second at a time. */
export interface KeyLogSink {
  chunk(fromTick: number, toTick: number, events: Uint8Array, digests: { plant: string; decisions: string }): void;
}

const CHUNK_TICKS = 50;
/** How often the clock is looked at, ms: a tick is flown when it is due, not when the display happens to draw. */
const LOOK_EVERY_MS = 4;
/** A frame that comes later than this after the last, ms, is counted: two frames of a 60 Hz display. */
const LATE_FRAME_MS = 34;

/** A flight from its opening to its end. */
export class FlightRun {
  readonly opening: Opening;
  private readonly clock: TickClock;
  private readonly keys: KeyListener;
  private readonly pad: PadListener;
  /** Only where there are axes. */
  private readonly pointer: PointerStick | null;
  private readonly touch: TouchKeys;
  readonly meter: Meter;
  private older;
  private newer;
  private frame = 0;
  private timer = 0;
  private state: 'ready' | 'flying' | 'paused' | 'ended' = 'ready';
  private startedAt = 0;
  /** Time of the last event of a log that this flight goes on from, ms since it began. */
  private lastEventAt = 0;
  /** The log of a flight that has ended, which the loop does not give any more. */
  private whole: KeyLog | null = null;
  private counts = { ticks: 0, commands: 0, corrected: 0, lateFrames: 0 };
  private lastFrameAt = 0;
  private chunkFrom = 0;
  private eventsSent = 0;

  constructor(
    private readonly core: Core,
    setup: Setup,
    /** True if the plant has axes, for which there is a stick. */
    readonly hasAxes: boolean,
    private readonly stage: Stage,
    private readonly events: FlightEvents,
    private readonly sink: KeyLogSink | null,
    private readonly options: FlightOptions = {},
  ) {
    this.meter = options.meter ?? new Meter();
    this.opening = core.begin(setup);
    const { controls, poses, ticks_per_second, scene, pilot_goal } = this.opening;
    this.older = poses;
    this.newer = poses;
    this.clock = new TickClock(1000 / (ticks_per_second * setup.time_scale));
    const change = (kind: KeyKind, control: number, at: number) => this.key(kind, control, at);
    this.keys = new KeyListener(options.bind?.(controls) ?? controls, (kind, control, at) => {
      this.meter.pressed(at);
      change(kind, control, at);
    });
    this.pad = new PadListener(
      controls,
      hasAxes,
      (kind, control, at) => {
        this.meter.pushed();
        change(kind, control, at);
      },
      (stick, at) => {
        this.meter.pushed();
        this.note(() => core.stick(stick, at - this.startedAt));
      },
    );
    this.pointer = hasAxes
      ? new PointerStick(
          stage.canvas,
          controls,
          () => this.state === 'flying',
          (stick, at) => {
            this.meter.dragged();
            this.note(() => core.stick(stick, at - this.startedAt));
          },
        )
      : null;
    this.touch = new TouchKeys(
      options.bind?.(controls) ?? controls,
      () => this.state === 'flying',
      (kind, control, at) => {
        this.meter.dragged();
        change(kind, control, at);
      },
      options.nameOf ?? directionOf,
    );
    stage.canvas?.parentElement?.append(this.touch.node);
    stage.show(scene, pilot_goal, setup.seed, ticks_per_second);
    this.frame = requestAnimationFrame((now) => this.drawFrame(now));
  }

  /** Flies a log again, at once and unheard: the flight goes on after its last tick, with all keys released. */
  goOnFrom({ ticks, events }: KeyLog): void {
    if (this.state !== 'ready' || this.counts.ticks > 0) return;
    this.guard(() => {
      const log = keyEvents(events);
      let next = 0;
      while (this.counts.ticks < ticks && this.state === 'ready') {
        for (; (log[next]?.tick ?? Infinity) <= this.counts.ticks; next += 1) take(this.core, log[next]!);
        const tick = this.advance();
        if (tick === null) return;
        this.settle(tick);
      }
      this.lastEventAt = log.at(-1)?.atMs ?? 0;
      if (this.state === 'ready' && log.length > 0 && log.at(-1)!.kind !== 'release-all')
        this.core.key('release-all', 0, this.lastEventAt);
    });
  }

  /** The log up to the last tick. */
  log(): KeyLog {
    if (this.whole !== null) return this.whole;
    const { ticks } = this.counts;
    return { ticks, events: eventsBefore(this.core.eventsFrom(0), ticks).bytes };
  }

  /** Starts, or goes on after a pause. */
  start(): void {
    if (this.state !== 'ready' && this.state !== 'paused') return;
    const now = performance.now();
    if (this.state === 'ready') {
      const since = this.options.begunAt === undefined ? 0 : Date.now() - this.options.begunAt;
      this.startedAt = now - Math.max(since, this.lastEventAt, 0);
      this.keys.attach(window);
      this.pointer?.attach();
    }
    this.meter.goesOn(now);
    this.state = 'flying';
    this.lastFrameAt = 0;
    this.clock.start(now);
    this.timer = window.setInterval(() => this.fly(performance.now()), LOOK_EVERY_MS);
    this.events.paused(false);
  }

  pause(): void {
    if (this.state !== 'flying') return;
    const now = performance.now();
    this.keys.releaseAll(now);
    this.pad.releaseAll(now);
    this.touch.releaseAll(now);
    this.pointer?.releaseAll(() => this.key('release-all', 0, now));
    this.clock.pause(now);
    clearInterval(this.timer);
    this.state = 'paused';
    this.meter.pauses(now);
    this.events.paused(true);
  }

  /** Ends the flight as it is. */
  abandon(): void {
    if (this.state === 'flying' || this.state === 'paused') this.guard(() => this.end('abandoned'));
  }

  /** Lets go of window, clock and canvas. */
  dispose(): void {
    cancelAnimationFrame(this.frame);
    clearInterval(this.timer);
    this.keys.detach();
    this.pointer?.detach();
    this.touch.node.remove();
  }

  get isOver(): boolean {
    return this.state === 'ended';
  }

  get isReady(): boolean {
    return this.state === 'ready';
  }

  get isFlying(): boolean {
    return this.state === 'flying';
  }

  /** Ticks flown. */
  get ticks(): number {
    return this.counts.ticks;
  }

  /** How it went on this machine, so far. */
  measured(): Measured {
    return this.meter.soFar(this.clock.late);
  }

  /** Controls that are held now. */
  held(): ReadonlySet<number> {
    return new Set([...this.keys.heldControls(), ...this.pad.heldControls(), ...this.touch.heldControls()]);
  }

  private key(kind: KeyKind, control: number, timeStamp: number): void {
    this.note(() => this.core.key(kind, control, timeStamp - this.startedAt));
  }

  private note(change: () => void): void {
    if (this.state !== 'flying') return;
    this.guard(change);
  }

  private drawFrame(now: number): void {
    this.frame = requestAnimationFrame((next) => this.drawFrame(next));
    if (this.state === 'flying') {
      if (this.lastFrameAt > 0 && now - this.lastFrameAt > LATE_FRAME_MS) this.counts.lateFrames += 1;
      this.lastFrameAt = now;
      this.meter.drew(now);
      this.fly(now);
    }
    this.stage.draw(this.older, this.newer, this.clock.between(now), now, this.state !== 'paused');
  }

  private fly(now: number): void {
    for (let due = this.clock.due(now); due > 0 && this.state === 'flying'; due -= 1) this.guard(() => this.tick(now));
  }

  private tick(now: number): void {
    this.pad.poll(now);
    this.pointer?.poll(now);
    this.meter.acts(performance.now());
    const tick = this.advance();
    if (tick === null) return;
    this.events.tick(tick);
    this.settle(tick);
  }

  private advance(): Tick | null {
    const tick = this.core.tick();
    if (tick === null) return null;
    this.counts.ticks += 1;
    if (tick.asked !== null) this.counts.commands += 1;
    if (tick.intervention?.effective === true) this.counts.corrected += 1;
    this.older = this.newer;
    this.newer = tick.poses;
    const { poses, pilot_goal } = tick;
    this.stage.note(this.options.plain === true ? { poses, pilot_goal, intervention: null } : tick);
    return tick;
  }

  private settle(tick: Tick): void {
    if (this.counts.ticks % CHUNK_TICKS === 0) this.sendChunk();
    if (tick.ending !== null) this.end(tick.ending);
  }

  private sendChunk(): void {
    if (this.sink === null || this.counts.ticks === this.chunkFrom) return;
    const digests = this.core.digests();
    // What was done after the last tick belongs to the next piece, or, at the end, to none.
    const { count, bytes } = eventsBefore(this.core.eventsFrom(this.eventsSent), this.counts.ticks);
    this.sink.chunk(this.chunkFrom, this.counts.ticks, bytes, digests);
    this.chunkFrom = this.counts.ticks;
    this.eventsSent += count;
  }

  private end(ending: Ending): void {
    this.sendChunk();
    this.stop();
    const { ticks, commands, corrected, lateFrames } = this.counts;
    const seconds = ticks / this.opening.ticks_per_second;
    this.whole = this.log();
    const record = this.core.finish();
    this.stage.end(ending);
    this.events.ended({ ending, ticks, seconds, commands, corrected, lateTicks: this.clock.late, lateFrames, record });
  }

  private stop(): void {
    this.state = 'ended';
    this.clock.stop();
    clearInterval(this.timer);
    this.keys.detach();
    this.pointer?.detach();
  }

  /** The loop never fails in a tick; if it does, that is a bug, and the page must say so and live on. */
  private guard(work: () => void): void {
    try {
      work();
    } catch (error) {
      this.stop();
      this.events.failed(error);
    }
  }
}

/** Does in the loop what an event of a log says. */
function take(core: Core, event: LoggedKey): void {
  if (event.kind === 'stick') core.stick(event.stick, event.atMs);
  else core.key(event.kind, event.control, event.atMs);
}
