// Flights that ended before the server had all of them, kept over a reload of the page.

import type { Ending, Setup } from './core';
import { toHex, type Piece } from './protocol';

/** A flight the server does not have yet. */
export interface Pending {
  key: Uint8Array;
  /** When it began, ms since 1970. */
  begunAt: number;
  setup: Setup;
  pieces: Piece[];
  end: { ticks: number; ending: Ending; digests: { plant: string; decisions: string } } | null;
}

/** Where they are kept, if nobody says otherwise. */
export const PENDING_PLACE = 'cohelm.flights.1';
/** Most flights that are kept: a flight takes some kilobytes, and browsers give a page five megabytes. */
const MOST = 200;

/** Keeps the finished ones of these flights; the newest, if they are too many. */
export function keepPending(flights: Pending[], place: string): void {
  const finished = flights.filter((flight) => flight.end !== null).slice(-MOST);
  try {
    if (finished.length === 0) localStorage.removeItem(place);
    else
      localStorage.setItem(
        place,
        JSON.stringify(finished, (_, value: unknown) => (value instanceof Uint8Array ? toHex(value) : value)),
      );
  } catch {
    // A browser that keeps nothing still delivers what this page holds.
  }
}

/** What was kept; nothing if it cannot be read. */
export function keptPending(place: string): Pending[] {
  try {
    type Kept = Omit<Pending, 'key' | 'pieces'> & {
      key: string;
      pieces: (Omit<Piece, 'events'> & { events: string })[];
    };
    const kept = JSON.parse(localStorage.getItem(place) ?? '[]') as Kept[];
    return kept.map((flight) => ({
      ...flight,
      key: fromHex(flight.key),
      pieces: flight.pieces.map((piece) => ({ ...piece, events: fromHex(piece.events) })),
    }));
  } catch {
    return [];
  }
}

/** The bytes of hexadecimal digits. */
export function fromHex(digits: string): Uint8Array {
  return Uint8Array.from(digits.match(/../g) ?? [], (pair) => Number.parseInt(pair, 16));
}
