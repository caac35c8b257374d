// How well this device keeps the pace of a flight: late ticks, the longest gap between two, the display's rate.

import type { Core, Setup } from '../core';
import { FlightRun } from '../flight';
import { Stage } from '../stage';
import { refreshRate } from './refresh';

/** How long is measured, ms. */
const DURATION_MS = 5000;
/** A flight without a pilot comes down soon; before it does another takes its place. */
const TICKS_OF_A_FLIGHT = 60;

export interface Pace {
  ticks: number;
  late_ticks: number;
  worst_gap_ms: number;
  refresh_hz: number;
}

/** Flies and draws as in a flight, with nobody at the keys. */
export async function measurePace(
  core: Core,
  setup: Setup,
  [back, front]: HTMLCanvasElement[],
  progress: (part: number) => void,
): Promise<Pace> {
  const stage = new Stage(back!, front!);
  const [begun, refresh] = [performance.now(), refreshRate(DURATION_MS / 2)];
  const pace: Pace = { ticks: 0, late_ticks: 0, worst_gap_ms: 0, refresh_hz: 60 };
  for (let seed = 1; performance.now() - begun < DURATION_MS; seed += 1) {
    await flight(core, { ...setup, seed }, stage, pace);
    progress((performance.now() - begun) / DURATION_MS);
  }
  return { ...pace, worst_gap_ms: Math.round(pace.worst_gap_ms), refresh_hz: await refresh };
}

function flight(core: Core, setup: Setup, stage: Stage, pace: Pace): Promise<void> {
  return new Promise((resolve, reject) => {
    let last = performance.now();
    const over = () => {
      pace.ticks += run.ticks;
      pace.late_ticks += run.measured().late_ticks;
      run.dispose();
      resolve();
    };
    const run = new FlightRun(
      core,
      setup,
      false,
      stage,
      {
        tick: () => {
          const now = performance.now();
          pace.worst_gap_ms = Math.max(pace.worst_gap_ms, now - last);
          last = now;
          if (run.ticks === TICKS_OF_A_FLIGHT) setTimeout(over);
        },
        paused: () => {},
        ended: over,
        failed: reject,
      },
      null,
      { bind: (controls) => controls.map((control) => ({ ...control, keys: [] })), plain: true },
    );
    run.start();
  });
}
