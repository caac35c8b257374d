// What the server is asked over HTTP.

import type { Ending, Setup } from './core';

/** A model the server has. */
export interface ModelEntry {
  hash: string;
  kind: 'values' | 'intent';
  card: {
    name: string;
    variant: string | null;
    task: { plant: string; options: Record<string, unknown> };
    plant_version: number;
    [more: string]: unknown;
  };
}

/** A row of the list of episodes. */
export interface EpisodeEntry {
  id: number | string;
  started_at: string | number;
  plant: string;
  rule: string;
  pilot: string;
  seed: number;
  ending: Ending;
  ticks: number;
  time_scale: number;
  [more: string]: unknown;
}

/** The server answered something else than what was asked for; the message is its own. */
export class ApiError extends Error {}

async function get(path: string): Promise<Response> {
  const response = await fetch(path, { headers: { accept: 'application/json, */*' } });
  if (!response.ok) throw new ApiError(`${path}: ${response.status} ${(await response.text()).slice(0, 300)}`);
  return response;
}

export async function listModels(): Promise<ModelEntry[]> {
  const answer = (await (await get('/api/models')).json()) as { models: ModelEntry[] } | ModelEntry[];
  return Array.isArray(answer) ? answer : answer.models;
}

export async function modelBytes(hash: string): Promise<Uint8Array> {
  return new Uint8Array(await (await get(`/api/models/${hash}`)).arrayBuffer());
}

export async function listEpisodes(): Promise<EpisodeEntry[]> {
  const answer = (await (await get('/api/episodes')).json()) as { episodes: EpisodeEntry[] } | EpisodeEntry[];
  return Array.isArray(answer) ? answer : answer.episodes;
}

export async function episodeBytes(id: number | string): Promise<Uint8Array> {
  return new Uint8Array(await (await get(`/api/episodes/${id}`)).arrayBuffer());
}

/** The co-pilot for a task: the newest usual models made for that plant with those actions. */
export function chooseModels(models: ModelEntry[], task: Setup['task']): { values: string | null; intent: string | null } {
  const actions = (options: Record<string, unknown>) => options['actions'] ?? 'switches';
  const fits = (model: ModelEntry) =>
    model.card.variant === null && model.card.task.plant === task.plant &&
    actions(model.card.task.options) === actions(task.options);
  const newest = (kind: ModelEntry['kind']) => models.filter((model) => model.kind === kind && fits(model)).at(-1)?.hash ?? null;
  return { values: newest('values'), intent: newest('intent') };
}
