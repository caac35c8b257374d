// What the server says of a participant's session, as `GET /api/session` answers it. Texts come in their language.

import type { Ending, Setup } from '../core';

export type Status = 'invited' | 'under-way' | 'completed' | 'excluded' | 'withdrawn' | 'declined';

/** A session as `GET /api/session` answers it. */
export interface Session {
  study: { title: string; languages: string[]; contact: string };
  participant: { code: string; test: boolean; simulated: boolean; language: string };
  status: Status;
  /** Steps that are done, and how many there are. */
  place: number;
  total: number;
  minutes_left: number | null;
  /** What remains, the current step first. */
  steps: Step[];
  /** Where someone goes back to whose study ended before its last step. */
  return_address?: string | null;
  /** Questions of the quiz that the last answers got wrong. */
  wrong?: string[];
  /** The server's clock, ms since 1970. */
  server_ms: number;
}

interface Named<Kind extends string> {
  id: string;
  kind: Kind;
}

export interface ConsentStep extends Named<'consent'> {
  version: string;
  text: string;
  minutes: number | null;
  contact: string;
}

export interface DeviceStep extends Named<'device'> {
  /** Whether a device that cannot keep up may not go on. */
  refuse: boolean;
}

export interface FormStep extends Named<'form'> {
  title: string;
  items: Item[];
}

export interface InstructionsStep extends Named<'instructions'> {
  pages: { title: string; text: string; picture: 'controls' | 'task' | null }[];
}

export interface QuizStep extends Named<'quiz'> {
  questions: { id: string; text: string; choices: Choice[]; hint: string }[];
  attempts: number;
}

export interface BlockStep extends Named<'block'> {
  label: string;
  text: string;
  practice: number;
  measured: number;
}

export interface FlightStep extends Named<'flight'> {
  label: string;
  practice: boolean;
  number: number;
  of: number;
  block: number;
  setup: Setup;
  flight_key: string;
  attempt: number;
  feedback: boolean;
  flown: Ending | null;
  committed_ticks: number;
}

export interface BreakStep extends Named<'break'> {
  text: string;
  at_least_s: number;
  at_most_s: number | null;
}

export interface QuestionnaireStep extends Named<'questionnaire'> {
  instrument: string;
  title: string;
  intro: string;
  items: Item[];
}

export interface DebriefStep extends Named<'debrief'> {
  text: string;
  contact: string;
}

export interface ThanksStep extends Named<'thanks'> {
  code: string | null;
  return_address: string | null;
  button: string;
  text: string;
  contact: string;
}

export type Step =
  | ConsentStep
  | DeviceStep
  | FormStep
  | InstructionsStep
  | QuizStep
  | BlockStep
  | FlightStep
  | BreakStep
  | QuestionnaireStep
  | DebriefStep
  | ThanksStep;

export interface Choice {
  value: string;
  text: string;
}

interface Question<Kind extends string> {
  id: string;
  kind: Kind;
  text: string;
  required: boolean;
}

export interface ScaleItem extends Question<'scale'> {
  least: number;
  most: number;
  step: number;
  left: string;
  right: string;
  /** A word for every point, or none. */
  labels: string[];
}

export interface ChoiceItem extends Question<'choice'> {
  choices: Choice[];
}

export interface ManyItem extends Question<'many'> {
  choices: Choice[];
}

export interface NumberItem extends Question<'number'> {
  least: number | null;
  most: number | null;
  unit: string | null;
}

export interface TextItem extends Question<'text'> {
  most_chars: number;
}

export type Item = ScaleItem | ChoiceItem | ManyItem | NumberItem | TextItem;

/** What was answered to an item; null if nothing. */
export type Answer = number | string | string[] | null;

/** Why the server does not take an answer. */
export type Problem = 'missing' | 'wrong-kind' | 'out-of-range' | 'no-choice' | 'too-long' | 'no-item';
