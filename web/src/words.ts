// All that the page says, in one place a language.

import type { Ending } from './core';

export const ENDINGS: Record<Ending, string> = {
  goal: 'Landed at your flags',
  elsewhere: 'Landed, but somewhere else',
  crash: 'Crashed',
  'out-of-bounds': 'Flew out of bounds',
  'time-limit': 'Out of time',
  abandoned: 'Stopped',
};

export const ENDING_WORDS: Record<Ending, string> = {
  goal: 'at the goal',
  elsewhere: 'elsewhere',
  crash: 'crashed',
  'out-of-bounds': 'out of bounds',
  'time-limit': 'time limit',
  abandoned: 'stopped',
};
