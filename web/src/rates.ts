// How long a flight was: the server says how many ticks of each plant make a second. A plant elsewhere has a rate of its
// own, which only its records tell, so that its flights are told in ticks.

import type { Setup } from './core';

/** Ticks a second by the plant's name. */
export type Rates = ReadonlyMap<string, number>;

let known: Promise<Rates> | null = null;

/** The rates of all plants that the server flies by itself; none while it does not say. */
export function ratesOfPlants(): Promise<Rates> {
  return (known ??= askRates().catch(() => {
    known = null;
    return new Map<string, number>();
  }));
}

async function askRates(): Promise<Rates> {
  const { plants } = (await (await fetch('/api/plants')).json()) as {
    plants: { name: string; ticks_per_second?: number }[];
  };
  return new Map(plants.flatMap(({ name, ticks_per_second: rate }) => (rate === undefined ? [] : [[name, rate]])));
}

/** Seconds of the world where the plant's rate is known, otherwise ticks. */
export function flownWords(ticks: number, plant: string, rates: Rates): string {
  const rate = rates.get(plant);
  return rate === undefined ? `${ticks} ticks` : `${(ticks / rate).toFixed(1)} s`;
}

/** What a task's plant is called: a plant elsewhere by its own name. */
export function plantWords({ plant, options }: Setup['task']): string {
  const own = options?.['name'];
  return plant === 'external' && typeof own === 'string' ? own : plant;
}
