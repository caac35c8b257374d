// Whether this device keeps the pace of the flights: the loop ticks and draws for five seconds as in a flight.

import { button, element } from '../../dom';
import { measurePace, type Pace } from '../pace';
import { forward, handIn, nextFlight, pressed, showSheet, type Screen } from '../study';
import { unassisted } from '../taskpicture';

/** A larger share of late ticks than this is too slow. */
const MOST_LATE = 0.05;
/** Flights are meant for windows of this size, px. */
const [ROOMY_WIDTH, ROOMY_HEIGHT] = [1000, 600];

export const device: Screen<'device'> = async (root, step, study) => {
  const { words } = study;
  const flight = nextFlight(study);
  for (let tries = 1; ; tries += 1) {
    const shownAt = performance.now();
    const start = forward(tries === 1 ? words.device.start : words.device.again);
    const isSmall = innerWidth < ROOMY_WIDTH || innerHeight < ROOMY_HEIGHT;
    const sheet = showSheet(
      root,
      'device',
      words.device.title,
      element('p', {}, words.device.text),
      ...(isSmall ? [element('p', { class: 'warning' }, words.device.small)] : []),
      element('div', { class: 'actions' }, start),
    );
    await pressed(start);
    const pace =
      flight === null
        ? null
        : await run(sheet, words.device.running, (canvases, progress) =>
            measurePace(study.deck.core, unassisted(flight.setup, 1), canvases, progress),
          );
    const ok = pace === null || pace.late_ticks <= MOST_LATE * pace.ticks;
    study.refreshHz = pace?.refresh_hz ?? null;
    if (!ok && (await showFailure(sheet, pace, words, step.refuse)) === 'again') continue;
    if (ok && pace !== null) await showPassed(sheet, pace, words);
    await handIn(study, step, { ok, tries, ...pace, ...screenOf() }, shownAt);
    return;
  }
};

type Words = Parameters<Screen<'device'>>[2]['words'];

/** Shows that the check runs, and what it draws, faintly, behind it. */
async function run(
  sheet: HTMLElement,
  text: string,
  measure: (canvases: HTMLCanvasElement[], progress: (part: number) => void) => Promise<Pace>,
): Promise<Pace> {
  const canvases = ['back', 'front'].map((name) => element('canvas', { class: name, 'aria-hidden': 'true' }));
  const bar = element('progress', { max: '1', value: '0', 'aria-label': text });
  sheet.querySelector('.actions')!.replaceChildren(element('p', { role: 'status' }, text), bar);
  const behind = element('div', { class: 'stage behind' }, ...canvases);
  sheet.before(behind);
  const pace = await measure(canvases, (part) => (bar.value = part));
  behind.remove();
  return pace;
}

function facts(pace: Pace, words: Words): HTMLElement {
  return element(
    'p',
    { class: 'quiet' },
    `${words.device.refresh(pace.refresh_hz)} · ${words.device.pace(pace.late_ticks, pace.ticks)}`,
  );
}

async function showPassed(sheet: HTMLElement, pace: Pace, words: Words): Promise<void> {
  const go = forward(words.goOn);
  sheet
    .querySelector('.actions')!
    .replaceChildren(
      element('p', { class: 'good', role: 'status' }, `✓ ${words.device.passed}`),
      facts(pace, words),
      go,
    );
  go.focus();
  await pressed(go);
}

function showFailure(sheet: HTMLElement, pace: Pace, words: Words, refuse: boolean): Promise<'again' | 'anyway'> {
  return new Promise((resolve) => {
    const again = button(words.device.again, { class: 'primary large' }, () => resolve('again'));
    const anyway = button(words.device.anyway, { class: 'secondary large' }, () => resolve('anyway'));
    const late = Math.round((100 * pace.late_ticks) / Math.max(pace.ticks, 1));
    sheet
      .querySelector('.actions')!
      .replaceChildren(
        element('p', { class: 'bad', role: 'alert' }, `✕ ${words.device.failed}`),
        element('p', {}, words.device.failedText(late)),
        ...(refuse ? [element('p', {}, words.device.refused)] : []),
        element('div', { class: 'actions' }, again, ...(refuse ? [] : [anyway])),
      );
    again.focus();
  });
}

function screenOf(): Record<string, number> {
  return { width_px: innerWidth, height_px: innerHeight, pixel_ratio: devicePixelRatio };
}
