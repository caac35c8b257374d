// @vitest-environment jsdom
// The participant's place: what the page tells the server, and what it does when the server is away.

import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { Place, SessionClosed } from '../../src/study/place';
import type { Step } from '../../src/study/steps';
import { FakeServer } from './server';

const STEPS: Step[] = [
  { id: 'block-1', kind: 'block', label: 'Mode A', text: '', practice: 1, measured: 2 },
  { id: 'debrief', kind: 'debrief', text: '', contact: '' },
];

let server: FakeServer;
beforeEach(() => {
  vi.useFakeTimers();
  server = new FakeServer(STEPS);
  vi.stubGlobal('fetch', server.fetch);
});
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

async function opened() {
  const heard: string[] = [];
  const place = new Place({
    changed: (session) => heard.push(`at ${session.place}`),
    away: (away) => heard.push(away ? 'away' : 'back'),
    closed: (why) => heard.push(why),
  });
  await place.open({ browser: 'none' });
  heard.length = 0;
  return { place, heard };
}

describe('the place', () => {
  it('is where the server says', async () => {
    const { place, heard } = await opened();
    expect(await place.answer('block-1', {}, 1234.6)).toEqual({ taken: true });
    expect(place.session.steps[0]?.id).toBe('debrief');
    expect(server.posts.at(-1)!.body).toMatchObject({ tab: place.tab, data: {}, page_ms: 1235 });
    expect(heard).toEqual(['at 1']);
  });

  it('waits for a server that is away, says so, and hands in then', async () => {
    const { place, heard } = await opened();
    server.isAway = true;
    const answered = place.answer('block-1', {}, 0);
    await vi.advanceTimersByTimeAsync(4000);
    expect(heard[0]).toBe('away');
    expect(heard).not.toContain('back');
    server.isAway = false;
    await vi.advanceTimersByTimeAsync(8000);
    expect(await answered).toEqual({ taken: true });
    expect(heard.slice(-2)).toEqual(['back', 'at 1']);
  });

  it('tries at once when it is told to', async () => {
    const { place } = await opened();
    server.isAway = true;
    const answered = place.answer('block-1', {}, 0);
    await vi.advanceTimersByTimeAsync(3600);
    server.isAway = false;
    window.dispatchEvent(new Event('online'));
    await vi.advanceTimersByTimeAsync(0);
    expect(await answered).toEqual({ taken: true });
  });

  it('takes trouble of the server for being away, not for an answer', async () => {
    const { place, heard } = await opened();
    server.next.push({ status: 503, body: { error: 'the disk is full' } });
    const answered = place.answer('block-1', {}, 0);
    await vi.advanceTimersByTimeAsync(1000);
    expect(await answered).toEqual({ taken: true });
    expect(heard).toEqual(['away', 'back', 'at 1']);
  });

  it('passes on what the server does not take', async () => {
    const { place } = await opened();
    server.next.push({ status: 422, body: { error: 'some answers are missing', items: { age: 'missing' } } });
    expect(await place.answer('block-1', {}, 0)).toEqual({
      taken: false,
      problems: { age: 'missing' },
      error: 'some answers are missing',
    });
  });

  it('goes to where the session is when it has moved on elsewhere', async () => {
    const { place } = await opened();
    server.place = 1;
    server.next.push({ status: 409, body: { error: 'not current', session: server.session } });
    await place.answer('block-1', {}, 0);
    expect(place.session.steps[0]?.id).toBe('debrief');
  });

  it('is given up to another tab', async () => {
    const { place, heard } = await opened();
    server.tab = 'another';
    await expect(place.answer('block-1', {}, 0)).rejects.toThrow(SessionClosed);
    expect(heard).toEqual(['taken-over']);
    expect(place.isOpen).toBe(false);
  });

  it('is nobody’s without a link', async () => {
    server.next.push({ status: 401, body: { error: 'no participant' } });
    const heard: string[] = [];
    const place = new Place({ changed: () => {}, away: () => {}, closed: (why) => heard.push(why) });
    await expect(place.open({})).rejects.toThrow(SessionClosed);
    expect(heard).toEqual(['nobody']);
  });

  it('ends with a withdrawal', async () => {
    const { place, heard } = await opened();
    await place.withdraw();
    expect(server.posts.at(-1)!.path).toBe('/api/session/withdraw');
    expect(heard).toEqual(['withdrawn']);
  });

  it('knows the clocks’ difference from the shortest way there and back', async () => {
    server.clockAheadMs = 5000;
    const { place } = await opened();
    expect(place.clock!.offset_ms).toBeCloseTo(-5000, 0);
    const slow = server.fetch;
    vi.stubGlobal('fetch', async (...request: Parameters<typeof slow>) => {
      server.clockAheadMs = 9000;
      const response = await slow(...request);
      await vi.advanceTimersByTimeAsync(300);
      return response;
    });
    await place.refresh();
    expect(place.clock!.offset_ms).toBeCloseTo(-5000, 0);
  });

  it('asks for what was committed of a flight', async () => {
    const { place } = await opened();
    server.next.push({ status: 404, body: { error: 'no such flight' } });
    expect(await place.committed('ab')).toBeNull();
  });
});
