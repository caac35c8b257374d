// The view in which recorded flights are looked at again.

import { episodeBytes, listEpisodes, listModels, modelBytes, type EpisodeEntry } from './api';
import type { Core } from './core';
import { button, element } from './dom';
import { Stage } from './draw';
import type { View } from './main';
import { say } from './message';
import { Overlay } from './overlay';
import { ReplayRun } from './replayview';
import { ENDING_WORDS } from './words';

export class EpisodesView implements View {
  readonly main = element('main', { class: 'page' });
  readonly footer = element('footer', {});
  private run: ReplayRun | null = null;
  private readonly loaded = new Set<string>();

  constructor(private readonly core: Core) {
    void this.list();
  }

  dispose(): void {
    this.run?.dispose();
  }

  private async list(): Promise<void> {
    this.run?.dispose();
    this.run = null;
    this.main.className = 'page';
    this.footer.replaceChildren();
    try {
      const episodes = await listEpisodes();
      const head = ['', 'when', 'plant', 'rule', 'pilot', 'outcome', 'seconds', 'speed', 'seed'];
      const body = element('tbody', {}, ...episodes.map((episode) => this.row(episode)));
      const table = element('table', {}, element('thead', {}, element('tr', {}, ...head.map((name) => element('th', {}, name)))), body);
      const empty = element('p', {}, 'Nothing was flown yet.');
      this.main.replaceChildren(element('h2', {}, 'Episodes'), episodes.length === 0 ? empty : table);
    } catch (error) {
      this.main.replaceChildren(element('p', {}, `The episodes could not be read: ${String(error)}`));
    }
  }

  private row(episode: EpisodeEntry): HTMLElement {
    const cell = (text: string, attributes: Record<string, string> = {}) => element('td', attributes, text);
    const row = element('tr', { tabindex: '0' },
      cell(String(episode.id)), cell(new Date(episode.started_at).toLocaleString()), cell(episode.plant), cell(episode.rule),
      cell(episode.pilot), cell(ENDING_WORDS[episode.ending], { class: 'outcome', 'data-outcome': episode.ending }),
      cell((episode.ticks / 50).toFixed(1)), cell(`${episode.time_scale}×`), cell(String(episode.seed)));
    const open = () => void this.watch(episode);
    row.addEventListener('click', open);
    row.addEventListener('keydown', (event) => {
      if (event.key === 'Enter') open();
    });
    return row;
  }

  private async watch(episode: EpisodeEntry): Promise<void> {
    try {
      const record = await episodeBytes(episode.id);
      for (const model of await listModels()) {
        if (this.loaded.has(model.hash)) continue;
        this.core.addModel(await modelBytes(model.hash));
        this.loaded.add(model.hash);
      }
      this.show(episode, record);
    } catch (error) {
      say(`Episode ${episode.id} cannot be shown: ${error instanceof Error ? error.message : String(error)}`);
    }
  }

  private show(episode: EpisodeEntry, record: Uint8Array): void {
    const canvas = element('canvas', { 'aria-label': 'The recorded flight' });
    const overlay = new Overlay();
    this.main.className = 'flight with-overlay';
    this.main.replaceChildren(element('div', { class: 'stage' }, canvas), overlay.node);
    const slider = element('input', { type: 'range', min: '0', step: '1', 'aria-label': 'Tick of the flight' });
    const time = element('output', {});
    const play = button('Pause', { class: 'secondary' }, () => {
      if (run.isPlaying) run.pause();
      else run.play();
      play.textContent = run.isPlaying ? 'Pause' : 'Play';
    });
    const stage = new Stage(canvas, matchMedia('(prefers-reduced-motion: reduce)').matches);
    const run = new ReplayRun(this.core, record, stage, (tick, position, history) => {
      slider.value = String(position);
      time.textContent = `${(position / run.opening.ticks_per_second).toFixed(2)} s`;
      if (history !== null) overlay.showHistory(history);
      else overlay.show(tick);
      if (position >= run.length) play.textContent = 'Play';
    });
    this.run = run;
    slider.max = String(run.length);
    slider.value = '0';
    slider.addEventListener('input', () => {
      run.pause();
      play.textContent = 'Play';
      run.seek(Number(slider.value));
    });
    overlay.begin(run.opening.setup.rule, run.opening.pilot_goal);
    const exact = this.core.replay(record);
    const speeds = element('select', { 'aria-label': 'Speed' }, ...['0.1', '0.25', '0.5', '1', '2'].map((speed) =>
      element('option', { value: speed, selected: speed === '1' }, `${speed}×`)));
    speeds.addEventListener('change', () => (run.speed = Number(speeds.value)));
    this.footer.replaceChildren(
      button('← Episodes', { class: 'secondary' }, () => void this.list()),
      element('span', {}, `${episode.rule}, ${ENDING_WORDS[episode.ending]}`),
      element('div', { class: 'scrubber' }, play, slider, time, speeds),
      element('span', { class: 'outcome', 'data-outcome': exact.identical ? 'goal' : 'crash' },
        exact.identical ? 'replayed bit for bit' : 'differs from its record'));
    run.play();
  }
}
