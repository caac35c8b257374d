// A flight as a trial of jsPsych.

import { ParameterType, type JsPsych, type JsPsychPlugin, type PluginInfo } from 'jspsych';
import type { Control, Setup } from '../../src/core';
import type { KeyLog } from '../../src/flight';
import { version } from '../package.json';
import type { Deck } from './deck';
import { FlightShow, type Flown, type PlanEvents } from './show';
import { telemetry, type Machine, type Telemetry } from './telemetry';
import { ENGLISH, type FlightWords } from './words';

const info = {
  name: 'cohelm-flight',
  version,
  parameters: {
    /** Gives the page's `Deck`, which all its flights share. */
    deck: { type: ParameterType.FUNCTION, default: undefined },
    /** What is flown: plant, seed, rule, models. The fields are those of a record's setup. */
    setup: { type: ParameterType.OBJECT, default: undefined },
    /** 32 hexadecimal digits that name the flight; the same key goes on with the same flight. Null: a random one. */
    flight_key: { type: ParameterType.STRING, default: null },
    /** What this flight is called, such as "Practice 3 of 10". */
    heading: { type: ParameterType.STRING, default: '' },
    /** What the person is told of the mode; never the rule's name, if they are not to know it. */
    label: { type: ParameterType.STRING, default: '' },
    /** Whether it is said how the flight ended. */
    feedback: { type: ParameterType.BOOL, default: true },
    /** What is said, if not English. */
    words: { type: ParameterType.OBJECT, default: ENGLISH },
    /** Gives the controls with the keys that the person chose. */
    bind: { type: ParameterType.FUNCTION, default: (controls: Control[]) => controls },
    /** Asks the server what it committed of this flight: a promise of a key log, or of null. */
    committed: { type: ParameterType.FUNCTION, default: () => Promise.resolve(null) },
    /** Facts about the page for the telemetry: clock, refresh rate, whether keys were remapped. */
    machine: { type: ParameterType.FUNCTION, default: () => ({ clock: null, refreshHz: null, remapped: false }) },
    /** Told when the flight begins, goes on after an interruption, and comes into the air or leaves it. */
    events: { type: ParameterType.OBJECT, default: {} },
    /** Given the flight's view, so that somebody else can hold it: `(show) => …`. */
    on_show: { type: ParameterType.FUNCTION, default: () => {} },
  },
  data: {
    /** What the flight was begun with. */
    flight_key: { type: ParameterType.STRING },
    /** Number of the episode in the server's database; null if the server refused it. */
    episode: { type: ParameterType.INT },
    /** Why it was refused; null if it was not. */
    refused: { type: ParameterType.STRING },
    /** goal, elsewhere, crash, out-of-bounds or time-limit. */
    ending: { type: ParameterType.STRING },
    /** Ticks flown. */
    ticks: { type: ParameterType.INT },
    /** How it went on this machine. */
    telemetry: { type: ParameterType.OBJECT },
  },
} satisfies PluginInfo;

/** What a trial of this plugin takes. */
export interface FlightTrial {
  deck: () => Deck;
  setup: Setup;
  flight_key: string | null;
  heading: string;
  label: string;
  feedback: boolean;
  words: FlightWords;
  bind: (controls: Control[]) => Control[];
  committed: () => Promise<KeyLog | null>;
  machine: () => Machine;
  events: PlanEvents;
  on_show: (show: FlightShow) => void;
}

/** What a trial of this plugin gives. */
export interface FlightResult {
  flight_key: string;
  episode: number | null;
  refused: string | null;
  ending: string;
  ticks: number;
  telemetry: Telemetry;
}

/** Flies one flight; the server has it when the trial is over. */
export class CohelmFlightPlugin implements JsPsychPlugin<typeof info> {
  static readonly info = info;

  constructor(private readonly jsPsych: JsPsych) {}

  trial(display: HTMLElement, trial: unknown, on_load?: () => void): void {
    const wanted = trial as FlightTrial;
    const { refreshHz } = wanted.machine();
    const show = new FlightShow(wanted.deck(), {
      setup: wanted.setup,
      key: wanted.flight_key,
      heading: wanted.heading,
      label: wanted.label,
      feedback: wanted.feedback,
      words: wanted.words,
      bind: wanted.bind,
      committed: wanted.committed,
      frameMs: refreshHz === null ? undefined : 1000 / refreshHz,
      events: wanted.events,
    });
    display.replaceChildren(show.node);
    wanted.on_show(show);
    on_load?.();
    void show.fly().then((flown) => this.jsPsych.finishTrial(resultOf(flown, wanted.machine())));
  }
}

function resultOf(flown: Flown, machine: Machine): FlightResult & Record<string, unknown> {
  const { key, ending, ticks, log, measured, delivery } = flown;
  return {
    flight_key: key,
    episode: 'episode' in delivery ? delivery.episode : null,
    refused: 'refused' in delivery ? delivery.refused : null,
    ending,
    ticks,
    telemetry: telemetry(ticks, log, measured, machine),
  };
}
