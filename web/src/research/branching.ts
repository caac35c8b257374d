// What if: a recording that goes another way from one of its ticks on, and how far apart the two ways are.

import type { Core, Ending, Opening, Pose, Tick, Wish } from '../core';
import { History } from '../history';
import type { Recording } from '../replay';

/** Most ticks that a branch is flown for: ten minutes at fifty a second. A plant without a time limit would go on for ever. */
const MOST_TICKS = 30_000;
/** How long the page may be kept busy before it draws again, ms. */
const BUSY_MS = 24;
/** How long an open loop means anything, s: a person would have answered by then. */
export const MEANINGFUL_S = 1;

/** A branch as a recording of its own, the ticks before it as they were recorded. */
export interface Branch extends Recording {
  wish: Wish;
  /** Ticks from the branch until something else was carried out than in the record; null if nothing was, as far as that goes. */
  differsAfter: number | null;
  ending: Ending;
  /** Ticks of the record: after them nobody asks, if the recorded keys go on. */
  keysEnd: number;
}

/** Flies a branch to its end; null if `goOn` said no in between. `core` watches the same record as `original`. */
export async function flyBranch(
  core: Core,
  original: Recording,
  wish: Wish,
  goOn: () => boolean,
): Promise<Branch | null> {
  const opening: Opening = { ...original.opening, setup: core.branch(wish).setup };
  const ticks: Tick[] = [];
  let busySince = performance.now();
  for (let tick = core.tick(); tick !== null && ticks.length < MOST_TICKS; tick = core.tick()) {
    ticks.push(tick);
    if (performance.now() - busySince > BUSY_MS) {
      await new Promise((resume) => setTimeout(resume));
      if (!goOn()) return null;
      busySince = performance.now();
    }
  }
  const { at } = wish;
  const history = new History();
  history.outcomes.push(...original.history.outcomes.slice(0, at));
  history.confidences.push(...original.history.confidences.slice(0, at));
  ticks.forEach((tick) => history.push(tick));
  const posesAt = (tick: number): Pose[] => (tick <= at ? original.posesAt(tick) : ticks[tick - at - 1]!.poses);
  const tickAt = (tick: number) => (tick <= at ? original.tickAt(tick) : ticks[tick - at - 1]!);
  return {
    opening,
    history,
    length: at + ticks.length,
    differing: 0,
    posesAt,
    tickAt,
    wish,
    differsAfter: firstDifference(ticks, original, at),
    ending: ticks.at(-1)?.ending ?? 'abandoned',
    keysEnd: original.length,
  };
}

/** Reads the original once through, which is as quick as flying it: what was carried out is not kept elsewhere. */
function firstDifference(ticks: Tick[], original: Recording, at: number): number | null {
  const both = Math.min(ticks.length, original.length - at);
  for (let i = 0; i < both; i += 1) {
    const recorded = original.tickAt(at + i + 1)?.executed ?? null;
    if (JSON.stringify(recorded) !== JSON.stringify(ticks[i]!.executed)) return i;
  }
  return null;
}

/** How far apart the crafts are after each tick, world units, as long as both fly. */
export function apart(original: Recording, branch: Recording, part: number): number[] {
  const both = Math.min(original.length, branch.length);
  return Array.from({ length: both + 1 }, (_, tick) => {
    const [a, b] = [original.posesAt(tick)[part], branch.posesAt(tick)[part]];
    return a === undefined || b === undefined ? 0 : Math.hypot(a.x - b.x, a.y - b.y);
  });
}
