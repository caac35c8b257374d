// Where an interrupted flight goes on: from the page's own log or from what the server committed, whichever is longer.

import type { KeyLog } from '../../src/flight';
import { eventsBefore } from '../../src/record';

/** Whose log it was. */
export type Source = 'page' | 'server';

/** The log to go on from, and whose it was; null if neither has a tick. */
export function longer(page: KeyLog | null, server: KeyLog | null): { log: KeyLog; source: Source } | null {
  const [flown, committed] = [page?.ticks ?? 0, server?.ticks ?? 0];
  if (page !== null && flown > 0 && flown >= committed && (server === null || agree(page, server)))
    return { log: page, source: 'page' };
  return server !== null && committed > 0 ? { log: server, source: 'server' } : null;
}

/** Whether two logs say the same as far as both go. What the server committed it will not take back. */
function agree(page: KeyLog, server: KeyLog): boolean {
  const ticks = Math.min(page.ticks, server.ticks);
  const [one, other] = [page, server].map((log) => eventsBefore(log.events, ticks).bytes);
  return one!.length === other!.length && one!.every((byte, i) => byte === other![i]);
}

/** Reads what `GET /api/session/flight/KEY` answers: length of the setup (u32), setup, ticks (u32), events. */
export function readCommitted(bytes: Uint8Array): KeyLog {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const setup = view.getUint32(0, true);
  return { ticks: view.getUint32(4 + setup, true), events: bytes.slice(8 + setup) };
}
