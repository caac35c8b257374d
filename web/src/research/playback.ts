// Where a live flight is shown. Its log comes in pieces of about a second, late by what the network likes; shown it is
// evenly, as fast as it was flown, and as little behind as that allows.

/** Ticks of a usual piece. */
const PIECE_TICKS = 50;
/** Ticks that a piece may come late before the picture has to wait. */
const SPARE_TICKS = 12;
/** How much faster than it was flown a flight is shown to make up for having waited. */
const HURRY = 1.25;
/** Ticks behind the wanted place that are jumped over, not hurried through. */
const JUMP_TICKS = 200;
/** A piece that is later than this after it was due, ms, follows a pause: the pause is waited for, not made up. */
const PAUSE_MS = 700;

/** A place in a flight that goes on with the time. */
export class Playback {
  /** Ticks that are there to be shown. */
  head = 0;
  private place = 0;
  private lookedAt: number | null = null;
  /** When the first tick was flown, by the quickest piece since the last pause. */
  private origin: number | null = null;
  private over = false;

  /** `ticksPerSecond` as the person saw them. */
  constructor(private readonly ticksPerSecond: number) {}

  /** Ticks up to `head` are there now. Those that were there when the watcher came are not shown one by one. */
  arrived(head: number, nowMs: number): void {
    const origin = nowMs - (head / this.ticksPerSecond) * 1000;
    const first = this.origin === null;
    const paused = this.origin !== null && origin - this.origin > PAUSE_MS;
    this.origin = this.origin === null || paused ? origin : Math.min(this.origin, origin);
    this.head = Math.max(this.head, head);
    if (first) this.place = Math.max(0, head - PIECE_TICKS);
  }

  /** The flight has ended: its last ticks are shown to the end. */
  ended(): void {
    this.over = true;
  }

  /** Where to show the flight now, in ticks; never beyond what is there, and never backwards. */
  at(nowMs: number): number {
    const passed = this.lookedAt === null ? 0 : Math.max(nowMs - this.lookedAt, 0);
    this.lookedAt = nowMs;
    const wanted = this.wanted(nowMs);
    const usual = (passed * this.ticksPerSecond) / 1000;
    const behind = wanted - this.place;
    if (behind > JUMP_TICKS) this.place = wanted;
    else this.place += Math.max(0, Math.min(behind, HURRY * usual));
    return this.place;
  }

  /** True once the end was shown. */
  get isDone(): boolean {
    return this.over && this.place >= this.head;
  }

  /** True while there is nothing more to show: the flight is paused, or its log is late. */
  get waits(): boolean {
    return !this.over && this.place >= this.head;
  }

  /** How far behind the flight the picture is, s. */
  behind_s(nowMs: number): number {
    if (this.origin === null) return 0;
    if (this.over) return (this.head - this.place) / this.ticksPerSecond;
    return Math.max(0, (nowMs - this.origin) / 1000 - this.place / this.ticksPerSecond);
  }

  private wanted(nowMs: number): number {
    if (this.origin === null) return 0;
    const live = ((nowMs - this.origin) * this.ticksPerSecond) / 1000;
    const behind = this.over ? 0 : PIECE_TICKS + SPARE_TICKS;
    return Math.min(Math.max(live - behind, 0), this.head);
  }
}
