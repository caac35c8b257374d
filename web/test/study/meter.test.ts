import { describe, expect, it } from 'vitest';
import { telemetry } from '../../jspsych-cohelm/src/telemetry';
import { Meter, summary } from '../../src/meter';
import { rateOf } from '../../src/study/refresh';

describe('the meter', () => {
  it('times a key from its stamp to the tick at which it acts', () => {
    const meter = new Meter();
    meter.pressed(100);
    meter.pressed(112);
    meter.acts(120);
    meter.acts(140);
    expect(meter.soFar(0).key_to_tick_ms).toEqual([20, 8]);
    expect(meter.soFar(0).inputs).toEqual(['keyboard']);
  });

  it('counts frames that the display could have shown', () => {
    const meter = new Meter(10);
    [0, 10, 20, 50, 60].forEach((now) => meter.drew(now));
    expect(meter.soFar(0)).toMatchObject({ frames: 5, dropped_frames: 2 });
  });

  it('takes no pause for dropped frames, and no key of a pause for a slow one', () => {
    const meter = new Meter(10);
    meter.drew(0);
    meter.pressed(5);
    meter.pauses(6);
    meter.pressed(500);
    meter.goesOn(1006);
    meter.drew(1010);
    meter.acts(1020);
    expect(meter.soFar(0)).toMatchObject({ dropped_frames: 0, pauses: 1, paused_ms: 1000, key_to_tick_ms: [] });
  });

  it('adds up what a hidden tab and an interruption took', () => {
    const before = new Meter();
    before.hides(true, 100);
    before.hides(false, 350);
    before.drew(0);
    const after = new Meter(16, before.soFar(3));
    after.cameBack(60_000.4);
    after.drew(0);
    expect(after.soFar(2)).toMatchObject({
      hidden_ms: 250,
      interruptions: 1,
      away_ms: 60_000,
      late_ticks: 5,
      frames: 2,
    });
  });
});

describe('telemetry', () => {
  const machine = { clock: { offset_ms: -12, rtt_ms: 3 }, refreshHz: 60, remapped: false };

  it('counts presses, and a stick once when it leaves its rest', () => {
    const at = { tick: 0, atMs: 0 };
    const stick = (x: number) => ({
      ...at,
      kind: 'stick' as const,
      stick: [x, 0, 0, 0] as [number, number, number, number],
    });
    const log = [
      { ...at, kind: 'down' as const, control: 1 },
      { ...at, kind: 'up' as const, control: 1 },
      ...[5, 9, 0, -4].map(stick),
      { ...at, kind: 'release-all' as const, control: 0 },
      stick(3),
    ];
    expect(telemetry(10, log, new Meter().soFar(0), machine).presses).toBe(4);
  });

  it('says null where nothing was measured', () => {
    const none = telemetry(0, [], new Meter().soFar(0), { clock: null, refreshHz: null, remapped: true });
    expect(none).toMatchObject({ latency_ms: null, latency_p95_ms: null, clock_offset_ms: null, refresh_hz: null });
  });

  it('sums times up by their ranks', () => {
    expect(summary(Array.from({ length: 100 }, (_, i) => 100 - i))).toEqual({ median: 50, p95: 95, most: 100 });
    expect(summary([])).toBeNull();
  });
});

describe('the rate of a display', () => {
  it('is that of the median frame, whatever was dropped', () => {
    const times = Array.from({ length: 60 }, (_, i) => i * (1000 / 144) + (i > 30 ? 200 : 0));
    expect(rateOf(times)).toBeCloseTo(144, 0);
    expect(rateOf([5])).toBe(60);
  });
});
