// How a flight went on this machine: what a study needs to know besides the keys. Knows no loop; whoever flies tells it
// what happens, with times by the page's clock in ms.

/** Times from keys to ticks that are kept; more than a person makes in a flight. */
const MOST_TIMES = 5000;

/** What was measured so far, as it is kept over a reload. */
export interface Measured {
  frames: number;
  dropped_frames: number;
  hidden_ms: number;
  pauses: number;
  paused_ms: number;
  interruptions: number;
  away_ms: number;
  late_ticks: number;
  inputs: ('keyboard' | 'gamepad' | 'pointer')[];
  /** From the event's time stamp to the tick at which it acts, ms, each. */
  key_to_tick_ms: number[];
}

const NOTHING: Measured = {
  frames: 0,
  dropped_frames: 0,
  hidden_ms: 0,
  pauses: 0,
  paused_ms: 0,
  interruptions: 0,
  away_ms: 0,
  late_ticks: 0,
  inputs: [],
  key_to_tick_ms: [],
};

/** Takes the measures of one flight. */
export class Meter {
  private readonly measured: Measured;
  private readonly waiting: number[] = [];
  private lastFrameAt: number | null = null;
  private pausedAt: number | null = null;
  private hiddenAt: number | null = null;

  /** `frameMs` is how long the display shows a frame; `before` is what was measured before an interruption. */
  constructor(
    private readonly frameMs = 1000 / 60,
    before: Measured = NOTHING,
  ) {
    this.measured = { ...before, inputs: [...before.inputs], key_to_tick_ms: [...before.key_to_tick_ms] };
  }

  /** A key changed a control. */
  pressed(stampMs: number): void {
    this.used('keyboard');
    this.waiting.push(stampMs);
  }

  /** A gamepad changed something: it is asked at the tick, so its time says nothing. */
  pushed(): void {
    this.used('gamepad');
  }

  /** A drag moved the stick, or a finger pressed a button on the screen. */
  dragged(): void {
    this.used('pointer');
  }

  /** A tick begins: what was pressed acts now. */
  acts(nowMs: number): void {
    for (const stamp of this.waiting.splice(0)) {
      if (this.measured.key_to_tick_ms.length < MOST_TIMES)
        this.measured.key_to_tick_ms.push(Math.round(10 * Math.max(nowMs - stamp, 0)) / 10);
    }
  }

  /** A frame was drawn while the craft flew. */
  drew(nowMs: number): void {
    this.measured.frames += 1;
    if (this.lastFrameAt !== null)
      this.measured.dropped_frames += Math.max(Math.round((nowMs - this.lastFrameAt) / this.frameMs) - 1, 0);
    this.lastFrameAt = nowMs;
  }

  pauses(nowMs: number): void {
    this.measured.pauses += 1;
    this.pausedAt = nowMs;
    this.waiting.length = 0;
  }

  goesOn(nowMs: number): void {
    if (this.pausedAt !== null) this.measured.paused_ms += nowMs - this.pausedAt;
    this.pausedAt = null;
    this.lastFrameAt = null;
    this.waiting.length = 0;
  }

  /** The tab was hidden, or is to be seen again. */
  hides(hidden: boolean, nowMs: number): void {
    if (this.hiddenAt !== null) this.measured.hidden_ms += nowMs - this.hiddenAt;
    this.hiddenAt = hidden ? nowMs : null;
  }

  /** The page was left in the air, and the flight goes on only now. */
  cameBack(awayMs: number): void {
    this.measured.interruptions += 1;
    this.measured.away_ms += Math.max(Math.round(awayMs), 0);
  }

  /** Everything so far; `lateTicks` is the clock's count since the flight was begun in this page. */
  soFar(lateTicks: number): Measured {
    return { ...this.measured, late_ticks: this.measured.late_ticks + lateTicks };
  }

  private used(input: Measured['inputs'][number]): void {
    if (!this.measured.inputs.includes(input)) this.measured.inputs.push(input);
  }
}

/** Median, 95th percentile and greatest of some times, ms; null if there are none. */
export function summary(times: readonly number[]): { median: number; p95: number; most: number } | null {
  if (times.length === 0) return null;
  const sorted = [...times].sort((a, b) => a - b);
  const at = (share: number) => sorted[Math.min(Math.ceil(share * sorted.length), sorted.length) - 1]!;
  return { median: at(0.5), p95: at(0.95), most: sorted.at(-1)! };
}
