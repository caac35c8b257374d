// The study as jsPsych runs it. The timeline is a loop over one question: what does the server say comes next? So
// whatever happens meanwhile (a reload, a step done elsewhere, an exclusion), what is rendered is what remains.

import type { JsPsych, JsPsychPlugin, PluginInfo } from 'jspsych';
import { ParameterType } from 'jspsych';
import {
  CohelmFlightPlugin,
  telemetry,
  type ComeBack,
  type FlightResult,
  type FlightShow,
  type Machine,
} from '../../jspsych-cohelm/src';
import { keyEvents } from '../record';
import { consent } from './screens/consent';
import { device } from './screens/device';
import { form } from './screens/form';
import { instructions } from './screens/instructions';
import { block, debrief, pause, thanks } from './screens/plain';
import { quiz } from './screens/quiz';
import { SessionClosed } from './place';
import type { FlightStep, Step } from './steps';
import type { Screen, Study } from './study';

/** Runs everything that remains; it is over when nothing does. */
export async function runTimeline(
  jsPsych: JsPsych,
  study: Study,
  shows: (show: FlightShow | null) => void,
): Promise<void> {
  const current = () => study.place.session.steps[0];
  const isUnderWay = () => current() !== undefined;
  if (!isUnderWay()) return;
  const trials = [
    screen('consent', consent, study),
    screen('device', device, study),
    screen('form', form, study),
    screen('instructions', instructions, study),
    screen('quiz', quiz, study),
    screen('block', block, study),
    screen('break', pause, study),
    screen('questionnaire', form, study),
    screen('debrief', debrief, study),
    screen('thanks', thanks, study),
    { timeline: [flight(study, shows)], conditional_function: () => isToBeFlown(current()) },
    screen('flight', noteFlown, study, (step) => !isToBeFlown(step)),
  ];
  await jsPsych.run([{ timeline: trials, loop_function: isUnderWay }]);
}

/** A step that one screen shows, as a trial that runs while the server says that this kind is next. */
function screen<Kind extends Step['kind']>(
  kind: Kind,
  show: Screen<Kind>,
  study: Study,
  also: (step: Step) => boolean = () => true,
) {
  const current = () => study.place.session.steps[0];
  const show_step = async (root: HTMLElement) => show(root, current() as Extract<Step, { kind: Kind }>, study);
  // A session that is closed is spoken of by the page; the trial is never over.
  const on_failure = (error: unknown) => {
    if (!(error instanceof SessionClosed)) study.failed(error);
  };
  return {
    timeline: [{ type: ScreenPlugin, show_step, on_failure, data: () => ({ step: current()?.id ?? null }) }],
    conditional_function: () => current()?.kind === kind && also(current()!),
  };
}

const info = {
  name: 'cohelm-screen',
  version: '0.1.0',
  parameters: {
    /** Shows the step in an element and is over when the server has its answer. */
    show_step: { type: ParameterType.FUNCTION, default: undefined },
    /** Is told why a step could not be shown to its end. */
    on_failure: { type: ParameterType.FUNCTION, default: undefined },
  },
  data: {
    /** Id of the step. */
    step: { type: ParameterType.STRING },
  },
} satisfies PluginInfo;

/** A screen of the study as a trial. */
class ScreenPlugin implements JsPsychPlugin<typeof info> {
  static readonly info = info;

  constructor(private readonly jsPsych: JsPsych) {}

  trial(display: HTMLElement, trial: { show_step?: unknown; on_failure?: unknown }): void {
    const show = trial.show_step as (root: HTMLElement) => Promise<void>;
    const failed = trial.on_failure as (error: unknown) => void;
    show(display).then(() => this.jsPsych.finishTrial({}), failed);
  }
}

function isToBeFlown(step: Step | undefined): boolean {
  return step?.kind === 'flight' && step.flown === null;
}

/** The flight that is next. */
function flight(study: Study, shows: (show: FlightShow | null) => void) {
  const { place, words, keys, deck } = study;
  const step = () => place.session.steps[0] as FlightStep;
  const tell = (news: Parameters<typeof place.tell>[1]) => place.tell(step().flight_key, news);
  const begun = () => tell({ begun: { clock_offset_ms: place.clock?.offset_ms ?? null } });
  return {
    type: CohelmFlightPlugin,
    deck: () => deck,
    setup: () => step().setup,
    flight_key: () => step().flight_key,
    label: () => step().label,
    heading: () => headingOf(step(), study),
    feedback: () => step().feedback,
    words: words.flight,
    bind: keys.bind,
    committed: () => (step().committed_ticks > 0 ? place.committed(step().flight_key) : Promise.resolve(null)),
    machine: () => machineOf(study),
    events: {
      begun,
      resumed: ({ tick, reason, source, awayMs }: ComeBack) =>
        tell({ interrupted: { tick, reason }, resumed: { tick, source, away_ms: awayMs } }),
      inTheAir: (flying: boolean) => study.inTheAir(flying),
    },
    on_show: shows,
    on_finish: async (result: FlightResult) => {
      shows(null);
      if (result.refused !== null) await place.refresh();
      else await note(study, step(), result.telemetry);
    },
  };
}

function headingOf({ practice, number, of }: FlightStep, { words }: Study): string {
  return (practice ? words.flightOf.practice : words.flightOf.measured)(number, of);
}

function machineOf({ place, refreshHz, keys }: Study): Machine {
  return { clock: place.clock, refreshHz, remapped: keys.isInUse };
}

async function note(study: Study, step: FlightStep, data: unknown): Promise<void> {
  await study.place.answer(step.id, data, 0);
  study.deck.keeper.forget(step.flight_key);
}

/** A flight that the server has, but not how it went: the page was left in between. */
const noteFlown: Screen<'flight'> = async (_, step, study) => {
  const kept = study.deck.keeper.kept(step.flight_key);
  const measured = kept === null ? {} : telemetry(kept.ticks, keyEvents(kept.events), kept.measured, machineOf(study));
  await note(study, step, measured);
};
