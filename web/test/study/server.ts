// A server of studies, as far as the page can tell: it answers fetch and speaks over the socket. For these tests only.

import type { Session, Step } from '../../src/study/steps';

type Answered = { status: number; body: unknown };

/** Keeps a session over a list of steps, as the real one does over its log. */
export class FakeServer {
  place = 0;
  status: Session['status'] = 'under-way';
  isAway = false;
  /** The live tab. */
  tab = '';
  readonly posts: { path: string; body: Record<string, unknown> }[] = [];
  /** Answers in place of the usual one, first come, first served. */
  readonly next: Answered[] = [];
  clockAheadMs = 0;
  /** Why the next flight is refused, if it is. */
  refuses: string | null = null;
  /** Ticks and events that were committed, by flight key. */
  readonly committed = new Map<string, { ticks: number; events: number[] }>();

  constructor(private readonly steps: Step[]) {}

  get session(): Session {
    const goesOn = ['invited', 'under-way', 'completed'].includes(this.status);
    return {
      study: { title: 'Flying together', languages: ['en', 'de'], contact: 'study@example.org' },
      participant: { code: 'P-007', test: false, simulated: false, language: 'en' },
      status: this.status,
      place: this.place,
      total: this.steps.length,
      minutes_left: 7,
      steps: goesOn ? this.steps.slice(this.place) : [],
      server_ms: performance.timeOrigin + performance.now() + this.clockAheadMs,
    };
  }

  /** What stands in for `fetch`. */
  readonly fetch = (path: string, init: { method?: string; body?: string } = {}): Promise<Response> => {
    if (this.isAway) return Promise.reject(new TypeError('network'));
    const body = JSON.parse(init.body ?? '{}') as Record<string, unknown>;
    if (init.method === 'POST') this.posts.push({ path, body });
    const { status, body: answer } = this.next.shift() ?? this.answer(path, body);
    return Promise.resolve(
      new Response(JSON.stringify(answer), { status, headers: { 'content-type': 'application/json' } }),
    );
  };

  /** A flight came to its end: only its telemetry is missing now. */
  ended(key: string): void {
    const step = this.steps[this.place];
    if (step?.kind === 'flight' && step.flight_key === key) step.flown = 'crash';
  }

  /** A flight was refused: it is flown once more, under another key. */
  refused(): void {
    const step = this.steps[this.place];
    if (step?.kind === 'flight') Object.assign(step, { attempt: step.attempt + 1, flight_key: 'f'.repeat(32) });
    this.refuses = null;
  }

  private answer(path: string, body: Record<string, unknown>): Answered {
    if (path === '/api/session/open') this.tab = String(body['tab']);
    else if (body['tab'] !== undefined && body['tab'] !== this.tab)
      return { status: 409, body: { error: 'taken over', taken_over: true } };
    if (path === '/api/session/withdraw') this.status = 'withdrawn';
    const step = /^\/api\/session\/steps\/(.*)$/.exec(path)?.[1];
    if (step === this.steps[this.place]?.id) this.done(body['data'] as Record<string, unknown>);
    return { status: 200, body: this.session };
  }

  private done(data: Record<string, unknown>): void {
    if (data['agreed'] === false) this.status = 'declined';
    else this.place += 1;
    if (this.steps[this.place]?.kind === 'thanks') this.status = 'completed';
  }
}

/** The server's side of the socket: follows a flight without checking it. */
export class FakeSocket extends EventTarget {
  static readonly OPEN = 1;
  static server: FakeServer;
  binaryType = '';
  readyState = 0;
  private key = '';

  constructor(readonly address: string) {
    super();
    queueMicrotask(() => {
      this.readyState = 1;
      this.dispatchEvent(new Event('open'));
    });
  }

  close(): void {
    this.readyState = 3;
  }

  send(bytes: Uint8Array): void {
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    const { server } = FakeSocket;
    if (bytes[1] === 1) {
      this.key = [...bytes.subarray(2, 18)].map((byte) => byte.toString(16).padStart(2, '0')).join('');
      if (!server.committed.has(this.key)) server.committed.set(this.key, { ticks: 0, events: [] });
      if (server.refuses === null) this.say(130, 8, server.committed.get(this.key)!.ticks);
      else this.refuse(server.refuses);
    } else if (bytes[1] === 2) {
      const log = server.committed.get(this.key)!;
      log.ticks = view.getUint32(6, true);
      log.events.push(...bytes.subarray(26));
      this.say(131, 0, log.ticks);
    } else {
      server.ended(this.key);
      this.say(133, 8, 0);
    }
  }

  private refuse(reason: string): void {
    const bytes = new Uint8Array([1, 132, ...new TextEncoder().encode(reason)]);
    FakeSocket.server.refused();
    setTimeout(() => this.dispatchEvent(Object.assign(new Event('message'), { data: bytes.buffer })), 400);
  }

  /** A message with so many bytes for an episode's number, then a count of ticks. */
  private say(kind: number, episode: 0 | 8, ticks: number): void {
    const bytes = new Uint8Array(2 + episode + 4);
    bytes.set([1, kind]);
    if (episode === 8) bytes[2] = 41;
    new DataView(bytes.buffer).setUint32(2 + episode, ticks, true);
    queueMicrotask(() => this.dispatchEvent(Object.assign(new Event('message'), { data: bytes.buffer })));
  }
}
