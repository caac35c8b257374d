// The view in which a person flies a plant that is elsewhere. It cannot be paused: who looks away lets go.

import { Card, sideFor } from './card';
import type { Context, View } from './context';
import type { Pose, Rule, Tick } from './core';
import { element, isEnter, isTheirs, select } from './dom';
import { ExternalLink, isAttended, type ExternalEnd, type ExternalReady } from './external';
import { Hands, type Told } from './hands';
import { History } from './history';
import { Hud } from './hud';
import { keyCap, keyName } from './keys';
import { Overlay } from './overlay';
import { usualRule, type Actions } from './rules';
import { keepSettings, loadSettings, modeOf, MODES, type ModeEntry, type Settings } from './settings';
import { Stage } from './stage';
import { DRAG, endingHint, ENDINGS, sentence } from './words';

/** Robots fly alone nowhere else than where a person holds on: that mode has no place here. */
const OFFERED = MODES.filter((entry) => entry.mode !== 'demo');
/** What is shown when the server has let go. */
const LET_GO = 'Let go: press again';

export class ExternalView implements View {
  readonly main = element('main', { class: 'flight' });
  readonly footer = element('footer', { class: 'controls' });
  private readonly settings: Settings = loadSettings();
  private readonly stage: Stage;
  private readonly overlay = new Overlay();
  private readonly card = new Card();
  private readonly hud = new Hud();
  private readonly field: HTMLElement;
  private history = new History();
  private link: ExternalLink | null = null;
  private plant: ExternalReady | null = null;
  private hands: Hands | null = null;
  private state: 'waiting' | 'ready' | 'flying' | 'ended' = 'waiting';
  private startedAt = 0;
  private older: Pose[] = [];
  private newer: Pose[] = [];
  private newerAt = 0;
  /** The newest tick that was told. */
  private newest: number | null = null;
  /** Why nothing can be drawn any more. */
  private blind: string | null = null;
  /** Says that everything was let go of, until something is pressed again. */
  private readonly again = element('p', { class: 'let-go', 'aria-hidden': 'true', hidden: true });
  /** How many wishes the server has yet to answer: what it says of any but the last is over. */
  private unanswered = 0;
  /** What the plant is steered by, as far as is known: what a rule lets through depends on it. */
  private actions: Actions = 'commands';
  private letGo = false;
  private frame = 0;
  private disposed = false;
  private readonly onKey = (event: KeyboardEvent) => this.shortcut(event);
  private readonly onLeave = () => {
    if (this.flies) this.nowLetGo();
  };

  constructor(private readonly context: Context) {
    const label = 'The plant, the ground and the goals; your own is marked';
    const canvas = element('canvas', { class: 'front', role: 'img', 'aria-label': label });
    const back = element('canvas', { class: 'back', 'aria-hidden': 'true' });
    this.stage = new Stage(back, canvas);
    this.field = element(
      'div',
      { class: 'stage', tabindex: '-1' },
      back,
      canvas,
      this.hud.node,
      this.again,
      this.card.node,
      this.card.voice,
    );
    this.main.append(this.field, this.overlay.node);
    this.overlay.node.hidden = !this.settings.overlay;
    this.main.classList.toggle('with-overlay', this.settings.overlay);
    window.addEventListener('keydown', this.onKey);
    window.addEventListener('blur', this.onLeave);
    document.addEventListener('visibilitychange', this.onLeave);
    this.frame = requestAnimationFrame((now) => this.draw(now));
    this.prepare();
  }

  dispose(): void {
    this.disposed = true;
    cancelAnimationFrame(this.frame);
    this.hands?.detach();
    this.link?.close();
    this.card.hide();
    window.removeEventListener('keydown', this.onKey);
    window.removeEventListener('blur', this.onLeave);
    document.removeEventListener('visibilitychange', this.onLeave);
  }

  private get mode(): ModeEntry {
    return this.settings.mode === 'demo' ? OFFERED[0]! : modeOf(this.settings);
  }

  /** What is flown: alone, where no values fit. */
  private flownMode(): ModeEntry {
    return this.plant?.has_values === false ? OFFERED[0]! : this.mode;
  }

  private rule(): Rule {
    return usualRule(this.mode.word, this.actions);
  }

  private prepare(): void {
    this.state = 'waiting';
    this.blind = null;
    this.hands?.detach();
    this.hands = null;
    this.link ??= this.connect();
    this.unanswered += 1;
    this.link.begin(Math.floor(Math.random() * 2 ** 48), this.rule());
  }

  private connect(): ExternalLink {
    const scheme = location.protocol === 'https:' ? 'wss' : 'ws';
    const link: ExternalLink = new ExternalLink(`${scheme}://${location.host}/ws/external`, {
      ready: (plant) => this.seeing(() => this.ready(plant)),
      tick: (tick, _late, letGo) => this.seeing(() => this.tick(tick, letGo)),
      ended: (end) => this.ended(end),
      refused: (reason) => {
        if (this.isAnswered()) this.unable(reason);
      },
      closed: () => {
        if (this.link !== link || this.disposed) return;
        this.link = null;
        this.unanswered = 0;
        // The card of a flight that has ended stays: its button connects anew.
        if (this.state === 'ended') return;
        this.unable('the connection to the server is gone; what was flown is stored there');
      },
    });
    return link;
  }

  /** Takes an answer of the server; true if it is the one to the last wish, or to none. */
  private isAnswered(): boolean {
    this.unanswered = Math.max(this.unanswered - 1, 0);
    return this.unanswered === 0;
  }

  private ready(plant: ExternalReady): void {
    if (!this.isAnswered()) return;
    const { opening, has_axes: hasAxes } = plant;
    this.plant = plant;
    const asked = JSON.stringify(this.rule());
    this.actions = hasAxes ? 'axes' : 'commands';
    if (plant.has_values && JSON.stringify(this.rule()) !== asked) {
      this.prepare();
      return;
    }
    this.state = 'ready';
    this.older = this.newer = opening.poses;
    this.stage.show(opening.scene, opening.pilot_goal, opening.setup.seed, opening.ticks_per_second);
    this.history = new History();
    this.overlay.begin(opening.setup.rule, opening.pilot_goal, opening.goals, []);
    this.hud.begin(opening, this.flownMode().label, plant.name);
    const since = () => performance.now() - this.startedAt;
    this.hands?.detach();
    const told: Told = {
      key: (kind, control) => {
        if (kind === 'down') this.pressed();
        if (this.flies) this.link?.key(kind, control, since());
      },
      stick: (stick) => {
        if (stick.some((axis) => axis !== 0)) this.pressed();
        if (this.flies) this.link?.stick(stick, since());
      },
    };
    this.hands = new Hands(opening.controls, hasAxes ? this.stage.canvas : null, told, isAttended, this.field);
    this.showFooter();
    this.showReady(plant);
  }

  private get flies(): boolean {
    return this.state === 'flying';
  }

  private start(): void {
    if (this.state !== 'ready') return;
    this.state = 'flying';
    this.startedAt = performance.now();
    this.newest = null;
    this.letGo = false;
    this.card.hide();
    this.field.focus();
    this.showFooter();
    this.hands?.attach();
    this.link?.start();
  }

  private tick(tick: Tick, letGo: boolean): void {
    if (this.state !== 'flying') return;
    this.newest = tick.tick;
    this.letGo = letGo;
    if (letGo) this.nowLetGo();
    this.older = this.newer;
    this.newer = tick.poses;
    this.newerAt = performance.now();
    this.stage.note(tick);
    this.history.push(tick);
    this.overlay.show(tick, this.history, this.history.outcomes.length);
    this.hud.show(
      (tick.tick + 1) / this.plant!.opening.ticks_per_second,
      this.hands?.held() ?? new Set(),
      this.stage.readings,
    );
  }

  private nowLetGo(): void {
    this.hands?.letGo();
    if (!this.again.hidden) return;
    this.again.textContent = LET_GO;
    this.again.hidden = false;
    this.card.voice.textContent = LET_GO;
  }

  private hideLetGo(): void {
    if (this.again.hidden) return;
    this.again.hidden = true;
    // What is said again later is read only if it was gone.
    this.card.voice.textContent = '';
  }

  /** What was let go of is pressed again. */
  private pressed(): void {
    if (!this.letGo) this.hideLetGo();
  }

  private draw(now: number): void {
    this.frame = requestAnimationFrame((next) => this.draw(next));
    const { plant } = this;
    if (plant !== null && this.blind === null) this.seeing(() => this.drawPlant(plant, now));
  }

  private drawPlant(plant: ExternalReady, now: number): void {
    const tickMs = 1000 / plant.opening.ticks_per_second;
    const part = this.flies ? Math.min((now - this.newerAt) / tickMs, 1) : 1;
    this.stage.draw(this.older, this.newer, Math.max(part, 0), now, true);
    if (this.flies && this.newest !== null) this.link?.shown(this.newest);
  }

  /** Shows something. A page that cannot does not fly: nobody sees what the machine does. */
  private seeing(show: () => void): void {
    try {
      show();
    } catch (error) {
      if (this.blind !== null) return;
      this.blind = `the picture cannot be drawn: ${error instanceof Error ? error.message : String(error)}`;
      // Nothing can be begun before this flight has ended; its end says the same, with what can be pressed.
      if (this.flies) {
        this.link?.stop();
        this.hands?.detach();
        this.card.show('unable', 'The flight is ended', [element('p', {}, sentence(this.blind))], []);
      } else if (this.state === 'ready' || this.state === 'waiting') this.unable(this.blind);
    }
  }

  private ended(end: ExternalEnd): void {
    this.state = 'ended';
    this.hands?.detach();
    this.hideLetGo();
    if (this.blind === null) this.seeing(() => this.stage.end(end.ending));
    this.showFooter();
    if (end.episode !== null) this.context.onStored.forEach((told) => told(end.episode!));
    const seconds = end.ticks / (this.plant?.opening.ticks_per_second ?? 50);
    const why = this.blind ?? end.why;
    const told = why === null ? endingHint(end.ending, { robot: false, commands: end.commands }) : sentence(why);
    const numbers = `${seconds.toFixed(1)} s, ${end.commands} commands, ${end.corrected} of them corrected, ${end.late} ticks late.`;
    const actions = [{ label: 'Fly again', key: '⏎', primary: true, press: () => this.prepare() }];
    const watch =
      end.episode === null ? [] : [{ label: 'Watch it', press: () => this.context.go(`episodes/${end.episode}`) }];
    this.card.stand(sideFor(this.stage.place));
    this.card.show(
      end.ending,
      ENDINGS[end.ending],
      [element('p', {}, told), element('p', {}, numbers)],
      [...actions, ...watch],
    );
  }

  private unable(reason: string): void {
    this.state = 'waiting';
    this.hands?.detach();
    this.hideLetGo();
    this.showFooter();
    this.card.show(
      'unable',
      'The plant is not ready',
      [element('p', {}, sentence(reason))],
      [{ label: 'Try again', key: '⏎', primary: true, press: () => this.prepare() }],
    );
  }

  private showReady(plant: ExternalReady): void {
    const { name, has_axes: hasAxes, why_alone: whyAlone, opening } = plant;
    const keys = opening.controls.map((control) =>
      element(
        'span',
        { 'aria-label': `${control.keys.map(keyName)[0] ?? ''}: ${control.name}` },
        element('kbd', {}, keyCap(control.keys[0] ?? '?')),
        control.name,
      ),
    );
    const alone = whyAlone === null || this.mode.mode === 'hic' ? [] : [sentence(whyAlone)];
    this.card.show(
      'ready',
      `Ready: ${name}`,
      [
        element('p', {}, 'It is elsewhere and cannot be paused: let go of everything, or look away, and it stops.'),
        element('p', { class: 'mode-title' }, this.flownMode().title),
        ...alone.map((text) => element('p', {}, text)),
        element('div', { class: 'keys' }, ...keys),
        ...(hasAxes ? [element('p', { class: 'drag' }, DRAG)] : []),
      ],
      [{ label: 'Start', key: '⏎', primary: true, press: () => this.start() }],
    );
  }

  private showFooter(): void {
    const why = this.plant?.has_values === false ? 'no co-pilot for this plant' : null;
    const entries = this.mode.mode === 'other' ? [...OFFERED, this.mode] : OFFERED;
    const modes = entries.map(({ mode, label }): [string, string, string | null] => [
      mode,
      label,
      mode === 'hic' ? null : why,
    ]);
    const box = select('Mode', modes, this.flownMode().mode, (mode) => {
      this.settings.mode = mode as Settings['mode'];
      keepSettings(this.settings);
      if (this.state !== 'flying') this.prepare();
    });
    box.querySelector('select')!.disabled = this.state === 'flying';
    box.title = this.plant?.why_alone == null ? '' : sentence(this.plant.why_alone);
    this.footer.replaceChildren(box);
  }

  private shortcut(event: KeyboardEvent): void {
    if (isTheirs(event) || event.repeat || event.ctrlKey || event.metaKey || event.altKey) return;
    if (isEnter(event)) {
      event.preventDefault();
      this.card.pressPrimary();
    } else if (event.code === 'Escape') {
      if (this.flies) this.link?.stop();
    } else if (event.code === 'KeyO') {
      this.settings.overlay = !this.settings.overlay;
      keepSettings(this.settings);
      this.overlay.node.hidden = !this.settings.overlay;
      this.main.classList.toggle('with-overlay', this.settings.overlay);
    }
  }
}
