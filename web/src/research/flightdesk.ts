// A recorded flight at the desk: watched with a scrubber, and flown again from any tick as it was not.

import type { Core, ReplayReport, Wish } from '../core';
import { CoreError } from '../core';
import { button, element } from '../dom';
import type { Hangar } from '../hangar';
import { drawStrip } from '../history';
import { Overlay } from '../overlay';
import { Player } from '../player';
import { readRecord } from '../record';
import { readRecording, ReplayRun, type Recording, type Screen } from '../replay';
import { actionsOf } from '../rules';
import { sheetOf } from '../sheet';
import { ENDING_WORDS, reasonOf, sentence } from '../words';
import { flyBranch, type Branch } from './branching';
import * as api from './deskapi';
import { markBranch, Panel } from './panel';
import type { Desk, DeskView } from './place';
import { stepWords } from './says';
import { handsWords, ruleWords, WhatIfBar } from './whatif';
import { momentWords, whatItSays } from './worth';

/** Ticks shown before a branch, so that one sees how it came to it. */
const RUN_UP_TICKS = 40;
/** How many flights of one person are looked through for the one before and the one after. */
const MOST_EPISODES = 1000;
const isOver = ({ state }: api.DeskEpisode) => state === 'finished';

interface Opened {
  core: Core;
  second: Core;
  hangar: Hangar;
  bytes: Uint8Array;
  recording: Recording;
  exact: ReplayReport;
}

export class FlightDeskView implements DeskView {
  readonly main = element('main', { class: 'instrument replaying' });
  private readonly stages = element('div', { class: 'stages' });
  private readonly overlay = new Overlay();
  private readonly beside = element('div', { class: 'beside' });
  private readonly strips = element('div', { class: 'scrubber' });
  private readonly verdict = element('p', { class: 'verdict-line', role: 'status', hidden: true });
  private readonly controls = element('footer', { class: 'player' });
  private readonly player = new Player(() => this.desk.go(this.back));
  private readonly own = new Panel('recorded');
  private readonly other = new Panel('what if');
  private readonly onResize = () => this.drawStrips();
  private opened: Opened | null = null;
  private branch: Branch | null = null;
  private bar: WhatIfBar | null = null;
  private run: ReplayRun | null = null;
  private overlayOf: 'recorded' | 'what if' = 'recorded';
  private wishes = 0;
  private gone = false;
  private back = 'episodes';
  private file: string | null = null;

  constructor(
    private readonly desk: Desk,
    private readonly id: number,
  ) {
    window.addEventListener('resize', this.onResize);
    for (const { strip } of [this.own, this.other]) {
      strip.addEventListener('pointerdown', ({ offsetX }) =>
        this.player.seek(Math.round((offsetX / strip.clientWidth) * (this.run?.length ?? 0))),
      );
    }
    this.main.append(element('p', { class: 'reading', role: 'status' }, 'Reading the record…'));
    void this.open().catch((error: unknown) => {
      const words = element('p', {}, sentence(reasonOf(error)));
      if (!this.gone)
        this.showSheet(element('article', { class: 'sheet' }, element('h2', {}, 'There is no record to watch'), words));
    });
  }

  dispose(): void {
    this.gone = true;
    this.run?.dispose();
    this.player.dispose();
    window.removeEventListener('resize', this.onResize);
    if (this.file !== null) URL.revokeObjectURL(this.file);
  }

  private async open(): Promise<void> {
    const bytes = await api.episodeBytes(this.id);
    if (this.gone) return;
    this.file = URL.createObjectURL(new Blob([bytes as Uint8Array<ArrayBuffer>]));
    const loop = await this.desk.loop();
    const { setup } = readRecord(bytes);
    // A model that is gone is told by the loop, and the sheet shows what needs none.
    await loop.hangar.equip(loop.core, [setup.values, setup.intent]).catch(() => {});
    try {
      const recording = await readRecording(
        loop.core,
        bytes,
        () => !this.gone,
        () => {},
      );
      if (recording === null) return;
      this.opened = { ...loop, bytes, recording, exact: loop.core.replay(bytes) };
      this.show(this.opened);
    } catch (error) {
      if (!(error instanceof CoreError)) await loop.core.revive();
      if (!this.gone) this.showSheet(sheetOf(bytes, sentence(reasonOf(error))));
    }
  }

  private showSheet(sheet: HTMLElement): void {
    this.main.className = 'page';
    this.main.replaceChildren(element('a', { href: '#/episodes' }, '← Flights'), sheet, ...this.download());
  }

  private download(): HTMLElement[] {
    if (this.file === null) return [];
    return [element('a', { href: this.file, download: `episode-${this.id}.cohelm`, class: 'secondary' }, 'Save')];
  }

  private show({ recording, exact }: Opened): void {
    const { player } = this;
    this.stages.replaceChildren(this.own.node);
    this.beside.replaceChildren(this.overlay.node);
    this.strips.replaceChildren(this.own.strip, player.slider);
    this.controls.replaceChildren(
      player.play,
      this.strips,
      player.time,
      player.speed,
      button('What if, from here…', { class: 'primary' }, () => void this.openWhatIf()),
      ...this.download(),
    );
    this.main.replaceChildren(this.stages, this.beside, this.verdict, this.controls);
    this.showTitle(recording, exact);
    this.own.begin(recording);
    this.start([{ recording, stage: this.own.stage }], 0, true);
    void this.nameEpisode();
  }

  private showTitle({ opening, differing, length, tickAt }: Recording, exact: ReplayReport): void {
    const { setup, ticks_per_second } = opening;
    const { sign, word } = ENDING_WORDS[tickAt(length)?.ending ?? 'abandoned'];
    const same = exact.identical && differing === 0;
    const mark = same ? '✓ flown again, bit for bit' : '✕ differs from its record';
    this.own.say(
      element('span', {}, `${sign} ${word} after ${(length / ticks_per_second).toFixed(2)} s`),
      element('span', {}, `${ruleWords(setup.rule)} · ${setup.inference} · seed ${setup.seed}`),
      element('span', { class: 'exact', 'data-identical': String(same) }, mark),
    );
  }

  /** Whose flight it is, and which came before and after; the list knows, the record does not. */
  private async nameEpisode(): Promise<void> {
    const { episodes } = await api.episodes({ before: this.id + 1, limit: 1 });
    const row = episodes.find(({ id }) => id === this.id);
    if (row === undefined || this.gone) return;
    const { participant, step, code } = row;
    if (participant === null) return;
    this.back = `people/${participant}`;
    this.own.name(`${code ?? ''} · ${step === null ? `episode ${this.id}` : stepWords(step)}`, `#/${this.back}`);
    const all = (await api.episodes({ participant, limit: MOST_EPISODES })).episodes.filter(isOver);
    const link = (to: number | undefined, words: string) =>
      to === undefined ? [] : [element('a', { href: `#/episodes/${to}` }, words)];
    const earlier = all.filter(({ id }) => id < this.id).map(({ id }) => id);
    const later = all.filter(({ id }) => id > this.id).map(({ id }) => id);
    const [before, after] = [
      earlier.length > 0 ? Math.max(...earlier) : undefined,
      later.length > 0 ? Math.min(...later) : undefined,
    ];
    if (!this.gone) this.own.lead(...link(before, '‹ flight before'), ...link(after, 'flight after ›'));
  }

  private start(screens: [Screen, ...Screen[]], at: number, play: boolean): void {
    this.run?.dispose();
    this.run = new ReplayRun(screens, (position) => this.moved(position));
    this.player.take(this.run, screens[0].recording.opening.ticks_per_second);
    this.beginOverlay();
    this.run.seek(at);
    if (play) this.run.play();
    this.player.show(at);
    this.drawStrips();
  }

  private moved(position: number): void {
    this.player.show(position);
    const shown = this.overlayOf === 'what if' && this.branch !== null ? this.branch : this.opened!.recording;
    const tick = Math.min(position, shown.length);
    this.overlay.show(shown.tickAt(tick), shown.history, tick);
    if (this.branch !== null) this.other.moment(momentWords(this.branch, position));
  }

  private async openWhatIf(): Promise<void> {
    const { opened } = this;
    if (opened === null || this.run === null) return;
    this.run.pause();
    if (this.bar === null) {
      const { setup } = opened.recording.opening;
      const usual = opened.hangar.crew(setup.task, '', 'calibrated');
      const [own, imagined] = setup.inference === 'imagined' ? [null, setup.intent] : [setup.intent, null];
      const models = {
        values: setup.values ?? usual.values,
        intent: own ?? usual.intent,
        imagined: imagined ?? opened.hangar.crew(setup.task, '', 'imagined').intent,
      };
      await opened.hangar.equip(opened.second, [...Object.values(models), setup.values, setup.intent]).catch(() => {});
      if (this.gone) return;
      opened.second.watch(opened.bytes);
      const actions = actionsOf(opened.recording.opening.controls.map(({ name }) => name));
      const ground = { setup, actions, models, pilots: opened.second.pilots() };
      this.bar = new WhatIfBar(
        ground,
        (wish) => void this.fly(wish),
        () => this.leave(),
      );
      this.main.insertBefore(this.bar.node, this.verdict);
    }
    this.bar.start(Math.min(this.run.tick, opened.recording.length));
  }

  private async fly(wish: Wish): Promise<void> {
    const { second, recording } = this.opened!;
    const mine = (this.wishes += 1);
    const wanted = () => !this.gone && this.wishes === mine;
    try {
      const branch = await flyBranch(second, recording, wish, wanted);
      if (branch !== null && wanted()) this.showBranch(branch);
    } catch (error) {
      if (!(error instanceof CoreError)) await second.revive();
      if (wanted()) this.tell(sentence(reasonOf(error)), true);
    }
  }

  private showBranch(branch: Branch): void {
    const { recording } = this.opened!;
    this.branch = branch;
    const { wish } = branch;
    const { sign, word } = ENDING_WORDS[branch.ending];
    this.other.begin(branch);
    this.other.say(
      element('span', {}, `${sign} ${word} after ${(branch.length / branch.opening.ticks_per_second).toFixed(2)} s`),
      element('span', {}, `${ruleWords(wish.rule)} · ${wish.inference} · ${handsWords(wish.pilot)}`),
    );
    this.other.name('What if', null);
    this.stages.replaceChildren(this.own.node, this.other.node);
    this.strips.replaceChildren(this.own.strip, this.other.strip, this.player.slider);
    this.overlayOf = 'what if';
    this.beside.replaceChildren(this.tabs(), this.overlay.node);
    this.main.classList.add('with-branch');
    this.tell(whatItSays(recording, branch), false);
    const screens: [Screen, Screen] = [
      { recording, stage: this.own.stage },
      { recording: branch, stage: this.other.stage },
    ];
    this.start(screens, Math.max(0, wish.at - RUN_UP_TICKS), true);
    // The recorded way beside the other, from where they part.
    const recorded = Array.from({ length: Math.max(0, recording.length - wish.at) + 1 }, (_, i) =>
      recording.posesAt(Math.min(wish.at + i, recording.length)),
    );
    this.other.stage.compare(recorded);
  }

  private leave(): void {
    const at = this.run?.tick ?? 0;
    this.wishes += 1;
    this.branch = null;
    this.bar?.node.remove();
    this.bar = null;
    this.overlayOf = 'recorded';
    this.verdict.hidden = true;
    this.main.classList.remove('with-branch');
    const { recording } = this.opened!;
    this.stages.replaceChildren(this.own.node);
    this.strips.replaceChildren(this.own.strip, this.player.slider);
    this.beside.replaceChildren(this.overlay.node);
    this.start([{ recording, stage: this.own.stage }], Math.min(at, recording.length), false);
  }

  private tell(words: string, failed: boolean): void {
    this.verdict.hidden = false;
    this.verdict.textContent = words;
    this.verdict.dataset['failed'] = String(failed);
  }

  private tabs(): HTMLElement {
    const tab = (name: 'recorded' | 'what if') =>
      button(name, { 'aria-pressed': String(this.overlayOf === name) }, () => {
        this.overlayOf = name;
        this.beside.replaceChildren(this.tabs(), this.overlay.node);
        this.beginOverlay();
        this.moved(this.run?.tick ?? 0);
      });
    return element(
      'div',
      { class: 'segmented', role: 'group', 'aria-label': 'Whose co-pilot' },
      tab('recorded'),
      tab('what if'),
    );
  }

  private beginOverlay(): void {
    const shown = this.overlayOf === 'what if' && this.branch !== null ? this.branch : this.opened!.recording;
    const { setup, pilot_goal, goals } = shown.opening;
    this.overlay.begin(setup.rule, pilot_goal, goals, []);
  }

  private drawStrips(): void {
    if (this.run === null || this.opened === null) return;
    const { length } = this.run;
    drawStrip(this.own.strip, this.opened.recording.history, 0, length);
    if (this.branch === null) return;
    drawStrip(this.other.strip, this.branch.history, 0, length);
    markBranch(this.other.strip, this.branch, length);
  }
}
