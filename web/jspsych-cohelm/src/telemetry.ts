// What a flight's data say of how it went on this machine: docs/participant-page.md has each name, its meaning and unit.

import { summary, type Measured } from '../../src/meter';
import type { LoggedKey } from '../../src/record';

/** The page's clock minus the server's, and the way there and back by which that was measured, ms. */
export interface ClockOffset {
  offset_ms: number;
  rtt_ms: number;
}

export interface Telemetry {
  ticks: number;
  late_ticks: number;
  frames: number;
  dropped_frames: number;
  hidden_ms: number;
  pauses: number;
  paused_ms: number;
  interruptions: number;
  away_ms: number;
  clock_offset_ms: number | null;
  clock_rtt_ms: number | null;
  presses: number;
  latency_ms: number | null;
  latency_p95_ms: number | null;
  latency_most_ms: number | null;
  inputs: Measured['inputs'];
  remapped: boolean;
  refresh_hz: number | null;
}

/** Facts about the page, the same for all its flights. */
export interface Machine {
  clock: ClockOffset | null;
  refreshHz: number | null;
  remapped: boolean;
}

export function telemetry(ticks: number, log: LoggedKey[], measured: Measured, machine: Machine): Telemetry {
  const { key_to_tick_ms, ...rest } = measured;
  const latency = summary(key_to_tick_ms);
  return {
    ticks,
    ...rest,
    hidden_ms: Math.round(rest.hidden_ms),
    paused_ms: Math.round(rest.paused_ms),
    clock_offset_ms: machine.clock?.offset_ms ?? null,
    clock_rtt_ms: machine.clock?.rtt_ms ?? null,
    presses: presses(log),
    latency_ms: latency?.median ?? null,
    latency_p95_ms: latency?.p95 ?? null,
    latency_most_ms: latency?.most ?? null,
    remapped: machine.remapped,
    refresh_hz: machine.refreshHz,
  };
}

/** Controls that were pressed; a stick counts once when it leaves its rest. */
function presses(log: LoggedKey[]): number {
  let [count, atRest] = [0, true];
  for (const event of log) {
    const isPush = event.kind === 'stick' && event.stick.some((axis) => axis !== 0);
    if (event.kind === 'down' || (isPush && atRest)) count += 1;
    atRest = event.kind === 'stick' || event.kind === 'release-all' ? !isPush : atRest;
  }
  return count;
}
