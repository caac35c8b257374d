// How often the display shows a frame.

/** Frames a second that the display shows: by the median time between two. */
export function refreshRate(durationMs: number): Promise<number> {
  return new Promise((resolve) => {
    const times: number[] = [];
    const note = (now: number) => {
      times.push(now);
      if (now - times[0]! < durationMs) requestAnimationFrame(note);
      else resolve(rateOf(times));
    };
    requestAnimationFrame(note);
  });
}

/** The rate of some frames, Hz, to a tenth; 60 if there are too few to tell. */
export function rateOf(times: readonly number[]): number {
  const gaps = times.slice(1).map((time, i) => time - times[i]!);
  const median = gaps.sort((a, b) => a - b)[Math.floor(gaps.length / 2)];
  return median === undefined || median <= 0 ? 60 : Math.round(10_000 / median) / 10;
}
