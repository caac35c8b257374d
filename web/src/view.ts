// From world to canvas: the whole scene is seen, and what room is left over shows more of the same world.

import type { Scene } from './core';

/** Most pixels of a canvas: more than a 4K display has make drawing slow and nothing sharper. */
const MOST_PIXELS = 3840 * 2160;

/** Where the world lies on a canvas. Lengths are CSS pixels. */
export class View {
  /** CSS pixels a world unit is. */
  scale = 1;
  width = 0;
  height = 0;
  /** Canvas pixels a CSS pixel is. */
  ratio = 1;
  private left = 0;
  private bottom = 0;

  /** Fits a scene into a size; true if anything changed. */
  fit(scene: Scene, width: number, height: number, ratio: number): boolean {
    const kept = Math.min(ratio, Math.sqrt(MOST_PIXELS / Math.max(width * height, 1)));
    const [west, south, east, north] = scene.bounds;
    const scale = Math.min(width / (east - west), height / (north - south));
    const left = (width - (east - west) * scale) / 2 - west * scale;
    // The ground stays at the bottom; room that is left over is sky.
    const bottom = height + south * scale;
    const changed =
      width !== this.width ||
      height !== this.height ||
      kept !== this.ratio ||
      scale !== this.scale ||
      left !== this.left;
    Object.assign(this, { scale, width, height, ratio: kept, left, bottom });
    return changed;
  }

  /** How many CSS pixels a thin line takes: on a large display more, or it would be a hair. */
  get line(): number {
    return Math.max(1, this.height / 760);
  }

  x(world: number): number {
    return this.left + world * this.scale;
  }

  y(world: number): number {
    return this.bottom - world * this.scale;
  }

  /** World x at the left and the right edge of the canvas. */
  get span(): [number, number] {
    return [-this.left / this.scale, (this.width - this.left) / this.scale];
  }

  /** World y at the top of the canvas. */
  get top(): number {
    return this.bottom / this.scale;
  }

  /** From now on the pen's units are CSS pixels, y downwards. */
  useScreen(pen: CanvasRenderingContext2D): void {
    pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
  }

  /** From now on the pen's units are the world's, y upwards. */
  useWorld(pen: CanvasRenderingContext2D): void {
    const { scale, ratio } = this;
    pen.setTransform(scale * ratio, 0, 0, -scale * ratio, this.left * ratio, this.bottom * ratio);
  }
}
