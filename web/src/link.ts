// The way to the server. Flights go on whatever happens to it: their key logs are kept until the server has them.

import type { Ending, Setup } from './core';
import { say } from './message';
import * as protocol from './protocol';

/** Ms before the first attempt to connect again, and the longest wait between two. */
const [FIRST_WAIT_MS, LONGEST_WAIT_MS] = [500, 8000];

/** A flight the server does not have yet. */
interface Pending {
  key: Uint8Array;
  begunAt: number;
  setup: Setup;
  pieces: protocol.Piece[];
  end: { ticks: number; ending: Ending; digests: { plant: string; decisions: string } } | null;
  /** Pieces sent on this connection; null until the server has said where to go on from. */
  sent: number | null;
  endSent: boolean;
}

/** Sends flights one after the other, and again after a lost connection. */
export class Link {
  /** Told when the server has learnt a new model; the next flight may use it. */
  onNewModel: (() => void) | null = null;
  /** Told the number under which a flight is stored. */
  onStored: ((episode: bigint) => void) | null = null;
  /** What the server said of itself. */
  about: { cohelm: string; learning: boolean } | null = null;
  private socket: WebSocket | null = null;
  private readonly flights: Pending[] = [];
  private flying: Pending | null = null;
  private wait = FIRST_WAIT_MS;

  constructor(private readonly connected: (connected: boolean) => void) {
    this.connect();
  }

  /** A flight begins. */
  begin(setup: Setup): void {
    const key = crypto.getRandomValues(new Uint8Array(16));
    this.flying = { key, begunAt: performance.now(), setup, pieces: [], end: null, sent: null, endSent: false };
    this.flights.push(this.flying);
    if (this.flights.length === 1) this.announce();
  }

  /** A piece of its key log. */
  chunk(from: number, to: number, events: Uint8Array, digests: { plant: string; decisions: string }): void {
    this.flying?.pieces.push({ from, to, events, digests });
    this.flush();
  }

  /** It ended. A flight that ended before its first tick is forgotten. */
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
    this.flush();
  }

  private connect(): void {
    const socket = new WebSocket(`${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/ws`);
    socket.binaryType = 'arraybuffer';
    socket.addEventListener('open', () => {
      this.socket = socket;
      this.wait = FIRST_WAIT_MS;
      this.connected(true);
      for (const flight of this.flights) Object.assign(flight, { sent: null, endSent: false });
      this.announce();
    });
    socket.addEventListener('message', (event) => this.hear(new Uint8Array(event.data as ArrayBuffer)));
    socket.addEventListener('close', (event) => {
      this.socket = null;
      this.connected(false);
      if (event.reason !== '' && event.code !== 1001) say(`The server closed the connection: ${event.reason}`);
      setTimeout(() => this.connect(), this.wait);
      this.wait = Math.min(this.wait * 2, LONGEST_WAIT_MS);
    });
  }

  private hear(bytes: Uint8Array): void {
    const message = protocol.read(bytes);
    if (message === null) return;
    const flight = this.flights[0];
    if (message.kind === 'welcome') this.about = message.about;
    else if (message.kind === 'new-model') this.onNewModel?.();
    else if (flight === undefined) return;
    else if (message.kind === 'begun') {
      const from = flight.pieces.findIndex((piece) => piece.to > message.committed);
      flight.sent = from === -1 ? flight.pieces.length : from;
      this.flush();
    } else if (message.kind === 'finished') {
      this.onStored?.(message.episode);
      this.drop(flight);
    } else if (message.kind === 'refused') {
      say(`The flight was not stored: ${message.reason}`);
      this.drop(flight);
    }
  }

  /** Lets go of a flight and announces the next. */
  private drop(flight: Pending): void {
    const index = this.flights.indexOf(flight);
    if (index >= 0) this.flights.splice(index, 1);
    if (flight === this.flying) this.flying = null;
    if (index === 0) this.announce();
  }

  private announce(): void {
    const flight = this.flights[0];
    if (flight === undefined) return;
    this.send(protocol.begin(flight.key, Math.round(performance.now() - flight.begunAt), flight.setup));
  }

  private flush(): void {
    const flight = this.flights[0];
    if (flight === undefined || flight.sent === null || this.socket === null) return;
    for (; flight.sent < flight.pieces.length; flight.sent += 1) this.send(protocol.chunk(flight.pieces[flight.sent]!));
    if (flight.end !== null && !flight.endSent) {
      flight.endSent = true;
      this.send(protocol.end(flight.end.ticks, flight.end.ending, flight.end.digests));
    }
  }

  private send(bytes: Uint8Array): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(bytes as Uint8Array<ArrayBuffer>);
  }
}
