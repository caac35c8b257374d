// A record that cannot be flown again here, as a sheet of paper: what fixed it, what was asked and carried out.

import { element } from './dom';
import { readRecord, type FlightRecord, type Recorded } from './record';
import { ENDING_WORDS, RULE_NAMES } from './words';

/** The sheet, or why there is none. `why` says why it is not flown again. */
export function sheetOf(bytes: Uint8Array, why: string): HTMLElement {
  const paper = element(
    'article',
    { class: 'sheet' },
    element('h2', {}, 'This record is not flown again here'),
    element('p', {}, why),
  );
  try {
    const record = readRecord(bytes);
    paper.append(
      element('p', {}, 'What was asked and what was carried out is in it all the same:'),
      facts(record),
      lanes(record),
    );
  } catch (error) {
    paper.append(element('p', {}, error instanceof Error ? error.message : String(error)));
  }
  return paper;
}

function facts({ setup, ending, asked, executed, events, elsewhere }: FlightRecord): HTMLElement {
  const same = asked.filter((action, tick) => JSON.stringify(action) === JSON.stringify(executed[tick])).length;
  const rows: [string, string][] = [
    ['plant', `${setup.task.plant}, version ${setup.plant_version}, ${JSON.stringify(setup.task.options)}`],
    ['seed', String(setup.seed)],
    ['rule', RULE_NAMES[setup.rule.rule] ?? setup.rule.rule],
    ['pilot', setup.pilot],
    [
      'outcome',
      `${ENDING_WORDS[ending]?.word ?? ending}${elsewhere?.lost ? `: the plant was lost, ${elsewhere.lost}` : ''}`,
    ],
    [
      'ticks',
      `${asked.length}, of them ${asked.filter((action) => action !== null).length} with a request; ${same} carried out as asked`,
    ],
    ['key events', String(events)],
    ['values', setup.values ?? 'none'],
    ['intent', setup.intent ?? 'none'],
  ];
  return element('dl', {}, ...rows.flatMap(([name, value]) => [element('dt', {}, name), element('dd', {}, value)]));
}

/** Two lanes of commands over time, a row each command, asked above carried out. */
function lanes({ asked, executed }: FlightRecord): HTMLElement {
  const canvas = element('canvas', {
    class: 'lanes',
    role: 'img',
    'aria-label': 'Asked and carried out, tick by tick',
  });
  requestAnimationFrame(() => paintLanes(canvas, [asked, executed]));
  return element(
    'figure',
    {},
    canvas,
    element(
      'figcaption',
      { class: 'note' },
      'Above: asked. Below: carried out. A row is a command, from left to right go the ticks.',
    ),
  );
}

function paintLanes(canvas: HTMLCanvasElement, lists: Recorded[][]): void {
  const ratio = devicePixelRatio || 1;
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  [canvas.width, canvas.height] = [Math.round(width * ratio), Math.round(height * ratio)];
  const pen = canvas.getContext('2d');
  if (pen === null) return;
  pen.scale(ratio, ratio);
  const commands = lists.flat().filter((action): action is number => typeof action === 'number');
  const count = Math.max(...commands, 0) + 1;
  const lane = height / lists.length;
  lists.forEach((list, i) => {
    pen.fillStyle = i === 0 ? '#56b4e9' : '#ffb000';
    list.forEach((action, tick) => {
      if (action === null) return;
      const row = typeof action === 'number' ? action : 0;
      const tall = (lane - 8) / count;
      pen.fillRect(
        (tick / list.length) * width,
        i * lane + 4 + row * tall,
        width / list.length + 0.4,
        Math.max(tall - 1, 1),
      );
    });
  });
}
