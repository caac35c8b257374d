// Everything that the participant's page itself says, in English. What a study says comes from its file.

import { ENGLISH } from '../../../jspsych-cohelm/src/words';
import type { Problem } from '../steps';

const count = (many: number, one: string, more: string) => `${many} ${many === 1 ? one : more}`;

export const en = {
  name: 'English',
  code: 'en',
  language: 'Language',
  test: 'Test run',
  simulated: 'Simulated participant',
  progress: 'Progress',
  stepOf: (step: number, of: number) => `Step ${step} of ${of}`,
  minutesLeft: (minutes: number) =>
    minutes < 1.5 ? 'about a minute left' : `about ${count(Math.round(minutes), 'minute', 'minutes')} left`,
  connected: 'Connected',
  offline: 'No connection',
  offlineText: 'Nothing is lost: it is sent as soon as there is a connection again.',
  goOn: 'Continue',
  back: 'Back',
  next: 'Next',
  askUs: (contact: string) => `Questions? Contact: ${contact}`,

  withdraw: {
    open: 'Withdraw',
    title: 'Withdraw from the study?',
    text: 'You may stop at any time and need not say why. If you withdraw, everything that was recorded of you in this study is deleted. This cannot be undone.',
    pause: 'If you only need a break, just close the page: with your link you come back to this place.',
    stay: 'Stay in the study',
    confirm: 'Withdraw and delete my data',
    working: 'Deleting …',
  },

  consent: {
    title: 'Taking part in this study',
    minutes: (minutes: number) => `It takes about ${count(Math.round(minutes), 'minute', 'minutes')}.`,
    version: (version: string) => `Version ${version} of this text.`,
    leave: 'You may stop at any time with “Withdraw” at the top of the page; then your data are deleted.',
    agree: 'I have read and understood this, and I take part of my own free will.',
    start: 'Take part',
    decline: 'I do not take part',
  },

  device: {
    title: 'Is this device fast enough?',
    text: 'The flights need a steady pace. This takes five seconds; please do nothing else on this device meanwhile.',
    start: 'Start the check',
    running: 'Checking …',
    passed: 'This device is fast enough.',
    failed: 'This device does not keep the pace',
    failedText: (late: number) =>
      `${late} of 100 steps came too late. Close other programs and tabs, plug the device in, switch energy saving off, and try again. A computer of the last years with a current Chrome, Edge, Firefox or Safari is fast enough.`,
    refused: 'With this device you cannot take part; with another one your link works as well.',
    again: 'Check again',
    anyway: 'Continue anyway',
    small: 'Your window is rather small. Please make it larger, best full screen.',
    refresh: (hz: number) => `Display: ${Math.round(hz)} pictures a second`,
    pace: (late: number, of: number) => `Steps too late: ${late} of ${of}`,
  },

  form: {
    required: 'Please answer this question.',
    open: (many: number) =>
      many === 1
        ? 'One question is still open. You may leave it open: press “Continue” once more.'
        : `${many} questions are still open. You may leave them open: press “Continue” once more.`,
    missing: (many: number) =>
      many === 1 ? 'One question still needs an answer.' : `${many} questions still need an answer.`,
    optional: 'optional',
    unset: 'not answered yet',
    unsetHint: 'Click on the line',
    of: (value: string, most: string) => `${value} of ${most}`,
    charsLeft: (left: number) => count(left, 'character left', 'characters left'),
    problems: {
      missing: 'Please answer this question.',
      'wrong-kind': 'This answer cannot be read. Please give it again.',
      'out-of-range': 'This number is not possible here.',
      'no-choice': 'Please choose one of the answers.',
      'too-long': 'This answer is too long.',
      'no-item': 'This question is not asked any more.',
    } as Record<Problem, string>,
    between: (least: number | null, most: number | null) =>
      least !== null && most !== null
        ? `A number from ${least} to ${most}.`
        : least !== null
          ? `A number of at least ${least}.`
          : most !== null
            ? `A number of at most ${most}.`
            : 'A number.',
  },

  instructions: {
    pageOf: (page: number, of: number) => `Page ${page} of ${of}`,
    done: 'I have read this',
    keysLabel: 'A keyboard with the keys that you fly with',
    try: 'Press the keys: they light up.',
    pad: 'A gamepad works as well: left stick, cross and lower button.',
    change: 'Change',
    usual: 'Usual keys',
    press: 'Press a key …',
    changeFor: (control: string) => `Change the key for “${control}”`,
    or: 'or',
    /** A control on a drawn key, where there is little room. */
    short: ENGLISH.control,
    taskLabel: 'What you see: what you steer, and the goals; yours is amber',
    craft: 'what you steer',
    goal: 'your goal, marked ★',
    others: 'other goals, not yours',
  },

  quiz: {
    title: 'Is everything clear?',
    text: 'A few questions, so that we know that we explained it well.',
    check: 'Check',
    wrong: (attempts: number) =>
      attempts === 1
        ? 'Something is not right yet. Please look at it again; you have one more try.'
        : `Something is not right yet. Please look at it again; you have ${attempts} more tries.`,
  },

  block: {
    practice: (many: number) => count(many, 'flight for practice', 'flights for practice'),
    measured: (many: number) => count(many, 'flight that counts', 'flights that count'),
    pause: 'During a flight, Esc pauses it.',
  },

  break: {
    title: 'Time for a break',
    wait: (seconds: number) => `You can continue in ${clock(seconds)}.`,
    free: 'Continue whenever you like.',
    late: 'Please continue now, if you can.',
    go: 'Continue',
  },

  debrief: { title: 'Thank you: that was everything' },

  thanks: {
    title: 'Thank you for taking part',
    code: 'Your completion code',
    copy: 'Copy',
    copied: 'Copied',
    back: (seconds: number) => `You are taken back in ${count(seconds, 'second', 'seconds')}.`,
    stay: 'Stay here',
    close: 'You can close this page now.',
  },

  flightOf: {
    practice: (number: number, of: number) => `Practice ${number} of ${of}`,
    measured: (number: number, of: number) => `Flight ${number} of ${of}`,
  },

  states: {
    back: 'Back to where you came from',
    opening: { title: 'One moment', text: 'The study opens.' },
    nobody: {
      title: 'This page needs your link',
      text: 'Please open the link that you were given for this study. If you did, this browser may refuse cookies: allow them for this page, or use another browser.',
    },
    away: {
      title: 'No connection to the study',
      text: 'Nothing is lost: what you did is kept in this browser. The page tries again by itself.',
      again: 'Try now',
    },
    takenOver: {
      title: 'The study goes on in another window',
      text: 'It can be open in one window at a time. You may close this one, or go on here.',
      again: 'Go on here',
    },
    declined: {
      title: 'You do not take part',
      text: 'Thank you for your time. Nothing was recorded of you but that you declined. You can close this page now.',
    },
    withdrawn: {
      title: 'You have withdrawn',
      text: 'Everything that was recorded of you in this study was deleted. Thank you for your time. You can close this page now.',
    },
    excluded: {
      title: 'The study ends here',
      text: 'Thank you for your time. For this study we need people or devices with other conditions; that is no judgement of you. You can close this page now.',
    },
    completed: {
      title: 'Thank you for taking part',
      text: 'You have completed the study. You can close this page now.',
    },
    unable: {
      title: 'The page could not be opened',
      text: 'It needs a browser of 2022 or later with WebAssembly. Try again, or use another browser with the same link.',
      again: 'Try again',
    },
    stuck: {
      title: 'The page cannot go on',
      text: 'What you have done so far is kept. Load the page again; if it stops here once more, please tell whoever invited you.',
      again: 'Load the page again',
    },
  },

  flight: ENGLISH,
};

/** Minutes and seconds. */
export function clock(seconds: number): string {
  return `${Math.floor(seconds / 60)}:${String(seconds % 60).padStart(2, '0')}`;
}

/** What every language must say. */
export type Words = typeof en;
