// What a flight says, in English; hand in others for another language.

import type { Ending } from '../../src/core';
import { CANVAS, directionOf, DRAG, ENDING_HINTS, ENDINGS } from '../../src/words';

export const ENGLISH = {
  canvas: CANVAS,
  tilt: 'tilt',
  away: 'away',
  own: 'YOUR GOAL',
  ready: 'Ready to fly',
  task: 'Come to rest at your goal: the amber one, marked ★.',
  drag: DRAG,
  start: 'Start',
  paused: 'Paused',
  pausedText: 'All keys were released; the time stands still.',
  goOn: 'Go on',
  interrupted: 'Welcome back',
  interruptedText: 'Your flight was interrupted. It goes on exactly where you left it, after a countdown.',
  loading: 'Getting ready',
  loadingText: 'The flight is being prepared.',
  unable: 'Not ready to fly',
  again: 'Try again',
  finished: 'Flight finished',
  saving: 'Saving the flight …',
  kept: 'There is no connection at the moment. Your flight is kept in this browser and is sent as soon as there is one.',
  refused: 'This flight could not be stored',
  refusedText: 'That is no fault of yours. Please fly it once more.',
  next: 'Next',
  seconds: (seconds: number) => `${seconds.toFixed(1)} s under way`,
  endings: ENDINGS as Record<Ending, string>,
  hints: ENDING_HINTS as Record<Ending, string>,
  /** Names of controls that the plant gives in English. */
  control: directionOf,
};

export type FlightWords = typeof ENGLISH;
