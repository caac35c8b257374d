import { describe, expect, it } from 'vitest';
import type { Part, Pose, Scene } from '../src/core';
import { between, boxOf, nozzleOf, Terrain } from '../src/shapes';

const pose = (x: number, y: number, angle_rad: number, strength = 1): Pose => ({ x, y, angle_rad, strength });

describe('a pose between two', () => {
  it('lies on the way, and its strength is the newer one’s', () => {
    expect(between(pose(0, 2, 0, 0), pose(1, 4, 1, 1), 0.25)).toEqual(pose(0.25, 2.5, 0.25, 1));
  });

  it('turns by the shorter way', () => {
    const { angle_rad } = between(pose(0, 0, 3), pose(0, 0, -3), 0.5)!;
    expect(angle_rad).toBeCloseTo(Math.PI);
    expect(between(pose(0, 0, 0.1), pose(0, 0, 2 * Math.PI - 0.1), 1)!.angle_rad).toBeCloseTo(-0.1);
  });

  it('is the newer one where there is no older, and nothing where there is no newer', () => {
    expect(between(undefined, pose(1, 1, 1), 0.3)).toEqual(pose(1, 1, 1));
    expect(between(pose(1, 1, 1), undefined, 0.3)).toBeNull();
  });
});

describe('a flame', () => {
  it('points from its mouth to its tip', () => {
    const flame: Part = {
      role: 'thrust',
      shapes: [
        {
          kind: 'polygon',
          points: [
            [-1, -1],
            [1, -1],
            [0, -4],
          ],
        },
      ],
    };
    expect(nozzleOf(flame)).toEqual({ mouth: [0, -1], tip: [0, -4], length: 3, half: 1 });
  });
});

describe('the ground', () => {
  const scene: Scene = {
    bounds: [0, 0, 10, 10],
    movable: [],
    origin: [0, 0],
    scale: [1, 1],
    fixed: [
      {
        role: 'ground',
        shapes: [
          {
            kind: 'polygon',
            points: [
              [0, 1],
              [5, 3],
              [10, 3],
              [10, -1],
              [0, -1],
            ],
          },
        ],
      },
    ],
  };

  it('has a height at each place', () => {
    const terrain = new Terrain(scene);
    expect([0, 2.5, 7].map((x) => terrain.heightAt(x))).toEqual([1, 2, 3]);
    expect(terrain.heightAt(-1)).toBe(-Infinity);
  });

  it('need not be', () => {
    expect(new Terrain({ ...scene, fixed: [] }).exists).toBe(false);
  });

  it('fills a box', () => {
    expect(boxOf(scene.fixed[0]!.shapes)).toEqual([0, -1, 10, 3]);
    expect(boxOf([{ kind: 'disc', center: [1, 2], radius: 3 }])).toEqual([-2, -1, 4, 5]);
  });
});
