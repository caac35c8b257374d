// What the desk asks the server: docs/study-api.md has every route. Whoever is not let in gets a `NotLetIn`.

import type { EpisodeEntry } from '../api';
import { ApiError } from '../api';
import type { Ending, Rule } from '../core';

export type Status = 'invited' | 'under-way' | 'completed' | 'excluded' | 'withdrawn' | 'declined';

/** A way through the conditions, how many are to take it, and how many have. */
export interface Cell {
  cell: number;
  order: string[];
  planned: number;
  finished: number;
  in_progress: number;
}

export interface StudyReport {
  name: string;
  title: string;
  languages: string[];
  hash: string;
  /** The study's file, as it was given. */
  text: string;
  planned: number;
  /** The design in words. */
  rows: [name: string, words: string][];
  conditions: { name: string; rule: Rule }[];
  cells: Cell[];
  /** Where anybody can join, if the study lets them. */
  open_link: string | null;
  /** People by status, without tests and bots. */
  counts: Partial<Record<Status, number>>;
  tests: number;
  simulated: number;
}

/** A participant as the table has it. */
export interface Row {
  id: number;
  code: string;
  status: Status;
  test: boolean;
  simulated: boolean;
  cell: number | null;
  order: string[];
  place: number;
  total: number;
  step: string | null;
  condition: string | null;
  last_seen_ms: number | null;
  connected: boolean;
  in_air: { episode: number; ticks: number } | null;
  minutes: number | null;
  /** Share of late ticks of each flight. */
  late_ticks: number[];
  interruptions: number;
  endings: Partial<Record<Ending, number>>;
  notes: number;
  /** Rules of exclusion that this participant meets, in words; the researcher decides. */
  breaches: string[];
  excluded: { reason: string; by: string } | null;
}

/** An event of a participant's log. */
export interface Logged {
  seq: number;
  at_ms: number;
  event: string;
  [field: string]: unknown;
}

export type DeskEpisode = EpisodeEntry & {
  participant: number | null;
  code: string | null;
  step: string | null;
  condition: string | null;
};

export interface Created {
  id: number;
  code: string;
  link: string;
}

/** The secret was not given, or is no longer believed. */
export class NotLetIn extends Error {}

async function ask(path: string, body?: unknown): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(`/api/desk/${path}`, body === undefined ? {} : post(body));
  } catch {
    throw new ApiError('the server cannot be reached');
  }
  if (response.status === 401) throw new NotLetIn(await whatIsWrong(response));
  if (!response.ok) throw new ApiError(await whatIsWrong(response));
  return response;
}

function post(body: unknown): RequestInit {
  return {
    method: 'POST',
    headers: { 'content-type': 'application/json', 'x-cohelm-desk': '1' },
    body: JSON.stringify(body),
  };
}

async function whatIsWrong(response: Response): Promise<string> {
  const said = (await response.json().catch(() => null)) as { error?: unknown } | null;
  if (typeof said?.error === 'string') return said.error;
  return `the server answered ${response.status} ${response.statusText}`.trim();
}

const read = async <Answer>(path: string, body?: unknown) => (await (await ask(path, body)).json()) as Answer;

export const login = (secret: string) => ask('login', { secret });
export const logout = () => ask('logout', {});
export const study = () => read<StudyReport>('study');
export const participants = async () => (await read<{ participants: Row[] }>('participants')).participants;
export const log = async (id: number) => (await read<{ events: Logged[] }>(`participants/${id}/log`)).events;

export const create = (wish: { test: boolean; language: string | null; note: string | null }) =>
  read<Created>('participants', wish);
export const newLink = (id: number) => read<Created>(`participants/${id}/link`, {});
export const exclude = (id: number, reason: string) => ask(`participants/${id}/exclude`, { reason });
export const reinstate = (id: number) => ask(`participants/${id}/reinstate`, {});
export const withdraw = (id: number) => ask(`participants/${id}/withdraw`, {});
export const note = (id: number, text: string) => ask(`participants/${id}/note`, { text });

/** Episodes, the newest first; of one participant if one is named. */
export function episodes(
  wish: { participant?: number; before?: number; limit?: number } = {},
): Promise<{ episodes: DeskEpisode[]; next: number | null }> {
  const query = Object.entries(wish).map(([name, value]) => `${name}=${value}`);
  return read(`episodes${query.length > 0 ? `?${query.join('&')}` : ''}`);
}

export async function episodeBytes(id: number): Promise<Uint8Array> {
  return new Uint8Array(await (await ask(`episodes/${id}`)).arrayBuffer());
}
