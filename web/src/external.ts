// The way to a plant that is elsewhere: its loop runs in the server, and this page steers and shows. One JSON value a
// text message; crates/cohelm-server/src/external/words.rs explains each.

import type { Ending, KeyKind, Opening, Rule, Tick } from './core';
import type { Stick } from './gamepad';

/** How often the server is told that the person is there, ms: without it, it lets go of everything. */
const HERE_EVERY_MS = 100;
/** After how many ticks that were shown it is told at once; the server sends no more than five that were not. */
const SHOWN_EVERY = 3;

/** True if the page is to be seen and its keys go to it: otherwise nobody steers by it. */
export function isAttended(): boolean {
  return !document.hidden && document.hasFocus();
}

/** A plant that is ready. */
export interface ExternalReady {
  name: string;
  has_axes: boolean;
  /** False if the person flies alone, whatever the rule. */
  has_values: boolean;
  /** Why the person flies alone. */
  why_alone: string | null;
  opening: Opening;
}

/** How a flight ended. */
export interface ExternalEnd {
  ending: Ending;
  /** Why it was abandoned, if nobody wished it. */
  why: string | null;
  ticks: number;
  commands: number;
  corrected: number;
  late: number;
  episode: number | null;
}

/** What the way tells. */
export interface ExternalEvents {
  ready(plant: ExternalReady): void;
  /** The newest tick; some are left out where the page or the network is slow. While the server has let go of everything
   * (`letGo`), what is held counts for nothing and must be pressed again. */
  tick(tick: Tick, late: number, letGo: boolean): void;
  ended(end: ExternalEnd): void;
  refused(reason: string): void;
  /** The connection is gone. */
  closed(): void;
}

/** Where a plant elsewhere is flown, if one is. */
export async function externalPlant(): Promise<{ address: string; time_out_ms: number } | null> {
  const answer = await fetch('/api/external');
  if (!answer.ok) return null;
  return ((await answer.json()) as { external: { address: string; time_out_ms: number } | null }).external;
}

/** One connection: one flight after the other. */
export class ExternalLink {
  private readonly socket: WebSocket;
  private readonly waiting: string[] = [];
  private heartbeat = 0;
  /** The newest tick that was shown, and the newest of which the server knows that. */
  private newest: number | null = null;
  private told = -1;

  constructor(
    address: string,
    private readonly events: ExternalEvents,
    private readonly isSeen = isAttended,
  ) {
    this.socket = new WebSocket(address);
    this.socket.addEventListener('open', () => this.waiting.splice(0).forEach((words) => this.socket.send(words)));
    this.socket.addEventListener('message', (event) => this.hear(JSON.parse(event.data as string) as Heard));
    this.socket.addEventListener('close', () => {
      clearInterval(this.heartbeat);
      this.events.closed();
    });
  }

  begin(seed: number, rule: Rule): void {
    this.say({ begin: { seed, rule } });
  }

  start(): void {
    this.say('start');
    [this.newest, this.told] = [null, -1];
    clearInterval(this.heartbeat);
    this.heartbeat = window.setInterval(() => this.here(), HERE_EVERY_MS);
  }

  /** That tick is on the screen. */
  shown(tick: number): void {
    this.newest = tick;
    if (tick - this.told >= SHOWN_EVERY) this.here();
  }

  key(kind: KeyKind, control: number, atMs: number): void {
    this.say({ change: { change: kind === 'release-all' ? kind : { [kind]: control }, at_ms: atMs } });
  }

  stick(stick: Stick, atMs: number): void {
    this.say({ change: { change: { stick }, at_ms: atMs } });
  }

  stop(): void {
    this.say('stop');
  }

  close(): void {
    clearInterval(this.heartbeat);
    this.socket.close();
  }

  /** Whoever does not see the plant does not steer it. */
  private here(): void {
    if (!this.isSeen()) return;
    this.told = this.newest ?? -1;
    this.say({ here: { shown: this.newest } });
  }

  private say(words: unknown): void {
    const text = JSON.stringify(words);
    if (this.socket.readyState === WebSocket.CONNECTING) this.waiting.push(text);
    else if (this.socket.readyState === WebSocket.OPEN) this.socket.send(text);
  }

  private hear(heard: Heard): void {
    if ('tick' in heard) this.events.tick(heard.tick.report, heard.tick.late, heard.tick.let_go);
    else if ('ready' in heard) this.events.ready(heard.ready);
    else {
      clearInterval(this.heartbeat);
      if ('ended' in heard) this.events.ended(heard.ended);
      else this.events.refused(heard.refused.reason);
    }
  }
}

type Heard =
  | { ready: ExternalReady }
  | { tick: { report: Tick; late: number; let_go: boolean } }
  | { ended: ExternalEnd }
  | { refused: { reason: string } };
