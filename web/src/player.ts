// The controls under a replay: play, scrubber, speed, and the same by keys.

import { button, element, isTheirs, select } from './dom';
import type { ReplayRun } from './replay';

const SPEEDS: [string, string][] = [
  ['0.1', '0.1×'],
  ['0.25', '¼×'],
  ['0.5', '½×'],
  ['1', '1×'],
  ['2', '2×'],
  ['4', '4×'],
];
/** Ticks that a step with the Shift key goes. */
const LONG_STEP = 25;

/** Winds a run; `leave` is done on Escape and Enter. */
export class Player {
  readonly play = button('', { class: 'secondary play' }, () => this.toggle());
  readonly time = element('output', { class: 'time' });
  readonly speed = select('speed', SPEEDS, '1', (chosen) => this.choose(Number(chosen)));
  readonly slider = element('input', {
    type: 'range',
    min: '0',
    step: '1',
    value: '0',
    'aria-label': 'Moment of the flight, in ticks',
  });
  private run: ReplayRun | null = null;
  private ticksPerSecond = 50;
  private chosenSpeed = 1;
  private readonly onKey = (event: KeyboardEvent) => this.shortcut(event);

  constructor(private readonly leave: () => void) {
    this.slider.addEventListener('input', () => this.seek(Number(this.slider.value)));
    window.addEventListener('keydown', this.onKey);
  }

  dispose(): void {
    window.removeEventListener('keydown', this.onKey);
  }

  /** From now on this run is wound. */
  take(run: ReplayRun, ticksPerSecond: number): void {
    this.run = run;
    this.ticksPerSecond = ticksPerSecond;
    run.speed = this.chosenSpeed;
    this.slider.max = String(run.length);
    this.show(run.tick);
  }

  /** The run stands at so many ticks. */
  show(position: number): void {
    this.slider.value = String(position);
    this.time.textContent = `${(position / this.ticksPerSecond).toFixed(2)} s`;
    this.showPlay();
  }

  seek(position: number): void {
    this.run?.pause();
    this.run?.seek(position);
    this.showPlay();
  }

  private choose(speed: number): void {
    this.chosenSpeed = speed;
    if (this.run !== null) this.run.speed = speed;
  }

  private toggle(): void {
    if (this.run === null) return;
    if (this.run.isPlaying) this.run.pause();
    else this.run.play();
    this.showPlay();
  }

  private showPlay(): void {
    this.play.textContent = this.run?.isPlaying === true ? '❚❚ Pause' : '▶ Play';
  }

  private shortcut(event: KeyboardEvent): void {
    if (this.run === null || event.ctrlKey || event.metaKey || event.altKey) return;
    if (document.querySelector('dialog[open]') !== null) return;
    if (event.code === 'Escape') this.leave();
    if (isTheirs(event)) return;
    const step = event.shiftKey ? LONG_STEP : 1;
    const act = {
      Space: () => this.toggle(),
      ArrowLeft: () => this.seek(this.run!.tick - step),
      ArrowRight: () => this.seek(this.run!.tick + step),
      Home: () => this.seek(0),
      End: () => this.seek(Infinity),
      Enter: () => this.leave(),
    }[event.code];
    if (act === undefined) return;
    event.preventDefault();
    if (!event.repeat || event.code.startsWith('Arrow')) act();
  }
}
