// Ticks that do not drift, whatever the display's rate.

/** How many ticks may be made up for at once; after a longer pause the clock goes on from now instead. */
const MOST_AT_ONCE = 10;

/** Says how many ticks are due, and how far the present moment lies between the last tick and the next. */
export class TickClock {
  private origin = 0;
  private flown = 0;
  private running = false;
  /** Where between two ticks the clock stands while it does not run. */
  private held = 0;
  /** Ticks that were due for longer than a tick when they were flown. */
  late = 0;

  constructor(private readonly tickMs: number) {}

  /** Starts, or goes on from where it was paused: not even part of a tick is lost or given. */
  start(nowMs: number): void {
    this.origin = nowMs - (this.flown + this.held) * this.tickMs;
    this.running = true;
  }

  pause(nowMs: number): void {
    this.held = this.between(nowMs);
    this.running = false;
  }

  /** Stops for good, on the last tick. */
  stop(): void {
    this.held = 1;
    this.running = false;
  }

  /** Ticks that should be flown now. Those that lie too far back are forgiven, not rushed through. */
  due(nowMs: number): number {
    if (!this.running) return 0;
    const behind = Math.floor((nowMs - this.origin) / this.tickMs) - this.flown;
    if (behind > MOST_AT_ONCE) {
      this.late += behind;
      this.origin = nowMs - (this.flown + 1) * this.tickMs;
      this.flown += 1;
      return 1;
    }
    const ticks = Math.max(behind, 0);
    this.late += Math.max(ticks - 1, 0);
    this.flown += ticks;
    return ticks;
  }

  /** Where now lies between the last tick (0) and the next (1). */
  between(nowMs: number): number {
    if (!this.running) return this.held;
    return Math.min(Math.max((nowMs - this.origin) / this.tickMs - this.flown, 0), 1);
  }
}
