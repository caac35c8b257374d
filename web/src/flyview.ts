// The view in which a person flies.

import { chooseModels, listModels, modelBytes, type ModelEntry } from './api';
import type { Core, Inference, Setup } from './core';
import { button, element } from './dom';
import { Stage } from './draw';
import { FlightRun, type FlightSummary } from './flightview';
import { keyCap } from './keys';
import type { Link } from './link';
import type { View } from './main';
import { say } from './message';
import { Overlay } from './overlay';
import { loadSettings, keepSettings, MODES, type Settings } from './settings';
import { ENDINGS } from './words';

const ACTIONS: Record<string, string> = {
  switches: 'switches (the paper)', 'main-side': 'main × side, held', gymnasium: 'Gymnasium’s four',
};
const INFERENCES: Record<string, string> = {
  calibrated: 'calibrated', softmax: 'softmax', 'inverse-distance': 'inverse distance (the paper)',
};

export class FlyView implements View {
  readonly main = element('main', { class: 'flight' });
  readonly footer = element('footer', {});
  private readonly settings: Settings = loadSettings();
  private readonly stage: Stage;
  private readonly overlay = new Overlay();
  private readonly card = element('div', { class: 'card', role: 'dialog', 'aria-live': 'polite' });
  private readonly hud = element('div', { class: 'hud' });
  private readonly caps: HTMLElement[] = [];
  private readonly clock = element('span', {});
  private run: FlightRun | null = null;
  private models: ModelEntry[] = [];
  private readonly loaded = new Set<string>();
  private readonly onKey = (event: KeyboardEvent) => this.shortcut(event);
  private readonly onHide = () => this.run?.pause();

  constructor(private readonly core: Core, private readonly link: Link) {
    const canvas = element('canvas', { 'aria-label': 'The lander, its flames, the terrain and the flags' });
    const calm = matchMedia('(prefers-reduced-motion: reduce)').matches;
    this.stage = new Stage(canvas, calm);
    this.main.append(element('div', { class: 'stage' }, canvas, this.hud, this.card), this.overlay.node);
    this.buildFooter();
    this.showOverlay();
    window.addEventListener('keydown', this.onKey);
    window.addEventListener('blur', this.onHide);
    document.addEventListener('visibilitychange', this.onHide);
    link.onNewModel = () => void this.refreshModels();
    void this.refreshModels().then(() => this.prepare());
  }

  dispose(): void {
    this.run?.abandon();
    this.run?.dispose();
    window.removeEventListener('keydown', this.onKey);
    window.removeEventListener('blur', this.onHide);
    document.removeEventListener('visibilitychange', this.onHide);
    this.link.onNewModel = null;
  }

  private async refreshModels(): Promise<void> {
    try {
      this.models = await listModels();
    } catch (error) {
      say(`The list of models could not be read: ${String(error)}`);
    }
  }

  /** Gets the next flight ready: terrain and flags are there to be looked at, nothing moves yet. */
  private async prepare(): Promise<void> {
    this.run?.dispose();
    this.run = null;
    try {
      const setup = await this.setup();
      this.run = new FlightRun(this.core, setup, this.stage, {
        tick: (tick) => {
          this.overlay.show(tick);
          this.showHud();
        },
        paused: (paused) => (paused ? this.showPaused() : this.card.toggleAttribute('hidden', true)),
        ended: (summary) => this.ended(summary),
      }, this.link);
      this.overlay.begin(setup.rule, this.run.opening.pilot_goal);
      this.buildHud();
      this.showReady();
    } catch (error) {
      this.showCard('Not ready to fly', [element('p', {}, error instanceof Error ? error.message : String(error))], []);
    }
  }

  private async setup(): Promise<Setup> {
    const { settings } = this;
    const about = this.core.about().plants.find((plant) => plant.name === settings.plant);
    if (about === undefined) throw new Error(`This page knows no plant called ${settings.plant}.`);
    const options = settings.plant === 'flag-lander' ? { actions: settings.actions } : {};
    const task = { plant: settings.plant, options };
    const { values, intent } = chooseModels(this.models, task);
    const mode = MODES.find((known) => known.mode === settings.mode) ?? MODES[0]!;
    const networks = values !== null && intent !== null;
    if (settings.plant === 'flag-lander' && !networks && settings.mode !== 'hic') {
      throw new Error('There is no trained co-pilot for these actions; choose others, or fly alone.');
    }
    for (const hash of [values, intent]) await this.load(hash);
    const inference: Inference = settings.mode === 'demo' ? 'known' : intent === null ? 'nearest' : settings.inference;
    return {
      task, plant_version: about.version, seed: Math.floor(Math.random() * 2 ** 48), rule: mode.rule, inference,
      silence: 'best', time_scale: settings.timeScale, values, intent: inference === 'known' || inference === 'nearest' ? null : intent,
      pilot: 'person',
    };
  }

  private async load(hash: string | null): Promise<void> {
    if (hash === null || this.loaded.has(hash)) return;
    this.core.addModel(await modelBytes(hash));
    this.loaded.add(hash);
  }

  private ended(summary: FlightSummary): void {
    this.link.end(summary.ending);
    const share = summary.commands === 0 ? '–' : `${Math.round((100 * summary.corrected) / summary.commands)} %`;
    const number = (value: string, label: string) => element('span', {}, element('b', {}, value), label);
    const numbers = element('div', { class: 'numbers' },
      number(`${summary.seconds.toFixed(1)} s`, 'in the air'), number(String(summary.commands), 'commands'), number(share, 'corrected'));
    const late = summary.lateTicks > 5 ? [element('p', {}, `${summary.lateTicks} ticks came late: is something else busy on this machine?`)] : [];
    this.showCard(ENDINGS[summary.ending], [numbers, ...late], [
      button('Fly again  ⏎', { class: 'primary' }, () => void this.prepare().then(() => this.begin())),
    ], summary.ending);
  }

  private begin(): void {
    if (this.run === null) return;
    this.card.hidden = true;
    if (this.run.isReady) this.link.begin(this.run.opening.setup);
    this.run.start();
  }

  private showReady(): void {
    const { opening } = this.run!;
    const robot = this.settings.mode === 'demo';
    const keys = element('div', { class: 'keys' }, ...opening.controls.map((control) =>
      element('span', {}, element('kbd', {}, control.keys.map(keyCap)[0] ?? '?'), control.name)));
    const text = robot ? 'The robot flies to the amber flags; watch what it does.'
      : 'Come to rest between the amber flags.';
    this.showCard(robot ? 'Watch the robot' : 'Ready to fly', [element('p', {}, text), ...(robot ? [] : [keys])],
      [button('Start  ⏎', { class: 'primary' }, () => this.begin())]);
  }

  private showPaused(): void {
    this.showCard('Paused', [element('p', {}, 'All keys were released.')], [
      button('Go on  ⏎', { class: 'primary' }, () => this.begin()),
      button('Stop', { class: 'secondary' }, () => this.run?.abandon()),
    ]);
  }

  private showCard(title: string, content: HTMLElement[], actions: HTMLElement[], outcome = ''): void {
    this.card.dataset['outcome'] = outcome;
    this.card.replaceChildren(element('h2', {}, title), ...content, element('div', { class: 'actions' }, ...actions));
    this.card.hidden = false;
  }

  private shortcut(event: KeyboardEvent): void {
    if (event.target instanceof HTMLSelectElement || event.target instanceof HTMLInputElement) return;
    if (event.code === 'Enter' && !event.repeat) {
      event.preventDefault();
      if (this.run?.isOver === true || this.run === null) void this.prepare().then(() => this.begin());
      else this.begin();
    } else if (event.code === 'Escape') {
      this.run?.pause();
    } else if (event.code === 'KeyO') {
      this.settings.overlay = !this.settings.overlay;
      this.showOverlay();
      keepSettings(this.settings);
    }
  }

  private buildHud(): void {
    this.caps.length = 0;
    const pressed = element('span', { class: 'pressed' });
    for (const control of this.run!.opening.controls) {
      const cap = element('kbd', { title: control.name }, control.keys.map(keyCap)[0] ?? '?');
      this.caps.push(cap);
      pressed.append(cap);
    }
    this.hud.replaceChildren(this.clock, pressed);
    this.clock.textContent = '0.0 s';
  }

  private showHud(): void {
    const held = this.run?.held() ?? new Set<number>();
    this.caps.forEach((cap, control) => cap.classList.toggle('held', held.has(control)));
    const seconds = (this.run?.ticks ?? 0) / (this.run?.opening.ticks_per_second ?? 50);
    this.clock.textContent = `${seconds.toFixed(1)} s`;
  }

  private showOverlay(): void {
    this.main.classList.toggle('with-overlay', this.settings.overlay);
    this.overlay.node.hidden = !this.settings.overlay;
  }

  private buildFooter(): void {
    const modes = element('div', { class: 'segmented', role: 'group', 'aria-label': 'Mode' });
    for (const { mode, label, title } of MODES) {
      modes.append(button(label, { title, 'data-mode': mode, 'aria-pressed': String(mode === this.settings.mode) }, () => {
        for (const item of modes.children) item.setAttribute('aria-pressed', String((item as HTMLElement).dataset['mode'] === mode));
        this.change({ mode });
      }));
    }
    const select = (label: string, choices: Record<string, string>, chosen: string, choose: (value: string) => void) => {
      const box = element('select', { 'aria-label': label });
      for (const [value, text] of Object.entries(choices)) box.append(element('option', { value, selected: value === chosen }, text));
      box.addEventListener('change', () => {
        choose(box.value);
        box.blur();
      });
      return element('label', {}, label, box);
    };
    const plants = Object.fromEntries(this.core.about().plants.map((plant) => [plant.name, plant.name]));
    this.footer.append(modes,
      select('plant', plants, this.settings.plant, (plant) => this.change({ plant })),
      select('actions', ACTIONS, this.settings.actions, (actions) => this.change({ actions })),
      select('confidence', INFERENCES, this.settings.inference, (inference) => this.change({ inference: inference as Inference })),
      select('speed', { '1': '1×', '0.75': '¾×', '0.5': '½×', '0.25': '¼×' }, String(this.settings.timeScale),
        (scale) => this.change({ timeScale: Number(scale) })),
      element('span', { class: 'spacer' }),
      button('Overlay (O)', { class: 'secondary' }, () => {
        this.settings.overlay = !this.settings.overlay;
        this.showOverlay();
        keepSettings(this.settings);
      }));
  }

  private change(changed: Partial<Settings>): void {
    Object.assign(this.settings, changed);
    keepSettings(this.settings);
    (document.activeElement as HTMLElement | null)?.blur();
    this.run?.abandon();
    void this.prepare();
  }
}
