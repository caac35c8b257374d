// The view in which a person flies.

import { Card, sideFor, type CardAction } from './card';
import type { Context, View } from './context';
import { Controls } from './controls';
import { CoreStopped, needsNetwork, type Setup } from './core';
import { element, isEnter, isTheirs, wantsCalm } from './dom';
import { FlightRun, type FlightSummary } from './flight';
import { History } from './history';
import { Hud } from './hud';
import { keyCap, keyName, otherKeys } from './keys';
import { say } from './message';
import { Overlay } from './overlay';
import { keepSettings, loadSettings, type Settings } from './settings';
import { Stage } from './stage';
import {
  CANVAS,
  directionOf,
  DRAG,
  endingHint,
  ENDING_WORDS,
  ENDINGS,
  parametersOf,
  reasonOf,
  sentence,
} from './words';

/** How long an ending is watched before the card comes, ms. */
const WATCH_ENDING_MS = 900;
/** A larger share of late ticks than this is worth a remark. */
const LATE_SHARE = 0.05;

export class FlyView implements View {
  readonly main = element('main', { class: 'flight' });
  readonly footer: HTMLElement;
  private readonly settings: Settings = loadSettings();
  private readonly stage: Stage;
  private readonly overlay = new Overlay();
  private readonly card = new Card();
  private readonly hud = new Hud();
  private readonly controls: Controls;
  private readonly field: HTMLElement;
  private history = new History();
  private run: FlightRun | null = null;
  /** Counts preparations: an older one that comes to its end late is not the flight any more. */
  private preparation = 0;
  private disposed = false;
  private readonly onKey = (event: KeyboardEvent) => this.shortcut(event);
  private readonly onBlur = () => this.run?.pause();
  private readonly onHide = () => {
    if (document.hidden) this.run?.pause();
  };
  private readonly onModels = (learnt: boolean) => void this.modelsChanged(learnt);

  constructor(private readonly context: Context) {
    const canvas = element('canvas', {
      class: 'front',
      role: 'img',
      'aria-label': CANVAS,
    });
    const back = element('canvas', { class: 'back', 'aria-hidden': 'true' });
    this.stage = new Stage(back, canvas);
    this.field = element(
      'div',
      { class: 'stage', tabindex: '-1' },
      back,
      canvas,
      this.hud.node,
      this.card.node,
      this.card.voice,
    );
    this.main.append(this.field, this.overlay.node);
    this.controls = new Controls(
      context.hangar,
      this.settings,
      (change) => this.change(change),
      () => this.toggleOverlay(),
    );
    this.footer = this.controls.node;
    this.showOverlay();
    window.addEventListener('keydown', this.onKey);
    window.addEventListener('blur', this.onBlur);
    document.addEventListener('visibilitychange', this.onHide);
    context.onModels.add(this.onModels);
    this.controls.build();
    void this.prepare();
  }

  dispose(): void {
    this.disposed = true;
    this.preparation += 1;
    this.run?.abandon();
    this.run?.dispose();
    this.card.hide();
    window.removeEventListener('keydown', this.onKey);
    window.removeEventListener('blur', this.onBlur);
    document.removeEventListener('visibilitychange', this.onHide);
    this.context.onModels.delete(this.onModels);
  }

  /** Gets the next flight ready: its world is there to be looked at, nothing moves yet. False if it is not the flight that
   * was chosen: the card says why, and what is seen must not be started. */
  private async prepare(seed = this.controls.seed ?? Math.floor(Math.random() * 2 ** 48)): Promise<boolean> {
    const preparation = ++this.preparation;
    this.run?.dispose();
    this.run = null;
    const why = this.controls.whyNot(this.controls.mode);
    try {
      const setup = why === null ? await this.setup(seed) : this.unassisted(seed);
      if (preparation !== this.preparation) return false;
      this.makeReady(setup);
      if (why === null) this.showReady();
      else this.showUnable(why);
      return why === null;
    } catch (error) {
      if (preparation === this.preparation) await this.failed(error);
      return false;
    }
  }

  private makeReady(setup: Setup): void {
    const tried = this.context.hangar.try(setup.task);
    const run = new FlightRun(
      this.context.core,
      setup,
      tried?.hasAxes === true,
      this.stage,
      {
        tick: (tick) => {
          this.history.push(tick);
          this.overlay.show(tick, this.history, run.ticks);
          this.showHud();
        },
        paused: (paused) => (paused ? this.showPaused() : this.card.hide()),
        ended: (summary) => this.ended(summary),
        failed: (error) => void this.failed(error),
      },
      this.context.link,
    );
    this.run = run;
    this.history = new History();
    this.overlay.begin(setup.rule, run.opening.pilot_goal, run.opening.goals, tried?.labels ?? []);
    this.hud.begin(run.opening, this.controls.mode.label);
  }

  /** A flight without a co-pilot. */
  private unassisted(seed: number): Setup {
    const {
      settings,
      context: { hangar },
      controls: { task },
    } = this;
    const version = hangar.versionOf(task.plant);
    if (version === null) throw new Error(`This page knows no plant called ${task.plant}.`);
    return {
      task,
      plant_version: version,
      seed,
      rule: { rule: 'hic' },
      inference: 'nearest',
      silence: 'best',
      time_scale: settings.timeScale,
      values: null,
      intent: null,
      pilot: 'person',
    };
  }

  private async setup(seed: number): Promise<Setup> {
    const {
      settings,
      context: { core, hangar },
      controls: { task, mode },
    } = this;
    const inferring = hangar.inferring(task, settings.values, settings.inference).inference;
    const inference = mode.mode === 'demo' ? 'known' : inferring;
    const { values, intent: model } = hangar.crew(task, settings.values, inference);
    const intent = needsNetwork(inference) ? model : null;
    try {
      await hangar.equip(core, [values, intent]);
    } catch (error) {
      // Who flies alone needs no models: they would only have watched.
      if (mode.mode !== 'hic' || error instanceof CoreStopped) throw error;
      return this.unassisted(seed);
    }
    return { ...this.unassisted(seed), rule: this.controls.ruleOf(mode), inference, values, intent };
  }

  private begin(): void {
    if (this.run === null) return;
    if (this.run.isReady) this.context.link.begin(this.run.opening.setup);
    this.controls.close();
    this.card.hide();
    this.field.focus();
    this.run.start();
  }

  private async again(): Promise<void> {
    if (await this.prepare()) this.begin();
  }

  private ended(summary: FlightSummary): void {
    const { link, session } = this.context;
    link.end(summary.ending);
    this.showHud();
    if (this.disposed || summary.ticks === 0) return;
    session.last = summary.record;
    const robot = this.controls.mode.mode === 'demo';
    const hint = endingHint(summary.ending, { robot, commands: summary.commands });
    const content = [element('p', {}, hint), numbersOf(summary, robot)];
    if (!robot) {
      session.endings.push(summary.ending);
      content.push(this.tally());
    }
    if (summary.lateTicks > LATE_SHARE * summary.ticks) {
      content.push(element('p', {}, `${summary.lateTicks} ticks came late: is something else busy on this machine?`));
    }
    this.card.stand(sideFor(this.stage.place));
    const watched = summary.ending === 'abandoned' || wantsCalm() ? 0 : WATCH_ENDING_MS;
    this.card.show(
      summary.ending,
      robot && summary.ending === 'goal' ? 'At the goal' : ENDINGS[summary.ending],
      content,
      [
        { label: 'Fly again', key: '⏎', primary: true, press: () => void this.again() },
        { label: 'Watch it', key: 'R', press: () => this.context.go('again') },
      ],
      watched,
    );
  }

  /** A sign for each flight that the person flew in this visit. */
  private tally(): HTMLElement {
    const { endings } = this.context.session;
    const landed = endings.filter((ending) => ending === 'goal').length;
    const signs = endings
      .slice(-16)
      .map((ending) =>
        element(
          'span',
          { class: 'outcome', 'data-outcome': ending, title: ENDING_WORDS[ending].word },
          ENDING_WORDS[ending].sign,
        ),
      );
    return element('p', { class: 'tally' }, ...signs, ` ${landed} of ${endings.length} at the goal`);
  }

  private showReady(): void {
    const { opening } = this.run!;
    const { mode } = this.controls;
    const robot = mode.mode === 'demo';
    const keys = element(
      'div',
      { class: 'keys' },
      ...opening.controls.map((control) =>
        element(
          'span',
          { 'aria-label': `${control.keys.map(keyName)[0] ?? ''}: ${directionOf(control.name)}` },
          element('kbd', {}, keyCap(control.keys[0] ?? '?')),
          directionOf(control.name),
        ),
      ),
    );
    const text = robot
      ? 'The robot flies to the goal that is marked ★; watch what it does.'
      : 'Come to rest at your goal: the amber one, marked ★.';
    const content = [
      element('p', {}, text),
      ...(robot ? [] : [element('p', { class: 'mode-title' }, this.ruleTitle()), ...this.inferenceNote(), keys]),
      ...(!robot && this.run!.hasAxes ? [element('p', { class: 'drag' }, DRAG)] : []),
      element('p', { class: 'hint' }, otherKeys(robot ? [] : opening.controls)),
    ];
    this.card.show('ready', robot ? 'Watch the robot' : 'Ready to fly', content, [
      { label: 'Start', key: '⏎', primary: true, press: () => this.begin() },
    ]);
  }

  /** What the rule does, and its parameters. */
  private ruleTitle(): string {
    const { mode } = this.controls;
    const parameters = parametersOf(this.run!.opening.setup.rule);
    return parameters === '' ? mode.title : `${mode.title.replace(/\.$/, '')}; ${parameters}`;
  }

  /** Says so where the goal is inferred otherwise than was chosen; who flies alone has no use for it. */
  private inferenceNote(): HTMLElement[] {
    const { controls, settings, context } = this;
    if (controls.mode.mode === 'hic') return [];
    const { note } = context.hangar.inferring(controls.task, settings.values, settings.inference);
    return note === null ? [] : [element('p', { class: 'mode-title' }, note)];
  }

  private showPaused(): void {
    this.card.show(
      'paused',
      'Paused',
      [element('p', {}, 'All keys were released; the time stands still.')],
      [
        { label: 'Go on', key: '⏎', primary: true, press: () => this.begin() },
        { label: 'End this flight', press: () => this.run?.abandon() },
      ],
    );
  }

  private showUnable(why: string): void {
    this.card.show(
      'unable',
      'No help to be had',
      [element('p', {}, why)],
      [{ label: 'Fly alone', key: '⏎', primary: true, press: () => this.change({ mode: 'hic' }) }],
    );
  }

  /** What cannot go on says why; a loop that stopped is loaded afresh. */
  private async failed(error: unknown): Promise<void> {
    this.context.link.end('abandoned');
    const stopped = error instanceof CoreStopped;
    if (stopped) await this.context.core.revive();
    else if (this.run === null) this.preview();
    const actions: CardAction[] = [{ label: 'Try again', key: '⏎', primary: true, press: () => void this.prepare() }];
    if (this.controls.mode.mode !== 'hic')
      actions.push({ label: 'Fly alone', press: () => this.change({ mode: 'hic' }) });
    this.card.show(
      'failed',
      stopped ? 'The loop stopped' : 'Not ready to fly',
      [
        element('p', {}, sentence(reasonOf(error))),
        ...(stopped
          ? [
              element(
                'p',
                {},
                'That is a bug, and worth a report. It was loaded afresh; the flight was kept as far as it got.',
              ),
            ]
          : []),
      ],
      actions,
    );
  }

  /** The world, without anybody who could fly in it: better to look at than nothing. */
  private preview(): void {
    try {
      this.makeReady(this.unassisted(Math.floor(Math.random() * 2 ** 48)));
    } catch {
      // Why nothing can be flown is said on the card already.
    }
  }

  private async modelsChanged(learnt: boolean): Promise<void> {
    this.controls.build();
    if (this.run === null) await this.prepare();
    else if (this.run.isReady) await this.prepare(this.run.opening.setup.seed);
    else if (this.run.isOver && learnt) this.card.note('✦ The co-pilot has learnt from it.');
  }

  private shortcut(event: KeyboardEvent): void {
    if (isTheirs(event) || event.repeat || event.ctrlKey || event.metaKey || event.altKey) return;
    if (isEnter(event)) {
      event.preventDefault();
      this.goOn();
    } else if (event.code === 'Escape') {
      this.run?.pause();
    } else if (event.code === 'KeyO') {
      this.toggleOverlay();
    } else if (event.code === 'KeyR' && this.run?.isOver === true && this.context.session.last !== null) {
      this.context.go('again');
    }
  }

  /** What Enter does: what the card's first button would, also while the card is still to come. */
  private goOn(): void {
    if (!this.card.pressPrimary() && this.run?.isOver === true) void this.again();
  }

  private showHud(): void {
    const { run } = this;
    if (run !== null) this.hud.show(run.ticks / run.opening.ticks_per_second, run.held(), this.stage.readings);
  }

  private toggleOverlay(): void {
    this.settings.overlay = !this.settings.overlay;
    keepSettings(this.settings);
    this.showOverlay();
    this.controls.build();
  }

  private showOverlay(): void {
    this.main.classList.toggle('with-overlay', this.settings.overlay);
    this.overlay.node.hidden = !this.settings.overlay;
  }

  private change(changed: Partial<Settings>): void {
    Object.assign(this.settings, changed);
    keepSettings(this.settings);
    const seed = this.run?.isReady === true && !('plant' in changed) ? this.run.opening.setup.seed : undefined;
    this.run?.abandon();
    this.controls.build();
    this.prepare(this.controls.seed ?? seed).catch((error: unknown) => say(reasonOf(error)));
  }
}

function numbersOf(summary: FlightSummary, robot: boolean): HTMLElement {
  const share = summary.commands === 0 ? '–' : `${Math.round((100 * summary.corrected) / summary.commands)} %`;
  const number = (value: string, label: string) => element('span', {}, element('b', {}, value), label);
  return element(
    'div',
    { class: 'numbers' },
    number(`${summary.seconds.toFixed(1)} s`, 'to the end'),
    ...(robot ? [] : [number(String(summary.commands), 'commands'), number(share, 'corrected')]),
  );
}
