// The flight in the air, kept in this browser: what a reload, a closed lid or an empty battery interrupts goes on later.

import { fromHex } from '../../src/pending';
import { toHex } from '../../src/protocol';
import type { KeyLog } from '../../src/flight';
import type { Measured } from '../../src/meter';

/** What is kept of a flight. */
export interface KeptFlight extends KeyLog {
  /** When it began, ms since 1970. */
  begunAt: number;
  /** When it was kept, ms since 1970. */
  keptAt: number;
  /** Why the page was left, if that was seen. */
  left?: string;
  measured: Measured;
}

/** Most flights that are kept; one is in the air at a time, but people may share a browser. */
const MOST = 20;

/** What a keeper needs of `localStorage`. */
export type Shelf = Pick<Storage, 'getItem' | 'setItem' | 'removeItem' | 'key' | 'length'>;

/** Keeps flights by their keys. A browser that keeps nothing still flies: then the server's log is what is left. */
export class Keeper {
  constructor(
    private readonly shelf: Shelf | null = shelfOfBrowser(),
    private readonly place = 'cohelm.flight.1.',
  ) {}

  keep(key: string, flight: KeptFlight): void {
    try {
      const place = this.place + key;
      if (this.shelf?.getItem(place) === null) this.makeRoom();
      this.shelf?.setItem(place, JSON.stringify({ ...flight, events: toHex(flight.events) }));
    } catch {
      // Full, or forbidden.
    }
  }

  kept(key: string): KeptFlight | null {
    return this.read(this.place + key);
  }

  forget(key: string): void {
    try {
      this.shelf?.removeItem(this.place + key);
    } catch {
      // What cannot be removed was not kept.
    }
  }

  private read(place: string): KeptFlight | null {
    try {
      const kept = JSON.parse(this.shelf?.getItem(place) ?? 'null') as (KeptFlight & { events: string }) | null;
      const isFlight = kept !== null && Number.isInteger(kept.ticks) && Array.isArray(kept.measured.key_to_tick_ms);
      return isFlight ? { ...kept, events: fromHex(kept.events as string) } : null;
    } catch {
      return null;
    }
  }

  /** Lets the oldest go. */
  private makeRoom(): void {
    const { shelf } = this;
    if (shelf === null) return;
    const places = Array.from({ length: shelf.length }, (_, i) => shelf.key(i) ?? '').filter((place) =>
      place.startsWith(this.place),
    );
    const byAge = places.sort((a, b) => (this.read(b)?.keptAt ?? 0) - (this.read(a)?.keptAt ?? 0));
    byAge.slice(MOST - 1).forEach((place) => shelf.removeItem(place));
  }
}

function shelfOfBrowser(): Shelf | null {
  try {
    return localStorage;
  } catch {
    return null;
  }
}
