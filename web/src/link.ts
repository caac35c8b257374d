// The way to the server. Flights go on whatever happens to it: their key logs are kept until the server has them.

import type { Ending, Setup } from './core';
import { keepPending, keptPending, PENDING_PLACE, type Pending } from './pending';
import * as protocol from './protocol';

/** Ms before the first attempt to connect again, and the longest wait between two. */
const [FIRST_WAIT_MS, LONGEST_WAIT_MS] = [500, 8000];
/** How often a flight may break the connection by what it says before it is given up. */
const MOST_BREAKS = 3;
/** Close codes that blame the page's message (docs/records.md, "Closing"). */
const BLAMES_MESSAGE = [1002, 1003, 1009];
/** The code with which the server says that another tab flies for this person now. */
const TAKEN_OVER = 4001;

/** What the link tells. */
export interface LinkEvents {
  /** The connection came or went, or the number of flights that wait for it changed. */
  state(connected: boolean, waiting: number): void;
  /** Something went wrong that a person should know. */
  trouble(text: string): void;
  /** The server said who it is. */
  welcome(about: protocol.Welcome): void;
  /** Other values assist from the next flight on. */
  newModel(hash: string): void;
  /** A flight is stored, under this number; `key` is what it was begun with, as hexadecimal digits. */
  stored(episode: number, key: string): void;
  /** A flight cannot be stored. Without this it is trouble. */
  refused?(reason: string, key: string): void;
  /** Another tab took over; this link does not connect again. */
  takenOver?(): void;
}

/** What a flight is begun with, if not with a random key and now. */
export interface Begin {
  /** Sixteen bytes. */
  key?: Uint8Array;
  /** ms since 1970. */
  begunAt?: number;
}

/** How far a flight was sent on this connection. */
interface Sending {
  flight: Pending;
  /** Pieces that were sent; null until the server has said where to go on from. */
  pieces: number | null;
  end: boolean;
  breaks: number;
}

/** Sends flights one after the other, and again after a lost connection. */
export class Link {
  private socket: WebSocket | null = null;
  private readonly queue: Sending[];
  private flying: Pending | null = null;
  private wait = FIRST_WAIT_MS;
  private closed = false;

  /** `place` is where finished flights outlive a reload in this browser; null if somebody else sees to that. */
  constructor(
    private readonly address: string,
    private readonly events: LinkEvents,
    private readonly place: string | null = PENDING_PLACE,
  ) {
    this.queue = place === null ? [] : keptPending(place).map(fresh);
    this.connect();
  }

  /** A flight begins, or goes on under the key that it was begun with; then its pieces come from the first tick. */
  begin(setup: Setup, { key, begunAt }: Begin = {}): void {
    this.flying = {
      key: key ?? crypto.getRandomValues(new Uint8Array(16)),
      begunAt: begunAt ?? Date.now(),
      setup,
      pieces: [],
      end: null,
    };
    this.queue.push(fresh(this.flying));
    if (this.queue.length === 1) this.announce();
  }

  get isConnected(): boolean {
    return this.socket !== null;
  }

  /** Forgets the flight in the air: it is begun again later, or never. */
  forget(): void {
    if (this.flying !== null) this.drop(this.flying);
  }

  /** Says good-bye; what was not sent is not sent from here any more. */
  close(): void {
    this.closed = true;
    this.socket?.close();
  }

  /** A piece of its key log. */
  chunk(from: number, to: number, events: Uint8Array, digests: { plant: string; decisions: string }): void {
    this.flying?.pieces.push({ from, to, events, digests });
    this.flush();
  }

  /** It ended, where its last piece did. A flight that ended before its first tick is forgotten. */
  end(ending: Ending): void {
    const flight = this.flying;
    this.flying = null;
    if (flight === null) return;
    const last = flight.pieces.at(-1);
    if (last === undefined) {
      this.drop(flight);
      return;
    }
    flight.end = { ticks: last.to, ending, digests: last.digests };
    this.tell();
    this.flush();
  }

  private connect(): void {
    const socket = new WebSocket(this.address);
    socket.binaryType = 'arraybuffer';
    socket.addEventListener('open', () => {
      if (this.closed) {
        socket.close();
        return;
      }
      this.socket = socket;
      this.wait = FIRST_WAIT_MS;
      for (const sending of this.queue) Object.assign(sending, { pieces: null, end: false });
      this.tell();
      this.announce();
    });
    socket.addEventListener('message', (event) => this.hear(new Uint8Array(event.data as ArrayBuffer)));
    socket.addEventListener('close', (event) => {
      this.socket = null;
      this.blame(event.code, event.reason);
      this.tell();
      if (event.code === TAKEN_OVER) this.events.takenOver?.();
      this.closed ||= event.code === TAKEN_OVER;
      if (this.closed) return;
      setTimeout(() => {
        if (!this.closed) this.connect();
      }, this.wait);
      this.wait = Math.min(this.wait * 2, LONGEST_WAIT_MS);
    });
  }

  /** A flight whose messages break the connection again and again must not keep the others from the server. */
  private blame(code: number, reason: string): void {
    const first = this.queue[0];
    if (first === undefined || !BLAMES_MESSAGE.includes(code)) return;
    first.breaks += 1;
    if (first.breaks < MOST_BREAKS) return;
    if (this.events.refused === undefined) this.events.trouble(`A flight was not stored: ${reason}`);
    else this.refuse(first.flight, reason);
    this.drop(first.flight);
  }

  private hear(bytes: Uint8Array): void {
    const message = protocol.read(bytes);
    if (message === null) {
      this.events.trouble('The server speaks another version; reload the page.');
      return;
    }
    if (message.kind === 'welcome') this.events.welcome(message.about);
    else if (message.kind === 'new-model') this.events.newModel(message.hash);
    else if (this.queue[0] !== undefined) this.answer(this.queue[0], message);
  }

  private answer(sending: Sending, message: protocol.FromServer): void {
    if (message.kind === 'begun') {
      const from = sending.flight.pieces.findIndex((piece) => piece.to > message.committed);
      sending.pieces = from === -1 ? sending.flight.pieces.length : from;
      this.flush();
    } else if (message.kind === 'finished') {
      this.drop(sending.flight);
      this.events.stored(Number(message.episode), protocol.toHex(sending.flight.key));
    } else if (message.kind === 'refused') {
      this.drop(sending.flight);
      this.refuse(sending.flight, message.reason);
    }
  }

  private refuse(flight: Pending, reason: string): void {
    if (this.events.refused === undefined) this.events.trouble(`The flight was not stored: ${reason}`);
    else this.events.refused(reason, protocol.toHex(flight.key));
  }

  /** Lets go of a flight and announces the next. */
  private drop(flight: Pending): void {
    const index = this.queue.findIndex((sending) => sending.flight === flight);
    if (index >= 0) this.queue.splice(index, 1);
    if (flight === this.flying) this.flying = null;
    this.tell();
    if (index === 0) this.announce();
  }

  private tell(): void {
    const flights = this.queue.map((sending) => sending.flight);
    if (this.place !== null) keepPending(flights, this.place);
    this.events.state(this.socket !== null, flights.filter((flight) => flight !== this.flying).length);
  }

  private announce(): void {
    const flight = this.queue[0]?.flight;
    if (flight === undefined) return;
    this.send(protocol.begin(flight.key, Math.max(Date.now() - flight.begunAt, 0), flight.setup));
  }

  private flush(): void {
    const first = this.queue[0];
    if (first === undefined || first.pieces === null || this.socket === null) return;
    const { flight } = first;
    for (; first.pieces < flight.pieces.length; first.pieces += 1)
      this.send(protocol.chunk(flight.pieces[first.pieces]!));
    if (flight.end !== null && !first.end) {
      first.end = true;
      this.send(protocol.end(flight.end.ticks, flight.end.ending, flight.end.digests));
    }
  }

  private send(bytes: Uint8Array): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(bytes as Uint8Array<ArrayBuffer>);
  }
}

function fresh(flight: Pending): Sending {
  return { flight, pieces: null, end: false, breaks: 0 };
}
