// Where the participant is: the server's session, and what this page tells it. What cannot be told now is told again
// until the server has it; the page never goes on from a place that the server does not know of.

import type { KeyLog } from '../flight';
import { readCommitted } from '../../jspsych-cohelm/src/resume';
import type { ClockOffset } from '../../jspsych-cohelm/src/telemetry';
import type { Problem, Session } from './steps';

/** Ms before the first further try, and the longest wait between two. */
const [FIRST_WAIT_MS, LONGEST_WAIT_MS] = [500, 8000];
/** A measurement of the clock is used for so long, ms. */
const CLOCK_HOLDS_MS = 600_000;
/** How often the clock is measured when the page opens. */
const CLOCK_SAMPLES = 4;

/** Why the page cannot go on with this session. */
export type Closed = 'nobody' | 'taken-over' | 'withdrawn';

/** What the page is told. */
export interface PlaceEvents {
  /** The session is another than a moment ago. */
  changed(session: Session): void;
  /** The server cannot be reached, or can again. */
  away(away: boolean): void;
  closed(why: Closed): void;
}

/** What became of an answer: taken, or why not, for each item. */
export type Taken = { taken: true } | { taken: false; problems: Record<string, Problem>; error: string };

/** What happened to a flight that the log should know of. */
export type FlightNews =
  | { begun: { clock_offset_ms: number | null } }
  | {
      interrupted: { tick: number; reason: string };
      resumed: { tick: number; source: string; away_ms: number };
    };

/** The session ended for this page. */
export class SessionClosed extends Error {}

export class Place {
  readonly tab = Array.from(crypto.getRandomValues(new Uint8Array(8)), (byte) =>
    byte.toString(16).padStart(2, '0'),
  ).join('');
  private known: Session | null = null;
  private isClosed = false;
  private wake: () => void = () => {};
  private samples: (ClockOffset & { at: number })[] = [];

  constructor(private readonly events: PlaceEvents) {
    window.addEventListener('online', () => this.tryNow());
  }

  get session(): Session {
    if (this.known === null) throw new Error('the session has not been opened yet');
    return this.known;
  }

  get isOpen(): boolean {
    return this.known !== null && !this.isClosed;
  }

  /** The page's clock minus the server's, by the exchange of the last minutes that took the shortest time. */
  get clock(): ClockOffset | null {
    const recent = this.samples.filter(({ at }) => at > performance.now() - CLOCK_HOLDS_MS);
    const best = recent.sort((a, b) => a.rtt_ms - b.rtt_ms)[0];
    return best === undefined ? null : { offset_ms: best.offset_ms, rtt_ms: best.rtt_ms };
  }

  /** Makes this the live tab. */
  async open(client: Record<string, unknown>): Promise<void> {
    this.isClosed = false;
    this.take(await this.insist('POST', '/api/session/open', { tab: this.tab, client }));
    for (let i = 0; i < CLOCK_SAMPLES; i += 1) await this.refresh();
  }

  async refresh(): Promise<void> {
    this.take(await this.insist('GET', '/api/session'));
  }

  /** Hands in what a step gave. */
  async answer(step: string, data: unknown, pageMs: number): Promise<Taken> {
    const path = `/api/session/steps/${step}`;
    const { status, body } = await this.insist('POST', path, { tab: this.tab, data, page_ms: Math.round(pageMs) });
    if (status === 422) {
      const { items = {}, error = '' } = body as { items?: Record<string, Problem>; error?: string };
      return { taken: false, problems: items, error };
    }
    this.take({ status, body });
    return { taken: true };
  }

  /** What the server committed of a flight. */
  async committed(key: string): Promise<KeyLog | null> {
    const { status, body } = await this.insist('GET', `/api/session/flight/${key}`);
    return status === 200 && body instanceof Uint8Array ? readCommitted(body) : null;
  }

  /** Tells the log about a flight, in the background: the flight does not wait for it. */
  async tell(key: string, news: FlightNews): Promise<void> {
    for (let wait = FIRST_WAIT_MS; !this.isClosed; wait = Math.min(2 * wait, LONGEST_WAIT_MS)) {
      const answered = await this.ask('POST', `/api/session/flight/${key}`, { tab: this.tab, ...news });
      if (answered !== null) return;
      await new Promise((resolve) => setTimeout(resolve, wait));
    }
  }

  async withdraw(): Promise<void> {
    await this.insist('POST', '/api/session/withdraw', { tab: this.tab });
    this.close('withdrawn');
  }

  async choose(language: string): Promise<void> {
    await this.insist('POST', '/api/session/language', { language });
  }

  /** Tries at once what waits for the server. */
  tryNow(): void {
    this.wake();
  }

  /** This tab is not the live one any more. */
  close(why: Closed): void {
    if (this.isClosed) return;
    this.isClosed = true;
    this.events.closed(why);
  }

  private take({ status, body }: Answered): void {
    const said = body as { session?: Session } & Session;
    const session = status === 409 && said.session !== undefined ? said.session : said;
    if (!Array.isArray(session.steps)) throw new Error(`the server answered ${status} without a session`);
    this.known = session;
    this.events.changed(session);
  }

  /** Asks until there is an answer that means something. */
  private async insist(method: 'GET' | 'POST', path: string, body?: unknown): Promise<Answered> {
    let wait = FIRST_WAIT_MS;
    for (let isAway = false; ; isAway = true) {
      const answered = await this.ask(method, path, body);
      if (this.isClosed) throw new SessionClosed();
      if (answered !== null) {
        if (isAway) this.events.away(false);
        this.refuseClosed(answered);
        return answered;
      }
      this.events.away(true);
      await new Promise<void>((resolve) => {
        this.wake = resolve;
        setTimeout(resolve, wait);
      });
      wait = Math.min(2 * wait, LONGEST_WAIT_MS);
    }
  }

  private refuseClosed({ status, body }: Answered): void {
    const isTakenOver = status === 409 && (body as { taken_over?: boolean }).taken_over === true;
    if (isTakenOver) this.close('taken-over');
    else if ([401, 403].includes(status)) this.close('nobody');
    else if (status === 410) this.close('withdrawn');
    if (this.isClosed) throw new SessionClosed();
  }

  /** One try; null if the server is away, too busy, or in trouble of its own. */
  private async ask(method: 'GET' | 'POST', path: string, body: unknown): Promise<Answered | null> {
    const sent = performance.now();
    try {
      const response = await fetch(path, {
        method,
        cache: 'no-store',
        ...(body === undefined ? {} : { body: JSON.stringify(body), headers: { 'content-type': 'application/json' } }),
      });
      if (response.status >= 500 || response.status === 429 || response.status === 408) return null;
      const isJson = response.headers.get('content-type')?.includes('json') === true;
      const content = isJson ? await response.json() : new Uint8Array(await response.arrayBuffer());
      this.measureClock(sent, performance.now(), (content as Partial<Session>).server_ms);
      return { status: response.status, body: content };
    } catch {
      return null;
    }
  }

  private measureClock(sent: number, heard: number, serverMs: number | undefined): void {
    if (serverMs === undefined) return;
    const here = performance.timeOrigin + (sent + heard) / 2;
    const round = (ms: number) => Math.round(10 * ms) / 10;
    this.samples.push({ offset_ms: round(here - serverMs), rtt_ms: round(heard - sent), at: heard });
    if (this.samples.length > 50) this.samples.shift();
  }
}

interface Answered {
  status: number;
  body: unknown;
}
