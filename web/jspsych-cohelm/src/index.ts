// Flights in a jsPsych experiment. The README beside this folder shows one from its first line to its data.

import '../../src/flight.css';

export { Deck, type DeckOptions, type Delivery } from './deck';
export { Keeper, type KeptFlight, type Shelf } from './keeper';
export { CohelmFlightPlugin, CohelmFlightPlugin as default, type FlightResult, type FlightTrial } from './plugin';
export { longer, readCommitted, type Source } from './resume';
export { FlightShow, type ComeBack, type Flown, type Plan, type PlanEvents } from './show';
export { telemetry, type ClockOffset, type Machine, type Telemetry } from './telemetry';
export { ENGLISH, type FlightWords } from './words';
export type { Control, Ending, Inference, Rule, Setup } from '../../src/core';
export type { KeyLog } from '../../src/flight';
