// What a flight's data say of how it went on this machine: docs/participant-page.md has each name, its meaning and unit.

import { summary, type Measured } from '../../src/meter';

/** The server's clock minus the page's, and the way there and back by which that was measured, ms. */
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
  key_events: number;
  key_to_tick_ms: { median: number; p95: number; most: number } | null;
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

export function telemetry(ticks: number, keyEvents: number, measured: Measured, machine: Machine): Telemetry {
  const { key_to_tick_ms, ...rest } = measured;
  return {
    ticks,
    ...rest,
    hidden_ms: Math.round(rest.hidden_ms),
    paused_ms: Math.round(rest.paused_ms),
    clock_offset_ms: machine.clock?.offset_ms ?? null,
    clock_rtt_ms: machine.clock?.rtt_ms ?? null,
    key_events: keyEvents,
    key_to_tick_ms: summary(key_to_tick_ms),
    remapped: machine.remapped,
    refresh_hz: machine.refreshHz,
  };
}
