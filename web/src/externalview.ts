// The view in which a person flies a plant that is elsewhere. It cannot be paused: who looks away lets go.

import { Card } from './card';
import type { Context, View } from './context';
import type { Control, KeyKind, Pose, Tick } from './core';
import { element, isTheirs, select } from './dom';
import { ExternalLink, type ExternalEnd, type ExternalReady } from './external';
import { PadListener, type Stick } from './gamepad';
import { History } from './history';
import { Hud } from './hud';
import { keyCap, keyName, KeyListener } from './keys';
import { Overlay } from './overlay';
import { PointerStick } from './pointer';
import { keepSettings, loadSettings, MODES, type ModeEntry, type Settings } from './settings';
import { Stage } from './stage';
import { DRAG, ENDING_HINTS, ENDINGS, sentence } from './words';

/** Robots fly alone nowhere else than where a person holds on: that mode has no place here. */
const OFFERED = MODES.filter((entry) => entry.mode !== 'demo');
/** How often sticks are asked, ms. */
const ASK_EVERY_MS = 20;

/** What a person steers a flight by. */
class Hands {
  private readonly keys: KeyListener;
  private readonly pad: PadListener;
  private readonly pointer: PointerStick | null;
  private timer = 0;

  constructor(
    controls: Control[],
    hasAxes: boolean,
    surface: HTMLElement,
    private readonly key: (kind: KeyKind, control: number, atMs: number) => void,
    stick: (stick: Stick, atMs: number) => void,
  ) {
    this.keys = new KeyListener(controls, key);
    this.pad = new PadListener(controls, hasAxes, key, stick);
    this.pointer = hasAxes ? new PointerStick(surface, controls, () => this.timer !== 0, stick) : null;
  }

  attach(): void {
    this.keys.attach(window);
    this.pointer?.attach();
    this.timer = window.setInterval(() => {
      const now = performance.now();
      this.pad.poll(now);
      this.pointer?.poll(now);
    }, ASK_EVERY_MS);
  }

  detach(): void {
    clearInterval(this.timer);
    this.timer = 0;
    this.keys.detach();
    this.pointer?.detach();
  }

  letGo(): void {
    const now = performance.now();
    this.keys.releaseAll(now);
    this.pad.releaseAll(now);
    this.pointer?.releaseAll(() => this.key('release-all', 0, now));
  }

  held(): ReadonlySet<number> {
    return new Set([...this.keys.heldControls(), ...this.pad.heldControls()]);
  }
}

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
  private frame = 0;
  private disposed = false;
  private readonly onKey = (event: KeyboardEvent) => this.shortcut(event);
  private readonly onLeave = () => this.hands?.letGo();

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
    return OFFERED.find((entry) => entry.mode === this.settings.mode) ?? OFFERED[0]!;
  }

  /** What is flown: alone, where no values fit. */
  private modeOf(plant: ExternalReady): ModeEntry {
    return plant.has_values ? this.mode : OFFERED[0]!;
  }

  private prepare(): void {
    this.state = 'waiting';
    this.hands?.detach();
    this.hands = null;
    this.link ??= this.connect();
    this.link.begin(Math.floor(Math.random() * 2 ** 48), this.mode.rule);
  }

  private connect(): ExternalLink {
    const scheme = location.protocol === 'https:' ? 'wss' : 'ws';
    const link: ExternalLink = new ExternalLink(`${scheme}://${location.host}/ws/external`, {
      ready: (plant) => this.ready(plant),
      tick: (tick) => this.tick(tick),
      ended: (end) => this.ended(end),
      refused: (reason) => this.unable(reason),
      closed: () => {
        if (this.link !== link || this.disposed) return;
        this.link = null;
        this.unable('the connection to the server is gone; what was flown is stored there');
      },
    });
    return link;
  }

  private ready(plant: ExternalReady): void {
    const { opening, has_axes: hasAxes } = plant;
    this.plant = plant;
    this.state = 'ready';
    this.older = this.newer = opening.poses;
    this.stage.show(opening.scene, opening.pilot_goal, opening.setup.seed, opening.ticks_per_second);
    this.history = new History();
    this.overlay.begin(opening.setup.rule, opening.pilot_goal, opening.goals, []);
    this.hud.begin(opening, this.modeOf(plant).label, plant.name);
    const since = () => performance.now() - this.startedAt;
    this.hands = new Hands(
      opening.controls,
      hasAxes,
      this.stage.canvas,
      (kind, control) => this.flies && this.link?.key(kind, control, since()),
      (stick) => this.flies && this.link?.stick(stick, since()),
    );
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
    this.card.hide();
    this.field.focus();
    this.showFooter();
    this.hands?.attach();
    this.link?.start();
  }

  private tick(tick: Tick): void {
    if (this.state !== 'flying') return;
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

  private draw(now: number): void {
    this.frame = requestAnimationFrame((next) => this.draw(next));
    if (this.plant === null) return;
    const tickMs = 1000 / this.plant.opening.ticks_per_second;
    const part = this.state === 'flying' ? Math.min((now - this.newerAt) / tickMs, 1) : 1;
    this.stage.draw(this.older, this.newer, Math.max(part, 0), now, true);
  }

  private ended(end: ExternalEnd): void {
    this.state = 'ended';
    this.hands?.detach();
    this.stage.end(end.ending);
    this.showFooter();
    if (end.episode !== null) this.context.onStored.forEach((told) => told(end.episode!));
    const seconds = end.ticks / (this.plant?.opening.ticks_per_second ?? 50);
    const told = end.why === null ? ENDING_HINTS[end.ending] : sentence(end.why);
    const numbers = `${seconds.toFixed(1)} s, ${end.commands} commands, ${end.corrected} of them corrected, ${end.late} ticks late.`;
    const actions = [{ label: 'Fly again', key: '⏎', primary: true, press: () => this.prepare() }];
    const watch =
      end.episode === null ? [] : [{ label: 'Watch it', press: () => this.context.go(`episodes/${end.episode}`) }];
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
    this.showFooter();
    this.card.show(
      'unable',
      'The plant is not ready',
      [element('p', {}, sentence(reason))],
      [{ label: 'Try again', key: '⏎', primary: true, press: () => this.prepare() }],
    );
  }

  private showReady(plant: ExternalReady): void {
    const { name, has_axes: hasAxes, has_values: hasValues, opening } = plant;
    const keys = opening.controls.map((control) =>
      element(
        'span',
        { 'aria-label': `${control.keys.map(keyName)[0] ?? ''}: ${control.name}` },
        element('kbd', {}, keyCap(control.keys[0] ?? '?')),
        control.name,
      ),
    );
    const alone = hasValues || this.mode.mode === 'hic' ? [] : ['No values fit this plant, so there is no co-pilot.'];
    this.card.show(
      'ready',
      `Ready: ${name}`,
      [
        element('p', {}, 'It is elsewhere and cannot be paused: let go of everything, or look away, and it stops.'),
        element('p', { class: 'mode-title' }, this.modeOf(plant).title),
        ...alone.map((text) => element('p', {}, text)),
        element('div', { class: 'keys' }, ...keys),
        ...(hasAxes ? [element('p', { class: 'drag' }, DRAG)] : []),
      ],
      [{ label: 'Start', key: '⏎', primary: true, press: () => this.start() }],
    );
  }

  private showFooter(): void {
    const modes = OFFERED.map(({ mode, label }): [string, string] => [mode, label]);
    const box = select('Mode', modes, this.mode.mode, (mode) => {
      this.settings.mode = mode as Settings['mode'];
      keepSettings(this.settings);
      if (this.state !== 'flying') this.prepare();
    });
    box.querySelector('select')!.disabled = this.state === 'flying';
    this.footer.replaceChildren(box);
  }

  private shortcut(event: KeyboardEvent): void {
    if (isTheirs(event) || event.repeat || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.code === 'Enter') {
      event.preventDefault();
      this.card.pressPrimary();
    } else if (event.code === 'Escape') {
      this.link?.stop();
    } else if (event.code === 'KeyO') {
      this.settings.overlay = !this.settings.overlay;
      keepSettings(this.settings);
      this.overlay.node.hidden = !this.settings.overlay;
      this.main.classList.toggle('with-overlay', this.settings.overlay);
    }
  }
}
