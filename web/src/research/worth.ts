// What a branch shows and what it does not, in words: for the moment that is shown, and for all of it.

import type { Recording } from '../replay';
import { boxOf } from '../shapes';
import { apart, MEANINGFUL_S, type Branch } from './branching';

/** A parting of the ways that one can see: so much of the craft's size. */
const SEEN_APART = 0.5;

/** Seconds of the person's time since the branch. */
function sinceBranch({ wish, opening }: Branch, position: number): number {
  return (position - wish.at) / (opening.ticks_per_second * opening.setup.time_scale);
}

/** What the moment shown is worth. */
export function momentWords(branch: Branch, position: number): { words: string; state: string } {
  const since = sinceBranch(branch, Math.min(position, branch.length));
  if (since <= 0) return { words: 'as recorded', state: 'recorded' };
  const at = `+${since.toFixed(2)} s`;
  if (branch.wish.pilot.pilot !== 'recorded') return { words: `${at}, simulated pilot`, state: 'fresh' };
  if (position > branch.keysEnd) return { words: `${at}: the recorded keys are over, nobody asks`, state: 'stale' };
  if (since <= MEANINGFUL_S) return { words: `${at}, open loop`, state: 'fresh' };
  return { words: `${at}: the person would have answered by now`, state: 'stale' };
}

/** In one sentence what the branch shows, and in another what it does not. */
export function whatItSays(original: Recording, branch: Branch): string {
  const { wish, differsAfter, opening } = branch;
  const rate = opening.ticks_per_second * opening.setup.time_scale;
  const parting = partingOf(original, branch);
  const first =
    differsAfter === null
      ? 'Nothing else would have been carried out.'
      : `First other action after ${(differsAfter / rate).toFixed(2)} s; ${
          parting === null
            ? 'the ways never part visibly'
            : `the ways part visibly after ${((parting - wish.at) / rate).toFixed(2)} s`
        }.`;
  if (wish.pilot.pilot === 'recorded') {
    return `${first} An open loop: the keys answer the recorded flight, not this one. Read its first second; what comes later, the ending too, means little.`;
  }
  const who = wish.pilot.pilot === 'person' ? 'A simulated person, not this participant' : 'Not this participant';
  return `${first} ${who}: it shows what could be done from here, not what would have been.`;
}

/** The tick at which the ways are visibly apart; null if they never are. */
function partingOf(original: Recording, branch: Branch): number | null {
  const { movable } = original.opening.scene;
  const body = Math.max(
    movable.findIndex(({ role }) => role === 'body'),
    0,
  );
  const [west, south, east, north] = boxOf(movable[body]?.shapes ?? []);
  const size = Math.max(east - west, north - south);
  const tick = apart(original, branch, body).findIndex((distance) => distance > SEEN_APART * size);
  return tick < 0 ? null : tick;
}
