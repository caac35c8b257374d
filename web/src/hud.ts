// Readings over the sky: time, keys, speed, and the tilt of what tilts. They say little, and that at a glance.

import type { Opening } from './core';
import { element } from './dom';
import { keyCap } from './keys';
import type { Stage } from './stage';

export class Hud {
  readonly node = element('div', { class: 'hud', 'aria-hidden': 'true' });
  private readonly clock = element('b', { class: 'clock' });
  private readonly mode = element('span', { class: 'mode' });
  private readonly heading = element('span', { class: 'heading' });
  private readonly pressed = element('span', { class: 'pressed' });
  private readonly needle = element('i', {});
  private readonly dial = element('span', { class: 'dial' }, this.needle);
  private readonly tilt = element('span', { class: 'tilt' });
  private readonly upwards = element('span', {});
  private readonly across = element('span', {});
  private word = 'tilt';

  constructor() {
    this.node.append(
      element('div', {}, this.clock, this.mode, this.heading),
      this.pressed,
      element('div', { class: 'readings' }, this.dial, this.tilt, this.upwards, this.across),
    );
  }

  /** `heading` says which flight it is, where that matters; `tilt` is the word for it. */
  begin(opening: Opening, mode: string, heading = '', tilt = 'tilt'): void {
    this.mode.textContent = mode;
    this.heading.textContent = heading;
    this.word = tilt;
    this.pressed.replaceChildren(
      ...opening.controls.map((control) => element('kbd', { title: control.name }, keyCap(control.keys[0] ?? '?'))),
    );
    this.showTilt(false);
    this.show(0, new Set(), { across: 0, upwards: 0, tilt_rad: 0 });
  }

  show(seconds: number, held: ReadonlySet<number>, { across, upwards, tilt_rad }: Stage['readings']): void {
    [...this.pressed.children].forEach((cap, control) => cap.classList.toggle('held', held.has(control)));
    this.clock.textContent = `${seconds.toFixed(1)} s`;
    // What never turns in a flight has no tilt to read: a hand that stays upright, a cart.
    if (tilt_rad !== 0) this.showTilt(true);
    const degrees = (tilt_rad * 180) / Math.PI;
    this.needle.style.transform = `rotate(${-degrees}deg)`;
    this.tilt.textContent = `${this.word} ${Math.abs(degrees).toFixed(0)}°`;
    this.upwards.textContent = `${upwards < -0.05 ? '↓' : upwards > 0.05 ? '↑' : '↕'} ${Math.abs(upwards).toFixed(1)}`;
    this.across.textContent = `${across < -0.05 ? '←' : across > 0.05 ? '→' : '↔'} ${Math.abs(across).toFixed(1)}`;
  }

  private showTilt(turns: boolean): void {
    this.dial.hidden = !turns;
    this.tilt.hidden = !turns;
  }
}
