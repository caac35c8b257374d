// One flight on the screen, from its first picture until the server has it: ready, countdown, in the air, paused, ended.

import { Card, type CardAction } from '../../src/card';
import { CoreStopped, type Control, type Ending, type Setup, type Tick } from '../../src/core';
import { element, isEnter, isTheirs, wantsCalm } from '../../src/dom';
import { FlightRun, type FlightSummary, type KeyLog } from '../../src/flight';
import { PadConfirm } from '../../src/gamepad';
import { Hud } from '../../src/hud';
import { keyCap, keyName } from '../../src/keys';
import { Meter, type Measured } from '../../src/meter';
import { toHex } from '../../src/protocol';
import { keyEvents, type LoggedKey } from '../../src/record';
import { Stage } from '../../src/stage';
import { reasonOf, sentence } from '../../src/words';
import type { Deck, Delivery } from './deck';
import { longer, type Source } from './resume';
import type { FlightWords } from './words';

/** How long an ending is watched before what comes next comes, ms. */
const WATCH_ENDING_MS = 900;
/** How often the flight in the air is kept, ms. */
const KEEP_EVERY_MS = 200;
/** A delivery that takes longer than this is spoken of, ms. */
const SAVING_MS = 700;
const COUNTDOWN_S = 3;

/** A flight that is to be flown. */
export interface Plan {
  setup: Setup;
  /** 32 hexadecimal digits; drawn at random if null. */
  key: string | null;
  /** Above the time: what this flight is called. */
  heading: string;
  /** Beside the time: what the mode is called. */
  label: string;
  /** Whether it is said how it ended. */
  feedback: boolean;
  words: FlightWords;
  /** The keys that the person chose. */
  bind: (controls: Control[]) => Control[];
  /** How long the display shows a frame, ms. */
  frameMs?: number | undefined;
  /** What the server committed of it, if it can be asked. */
  committed: () => Promise<KeyLog | null>;
  events: PlanEvents;
}

/** What happens on the way; a study notes it. */
export interface PlanEvents {
  begun?(): void;
  resumed?(back: ComeBack): void;
  /** The flight came into the air, or left it. */
  inTheAir?(flying: boolean): void;
}

/** A flight that goes on after an interruption. */
export interface ComeBack {
  /** Ticks flown before. */
  tick: number;
  /** Why it was interrupted, as far as that was seen. */
  reason: string;
  source: Source;
  awayMs: number;
}

/** A flight that was flown. */
export interface Flown {
  key: string;
  ending: Ending;
  ticks: number;
  log: LoggedKey[];
  measured: Measured;
  delivery: Delivery;
}

/** Shows one flight. */
export class FlightShow {
  readonly node: HTMLElement;
  private readonly stage: Stage;
  private readonly card = new Card();
  private readonly hud = new Hud();
  private readonly count = element('div', { class: 'countdown', hidden: true, 'aria-hidden': 'true' });
  private readonly confirm = new PadConfirm(() => this.card.pressPrimary());
  private readonly key: string;
  private readonly listeners = new AbortController();
  private run: FlightRun | null = null;
  private begunAt = Date.now();
  private lastKeptAt = 0;
  private counting = 0;
  /** The page is being left: what happens now is part of leaving, not of the flight. */
  private isLeft = false;
  private finish: (flown: Flown) => void = () => {};
  private over = false;

  constructor(
    private readonly deck: Deck,
    private readonly plan: Plan,
  ) {
    this.key = plan.key ?? toHex(crypto.getRandomValues(new Uint8Array(16)));
    const front = element('canvas', { class: 'front', role: 'img', 'aria-label': plan.words.canvas });
    const back = element('canvas', { class: 'back', 'aria-hidden': 'true' });
    this.stage = new Stage(back, front, { away: plan.words.away, own: plan.words.own });
    this.node = element(
      'div',
      { class: 'stage', tabindex: '-1' },
      back,
      front,
      this.hud.node,
      this.count,
      this.card.node,
      this.card.voice,
    );
  }

  /** Flies it; the node must be in the page. */
  async fly(): Promise<Flown> {
    const flown = new Promise<Flown>((resolve) => (this.finish = resolve));
    this.listen();
    await this.prepare();
    return flown;
  }

  /** Holds the flight, as Esc does: something else needs the person's attention. */
  hold(): void {
    this.stopCountdown();
    if (this.run?.isFlying === true) this.run.pause();
  }

  /** Lets go of everything; a flight in the air is kept and goes on later. */
  dispose(): void {
    if (this.over) return;
    this.keep('another-tab');
    this.deck.link.forget();
    this.letGo();
  }

  private letGo(): void {
    this.over = true;
    this.listeners.abort();
    this.confirm.dispose();
    clearInterval(this.counting);
    this.run?.dispose();
    this.card.hide();
    this.plan.events.inTheAir?.(false);
  }

  private listen(): void {
    const { signal } = this.listeners;
    window.addEventListener('keydown', (event) => this.shortcut(event), { signal });
    window.addEventListener('blur', () => this.hold(), { signal });
    window.addEventListener('pagehide', () => this.leave(), { signal });
    window.addEventListener('pageshow', () => (this.isLeft = false), { signal });
    document.addEventListener(
      'visibilitychange',
      () => {
        if (document.hidden) this.hold();
        if (this.run !== null && !this.run.isReady) this.run.meter.hides(document.hidden, performance.now());
        this.keep();
      },
      { signal },
    );
  }

  private async prepare(): Promise<void> {
    const { words, setup } = this.plan;
    this.card.show('loading', words.loading, [element('p', {}, words.loadingText)], [], SAVING_MS);
    try {
      await this.deck.equip(setup);
      const kept = this.deck.keeper.kept(this.key);
      const from = longer(kept, await this.plan.committed());
      if (this.over) return;
      this.begunAt = kept?.begunAt ?? Date.now();
      this.makeReady(from !== null, kept?.measured);
      if (from === null) this.showReady();
      else
        this.goOn(from.log, {
          tick: from.log.ticks,
          reason: kept?.left ?? 'page-lost',
          source: from.source,
          awayMs: Math.max(Math.round(Date.now() - (kept?.keptAt ?? Date.now())), 0),
        });
    } catch (error) {
      await this.failed(error);
    }
  }

  private makeReady(goesOn: boolean, measured: Measured | undefined): void {
    const { setup, label, heading, bind, words, frameMs } = this.plan;
    this.run?.dispose();
    const run = new FlightRun(
      this.deck.core,
      setup,
      hasAxes(this.deck, setup),
      this.stage,
      {
        tick: (tick) => this.ticked(tick),
        paused: (paused) => this.paused(paused),
        ended: (summary) => void this.ended(summary),
        failed: (error) => void this.failed(error),
      },
      this.deck.link,
      {
        bind,
        nameOf: words.control,
        plain: true,
        meter: new Meter(frameMs, measured),
        ...(goesOn ? { begunAt: this.begunAt } : {}),
      },
    );
    this.run = run;
    const controls = bind(run.opening.controls).map((control) => ({ ...control, name: words.control(control.name) }));
    this.hud.begin({ ...run.opening, controls }, label, heading, words.tilt);
  }

  /** Flies the log again and waits for the person. */
  private goOn(log: KeyLog, back: ComeBack): void {
    const run = this.run!;
    this.announce();
    run.goOnFrom(log);
    this.showHud();
    if (run.isOver) return;
    const { words, events } = this.plan;
    this.card.show(
      'interrupted',
      words.interrupted,
      [element('p', {}, words.interruptedText)],
      [
        {
          label: words.goOn,
          key: '⏎',
          primary: true,
          press: () =>
            this.countDown(() => {
              run.meter.cameBack(back.awayMs);
              events.resumed?.(back);
              this.start();
            }),
        },
      ],
    );
  }

  private showReady(): void {
    const { words, heading, bind } = this.plan;
    const keys = element(
      'div',
      { class: 'keys' },
      ...bind(this.run!.opening.controls).map(({ name, keys: [key] }) =>
        element(
          'span',
          { 'aria-label': `${keyName(key ?? '')}: ${words.control(name)}` },
          element('kbd', {}, keyCap(key ?? '?')),
          words.control(name),
        ),
      ),
    );
    this.card.show(
      'ready',
      heading === '' ? words.ready : heading,
      [element('p', {}, words.task), keys, ...(this.run!.hasAxes ? [element('p', { class: 'drag' }, words.drag)] : [])],
      [{ label: words.start, key: '⏎', primary: true, press: () => this.begin() }],
    );
  }

  /** The server hears of it before the countdown, so that what is said of the flight is there when its log comes. */
  private begin(): void {
    this.plan.events.begun?.();
    this.countDown(() => this.takeOff());
  }

  private takeOff(): void {
    this.begunAt = Date.now();
    this.announce();
    this.start();
  }

  /** Begins the flight at the server; one that it refuses is not flown to its end. */
  private announce(): void {
    this.deck.begin(this.plan.setup, this.key, this.begunAt);
    void this.deck.delivered(this.key).then((delivery) => {
      if (!('refused' in delivery) || this.over || this.run?.isOver !== false) return;
      this.hold();
      void this.conclude('abandoned', delivery);
    });
  }

  private start(): void {
    this.card.hide();
    this.node.focus();
    this.run?.start();
    this.plan.events.inTheAir?.(true);
  }

  /** Counts 3, 2, 1, then goes; whatever holds the flight holds the count too. */
  private countDown(go: () => void): void {
    this.card.hide();
    this.node.focus();
    clearInterval(this.counting);
    let left = COUNTDOWN_S;
    const show = () => (this.count.textContent = String(left));
    this.count.hidden = false;
    show();
    this.counting = window.setInterval(() => {
      left -= 1;
      if (left > 0) show();
      else {
        this.endCountdown();
        go();
      }
    }, 1000);
  }

  private endCountdown(): void {
    clearInterval(this.counting);
    this.counting = 0;
    this.count.hidden = true;
  }

  /** A countdown that was held begins anew when the person is back. */
  private stopCountdown(): void {
    if (this.counting === 0) return;
    this.endCountdown();
    this.card.reshow();
  }

  private paused(paused: boolean): void {
    if (!paused) {
      this.card.hide();
      return;
    }
    const { words } = this.plan;
    this.keep();
    this.showHud();
    this.card.show(
      'paused',
      words.paused,
      [element('p', {}, words.pausedText)],
      [{ label: words.goOn, key: '⏎', primary: true, press: () => this.countDown(() => this.start()) }],
    );
  }

  private ticked(tick: Tick): void {
    this.showHud();
    const now = performance.now();
    if (tick.ending === null && now - this.lastKeptAt < KEEP_EVERY_MS) return;
    this.lastKeptAt = now;
    this.keep();
  }

  private keep(left?: string): void {
    const { run } = this;
    if (run === null || this.over || this.isLeft || run.isReady) return;
    try {
      const [log, measured] = [run.log(), run.measured()];
      const why = left === undefined ? {} : { left };
      this.deck.keeper.keep(this.key, { ...log, begunAt: this.begunAt, keptAt: Date.now(), ...why, measured });
    } catch {
      // The loop stopped; what was kept of the flight a moment ago is what it goes on from.
    }
  }

  /** The page is being left: the last ticks are kept. The server hears of it when the flight goes on. */
  private leave(): void {
    const { run } = this;
    if (run === null || run.isReady || run.isOver) return;
    this.keep('page-left');
    this.isLeft = true;
    this.hold();
  }

  private async ended(summary: FlightSummary): Promise<void> {
    const { deck, plan } = this;
    plan.events.inTheAir?.(false);
    deck.link.end(summary.ending);
    this.showHud();
    this.keep();
    const watched = wantsCalm() ? 0 : WATCH_ENDING_MS;
    await (plan.feedback ? this.showEnding(summary, watched) : pause(watched));
    await this.conclude(summary.ending, await this.delivered());
  }

  private async conclude(ending: Ending, delivery: Delivery): Promise<void> {
    const run = this.run!;
    if ('refused' in delivery && !this.over) {
      await this.showRefused(delivery.refused);
      this.deck.keeper.forget(this.key);
    }
    if (this.over) return;
    this.letGo();
    const { key } = this;
    const log = keyEvents(run.log().events);
    this.finish({ key, ending, ticks: run.ticks, log, measured: run.measured(), delivery });
  }

  private showEnding(summary: FlightSummary, watched: number): Promise<void> {
    const { words } = this.plan;
    const content = [
      element('p', {}, words.hints[summary.ending]),
      element('p', { class: 'note' }, words.seconds(summary.seconds)),
    ];
    return this.ask(summary.ending, words.endings[summary.ending], content, words.next, watched);
  }

  /** Waits until the server has the flight, and says so if that takes long. */
  private async delivered(): Promise<Delivery> {
    const { words } = this.plan;
    const show = () => {
      const text = this.deck.link.isConnected ? words.saving : words.kept;
      this.card.show('saving', words.finished, [element('p', {}, text)], []);
    };
    const [late, still] = [window.setTimeout(show, SAVING_MS), window.setInterval(show, 4 * SAVING_MS)];
    const delivery = await this.deck.delivered(this.key);
    clearTimeout(late);
    clearInterval(still);
    return delivery;
  }

  private showRefused(reason: string): Promise<void> {
    const { words } = this.plan;
    const content = [element('p', {}, sentence(reason)), element('p', {}, words.refusedText)];
    return this.ask('failed', words.refused, content, words.next, 0);
  }

  private ask(kind: string, title: string, content: Node[], label: string, afterMs: number): Promise<void> {
    return new Promise((resolve) => {
      const press = () => {
        this.card.hide();
        resolve();
      };
      this.card.show(kind, title, content, [{ label, key: '⏎', primary: true, press }], afterMs);
    });
  }

  /** What cannot go on says why; a loop that stopped is loaded afresh, and the flight goes on from what was kept. */
  private async failed(error: unknown): Promise<void> {
    if (this.over) return;
    const { words } = this.plan;
    this.keep();
    this.deck.link.forget();
    if (error instanceof CoreStopped) await this.deck.core.revive();
    const again: CardAction = { label: words.again, key: '⏎', primary: true, press: () => void this.prepare() };
    this.card.show('failed', words.unable, [element('p', {}, sentence(reasonOf(error)))], [again]);
  }

  private shortcut(event: KeyboardEvent): void {
    if (isTheirs(event) || event.repeat || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.code === 'Escape') this.hold();
    if (isEnter(event) && this.card.pressPrimary()) event.preventDefault();
  }

  private showHud(): void {
    const { run } = this;
    if (run !== null) this.hud.show(run.ticks / run.opening.ticks_per_second, run.held(), this.stage.readings);
  }
}

/** Whether a stick is good for this task, which the loop shows by trying it. */
function hasAxes({ core }: Deck, setup: Setup): boolean {
  core.begin({ ...setup, rule: { rule: 'hic' }, inference: 'nearest', values: null, intent: null });
  return core.tick()?.candidates.some((candidate) => candidate.action.axes !== undefined) === true;
}

function pause(ms: number): Promise<void> {
  return new Promise((resolve) => setTimeout(resolve, ms));
}
