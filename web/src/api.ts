// What the server is asked over HTTP.

import type { Ending, Setup } from './core';

/** A model that the server has stored, as its list has it. */
export interface ModelEntry {
  hash: string;
  kind: 'values' | 'intent';
  name: string;
  plant: string;
  /** Whether it came with this program: what was learned or stored by another version is not offered. */
  offered: boolean;
  card: {
    name: string;
    variant: string | null;
    task: Setup['task'];
    plant_version: number;
    /** Goals that its networks see. */
    goals: number;
    [more: string]: unknown;
  };
}

/** How far an episode is. */
export type Progress =
  { state: 'in-the-air' } | { state: 'finished'; ending: Ending } | { state: 'refused'; reason: string };

/** A row of the list of episodes. */
export type EpisodeEntry = Progress & {
  id: number;
  ticks: number;
  plant: string;
  plant_version: number;
  format: number;
  program: string;
  rule: string;
  seed: number;
  pilot: string;
  time_scale: number;
  values: string | null;
  intent: string | null;
  setup: Setup;
  started_at_ms: number;
  ended_at_ms: number | null;
};

/** How learning stands, if the server learns. */
export type LearningStatus =
  | { learning: false }
  | {
      learning: true;
      plant: string;
      current: string;
      shipped: string;
      kept: string | null;
      learned: number;
      waiting: number;
      left_out: number;
      failure: string | null;
    };

/** The server answered something else than what was asked for, in its own words, or not at all. */
export class ApiError extends Error {}

async function ask(path: string, method: 'GET' | 'POST' = 'GET'): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(path, { method });
  } catch {
    throw new ApiError('the server cannot be reached');
  }
  if (!response.ok) throw new ApiError(await whatIsWrong(response));
  return response;
}

async function whatIsWrong(response: Response): Promise<string> {
  try {
    const said = (await response.json()) as { error?: unknown };
    if (typeof said.error === 'string') return said.error;
  } catch {
    // Words of a stranger, such as a proxy's page, are of no help to anybody here.
  }
  return `the server answered ${response.status} ${response.statusText}`.trim();
}

export async function listModels(): Promise<ModelEntry[]> {
  return ((await (await ask('/api/models')).json()) as { models: ModelEntry[] }).models;
}

export async function modelBytes(hash: string): Promise<Uint8Array> {
  return new Uint8Array(await (await ask(`/api/models/${hash}`)).arrayBuffer());
}

/** A part of the list of episodes, the newest first; `next` is what to ask for as `before`. */
export async function listEpisodes(
  before: number | null = null,
): Promise<{ episodes: EpisodeEntry[]; next: number | null }> {
  const answer = await ask(`/api/episodes${before === null ? '' : `?before=${before}`}`);
  return (await answer.json()) as { episodes: EpisodeEntry[]; next: number | null };
}

export function recordAddress(id: number): string {
  return `/api/episodes/${id}`;
}

export async function episodeBytes(id: number): Promise<Uint8Array> {
  return new Uint8Array(await (await ask(recordAddress(id))).arrayBuffer());
}

export async function learningStatus(): Promise<LearningStatus> {
  return (await (await ask('/api/learn')).json()) as LearningStatus;
}

/** Chooses the values of now for the next start of the server to go on from. */
export async function keepLearned(): Promise<LearningStatus> {
  return (await (await ask('/api/learn/keep', 'POST')).json()) as LearningStatus;
}

/** Goes back to the values that came with the program. */
export async function returnToShipped(): Promise<LearningStatus> {
  return (await (await ask('/api/learn/reset', 'POST')).json()) as LearningStatus;
}
