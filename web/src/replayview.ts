// The view in which a flight is watched again, with a scrubber.

import type { Context, View } from './context';
import { CoreError, type Ending, type ReplayReport } from './core';
import { button, element } from './dom';
import { drawStrip } from './history';
import { Overlay } from './overlay';
import { Player } from './player';
import { readRecord, type Elsewhere } from './record';
import { readRecording, ReplayRun, type Recording } from './replay';
import { sheetOf } from './sheet';
import { Stage } from './stage';
import { ENDING_WORDS, reasonOf, RULE_NAMES, sentence } from './words';

/** What is watched: where its bytes come from, what it is called, and where to go back to. */
export interface Source {
  title: string;
  bytes: () => Promise<Uint8Array>;
  back: { label: string; place: string };
}

export class ReplayView implements View {
  readonly main = element('main', { class: 'flight with-overlay' });
  readonly footer = element('footer', { class: 'player' });
  private readonly overlay = new Overlay();
  private readonly title = element('div', { class: 'title' });
  private readonly strip = element('canvas', { class: 'strip', 'aria-hidden': 'true' });
  private readonly player: Player;
  private run: ReplayRun | null = null;
  private disposed = false;
  private file: string | null = null;
  private readonly onResize = () => this.drawStrip();
  private drawStrip: () => void = () => {};

  constructor(
    private readonly context: Pick<Context, 'core' | 'hangar' | 'go'>,
    private readonly source: Source,
  ) {
    this.player = new Player(() => context.go(source.back.place));
    window.addEventListener('resize', this.onResize);
    void this.open();
  }

  dispose(): void {
    this.disposed = true;
    this.run?.dispose();
    if (this.file !== null) URL.revokeObjectURL(this.file);
    this.player.dispose();
    window.removeEventListener('resize', this.onResize);
  }

  private async open(): Promise<void> {
    const reading = element('p', { class: 'reading' }, 'Reading the record…');
    this.main.replaceChildren(reading);
    this.footer.replaceChildren(this.back());
    let bytes: Uint8Array;
    try {
      bytes = await this.source.bytes();
    } catch (error) {
      if (!this.disposed)
        this.showSheet(
          element(
            'article',
            { class: 'sheet' },
            element('h2', {}, 'There is no record to watch'),
            element('p', {}, sentence(reasonOf(error))),
          ),
        );
      return;
    }
    if (this.disposed) return;
    this.file = URL.createObjectURL(new Blob([bytes as Uint8Array<ArrayBuffer>]));
    try {
      await this.equip(bytes);
      const told = (part: number) => (reading.textContent = `Flying it again… ${Math.round(100 * part)} %`);
      const recording = await readRecording(this.context.core, bytes, () => !this.disposed, told);
      if (recording !== null) this.show(recording, this.context.core.replay(bytes), readRecord(bytes).elsewhere);
    } catch (error) {
      if (!this.disposed) await this.cannotFly(bytes, error);
    }
  }

  /** Gets the models that the record names. One that is gone is told by the loop. */
  private async equip(bytes: Uint8Array): Promise<void> {
    const length = new DataView(bytes.buffer, bytes.byteOffset).getUint32(5, true);
    const header = JSON.parse(new TextDecoder().decode(bytes.subarray(9, 9 + length))) as {
      setup: { values: string | null; intent: string | null };
    };
    for (const hash of [header.setup.values, header.setup.intent]) {
      try {
        await this.context.hangar.equip(this.context.core, [hash]);
      } catch {
        // The loop says which model is missing, and the sheet shows what needs none.
      }
    }
  }

  private async cannotFly(bytes: Uint8Array, error: unknown): Promise<void> {
    if (!(error instanceof CoreError)) await this.context.core.revive();
    if (!this.disposed) this.showSheet(sheetOf(bytes, sentence(reasonOf(error))));
  }

  private showSheet(sheet: HTMLElement): void {
    this.main.className = 'page';
    this.main.replaceChildren(sheet);
    this.footer.replaceChildren(this.back(), element('span', { class: 'spacer' }), ...this.download());
  }

  private show(recording: Recording, exact: ReplayReport, elsewhere: Elsewhere | null): void {
    const { opening, length } = recording;
    const canvas = element('canvas', { class: 'front', role: 'img', 'aria-label': 'The recorded flight' });
    const back = element('canvas', { class: 'back', 'aria-hidden': 'true' });
    this.main.replaceChildren(element('div', { class: 'stage' }, back, canvas, this.title), this.overlay.node);
    this.overlay.begin(opening.setup.rule, opening.pilot_goal, opening.goals, []);
    const ending = recording.tickAt(length)?.ending ?? 'abandoned';
    this.showTitle(recording, ending, exact, elsewhere);
    this.drawStrip = () => drawStrip(this.strip, recording.history, 0, length);
    const { player } = this;
    this.footer.replaceChildren(
      this.back(),
      player.play,
      element('div', { class: 'scrubber' }, this.strip, player.slider),
      player.time,
      player.speed,
      ...this.download(),
    );
    this.run = new ReplayRun([{ recording, stage: new Stage(back, canvas) }], (position) => {
      player.show(position);
      this.overlay.show(recording.tickAt(position), recording.history, position);
    });
    player.take(this.run, opening.ticks_per_second);
    this.run.seek(0);
    this.run.play();
    player.show(0);
    this.drawStrip();
  }

  private showTitle(
    { opening, differing }: Recording,
    ending: Ending,
    exact: ReplayReport,
    elsewhere: Elsewhere | null,
  ): void {
    const { setup } = opening;
    const { sign, word } = ENDING_WORDS[ending];
    const plant = elsewhere?.name ?? setup.task.plant;
    const why = elsewhere?.lost == null ? '' : `: the plant was lost, ${elsewhere.lost}`;
    this.title.replaceChildren(
      element('b', {}, this.source.title),
      element('span', { class: 'outcome', 'data-outcome': ending }, `${sign} ${word}${why}`),
      element('span', {}, `${RULE_NAMES[setup.rule.rule]} · ${plant} · ${setup.pilot} · seed ${setup.seed}`),
      exactMark(exact, differing, elsewhere),
    );
  }

  private back(): HTMLButtonElement {
    const { label, place } = this.source.back;
    return button(`← ${label}`, { class: 'secondary' }, () => this.context.go(place));
  }

  private download(): HTMLElement[] {
    if (this.file === null) return [];
    const name = `${this.source.title.toLowerCase().replace(/[^a-z0-9]+/g, '-')}.cohelm`;
    return [element('a', { href: this.file, download: name, class: 'secondary' }, 'Save')];
  }
}

/** Whether it came out as recorded. States of a plant elsewhere are the record's own: nothing flies that plant again. */
export function exactMark(exact: ReplayReport, differing: number, elsewhere: Elsewhere | null): HTMLElement {
  const same = exact.identical && differing === 0;
  const parts = [
    exact.plant_identical ? '' : elsewhere === null ? 'physics' : 'states',
    exact.decisions_identical === false ? 'decisions' : '',
    exact.requests_identical === false ? 'requests' : '',
  ];
  const agrees =
    elsewhere === null
      ? '✓ flown again, bit for bit the same'
      : '✓ from recorded states; the decisions made again, the same';
  const differs = `✕ differs from its record: ${parts.filter((part) => part !== '').join(', ') || 'what was carried out'}`;
  return element('span', { class: 'exact', 'data-identical': String(same) }, same ? agrees : differs);
}
