// A flight in the air, flown again here from its key log: the same loop, the same bits.

import type { Core, Ending, Opening, Pose, Setup, Tick } from '../core';
import { History } from '../history';
import type { Piece } from '../protocol';
import { readKeys } from './wire';

/** A flight that follows another. */
export class Following {
  readonly opening: Opening;
  readonly history = new History();
  /** Every tick, from the first. */
  readonly ticks: Tick[] = [];
  /** How it ended, once that is known. */
  ending: Ending | null = null;
  /** False once a piece gave other bits than the page that flies. */
  exact = true;

  /** `core` is a loop that nobody else uses meanwhile, with the models of the setup. */
  constructor(
    private readonly core: Core,
    setup: Setup,
  ) {
    this.opening = core.begin(setup);
  }

  /** Flies a piece of the log. Pieces may come twice and may overlap; one that leaves a gap is refused. */
  take({ from, to, events, digests }: Piece): void {
    if (from > this.ticks.length) throw new Error(`ticks ${this.ticks.length} to ${from} of the flight are missing`);
    const keys = readKeys(events).filter((key) => key.tick >= this.ticks.length);
    while (this.ticks.length < to) {
      while (keys.length > 0 && keys[0]!.tick <= this.ticks.length) this.change(keys.shift()!);
      const tick = this.core.tick();
      if (tick === null) break;
      this.ticks.push(tick);
      this.history.push(tick);
    }
    const own = this.core.digests();
    this.exact &&= own.ticks === to && own.plant === digests.plant && own.decisions === digests.decisions;
  }

  /** Poses before a tick, or after the last one. */
  posesAt(tick: number): Pose[] {
    return this.ticks[tick - 1]?.poses ?? this.opening.poses;
  }

  private change(key: ReturnType<typeof readKeys>[number]): void {
    if (key.kind === 'stick') this.core.stick(key.axes, key.atMs);
    else this.core.key(key.kind, key.control, key.atMs);
  }
}
