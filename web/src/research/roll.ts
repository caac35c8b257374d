// Which participants are shown, and in which order; who left, and who has gone quiet.

import type { Row, Status } from './deskapi';

/** Who was not seen for so long without having finished counts as quiet, ms. */
export const QUIET_MS = 30 * 60_000;

export interface Filter {
  /** Part of a code. */
  code: string;
  status: Status | 'all' | 'here';
  /** Tests and bots too. */
  others: boolean;
}

/** The rows that a filter lets through: who is in the air, then who is here, then the newest. */
export function filtered(rows: Row[], { code, status, others }: Filter): Row[] {
  const fits = (row: Row) =>
    row.code.toLowerCase().includes(code.trim().toLowerCase()) &&
    (others || (!row.test && !row.simulated)) &&
    (status === 'all' || (status === 'here' ? row.connected : row.status === status));
  const rank = ({ in_air, connected }: Row) => (in_air !== null ? 2 : connected ? 1 : 0);
  return rows.filter(fits).sort((a, b) => rank(b) - rank(a) || b.id - a.id);
}

export function isGone({ status }: Row): boolean {
  return status === 'excluded' || status === 'withdrawn' || status === 'declined';
}

/** Under way, but not seen for a while. */
export function isQuiet({ status, connected, last_seen_ms }: Row, now_ms: number): boolean {
  return status === 'under-way' && !connected && last_seen_ms !== null && now_ms - last_seen_ms > QUIET_MS;
}
