// A flight in the air, a little behind: its key log comes from the server, the loop flies it again here.

import { element } from '../dom';
import { Overlay } from '../overlay';
import type { FromPage } from './wire';
import { readFromPage } from './wire';
import { Stage } from '../stage';
import { ENDING_WORDS, reasonOf, RULE_NAMES, sentence } from '../words';
import { kindBadges } from './bits';
import { Following } from './following';
import { AT_THE_DESK } from './panel';
import type { Desk, DeskView } from './place';
import { Playback } from './playback';
import { stepWords } from './says';

/** Time after which a lost connection is tried again, ms. */
const AGAIN_MS = 1500;

export class WatchView implements DeskView {
  readonly main = element('main', { class: 'instrument watching' });
  private readonly overlay = new Overlay();
  private readonly canvas = element('canvas', { class: 'front', role: 'img', 'aria-label': 'The flight' });
  private readonly back = element('canvas', { class: 'back', 'aria-hidden': 'true' });
  private readonly title = element('div', { class: 'title' });
  private readonly live = element('div', { class: 'live', role: 'status' });
  private readonly stage = new Stage(this.back, this.canvas, AT_THE_DESK);
  private readonly deaf: () => void;
  private socket: WebSocket | null = null;
  private flight: { of: string; following: Following; playback: Playback; noted: number; over: boolean } | null = null;
  /** Messages are taken in one after the other: the first may have to wait for its models. */
  private turn: Promise<void> = Promise.resolve();
  private frame = 0;
  private timer = 0;
  private gone = false;
  private connected = false;
  /** Nothing was heard over this connection yet. */
  private fresh = true;

  constructor(
    private readonly desk: Desk,
    private readonly id: number,
  ) {
    const picture = element('div', { class: 'stage' }, this.back, this.canvas, this.title, this.live);
    this.main.append(picture, this.overlay.node);
    this.deaf = desk.feed.listen(() => this.showTitle());
    this.showTitle();
    this.connect();
    this.frame = requestAnimationFrame((now) => this.draw(now));
  }

  dispose(): void {
    this.gone = true;
    this.deaf();
    cancelAnimationFrame(this.frame);
    clearTimeout(this.timer);
    this.socket?.close();
  }

  private connect(): void {
    if (this.gone) return;
    const socket = new WebSocket(
      `${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/ws/desk/watch/${this.id}`,
    );
    socket.binaryType = 'arraybuffer';
    socket.addEventListener('open', () => {
      this.connected = true;
      this.fresh = true;
    });
    socket.addEventListener('message', ({ data }) => {
      if (data instanceof ArrayBuffer) this.hear(new Uint8Array(data));
    });
    socket.addEventListener('close', () => {
      this.connected = false;
      this.timer = window.setTimeout(() => this.connect(), AGAIN_MS);
    });
    this.socket = socket;
  }

  private hear(bytes: Uint8Array): void {
    const message = readFromPage(bytes);
    if (message === null) return;
    this.turn = this.turn
      .then(() => this.take(message))
      .catch((error: unknown) => {
        // What is missing comes again from its first tick with the next connection.
        this.flight = null;
        this.live.textContent = sentence(reasonOf(error));
        this.socket?.close();
      });
  }

  private async take(message: FromPage): Promise<void> {
    if (this.gone) return;
    if (message.kind === 'begin') return this.begin(message);
    const { flight } = this;
    if (flight === null) return;
    if (message.kind === 'chunk') {
      if (message.piece.to <= flight.following.ticks.length) return;
      flight.following.take(message.piece);
      flight.playback.arrived(flight.following.ticks.length, performance.now());
    } else {
      flight.following.ending = message.ending;
      flight.playback.ended();
    }
  }

  private async begin({ setup }: FromPage & { kind: 'begin' }): Promise<void> {
    const of = JSON.stringify(setup);
    // Whoever was connected anew gets the flight from its first tick: what is there already goes on.
    const again = this.fresh && this.flight?.of === of && this.flight.following.ending === null;
    this.fresh = false;
    if (again) return;
    const { core, hangar } = await this.desk.loop();
    await hangar.equip(core, [setup.values, setup.intent]);
    if (this.gone) return;
    const following = new Following(core, setup);
    const { opening } = following;
    const playback = new Playback(opening.ticks_per_second * setup.time_scale);
    this.flight = { of, following, playback, noted: 0, over: false };
    this.stage.show(opening.scene, opening.pilot_goal, setup.seed, opening.ticks_per_second);
    this.overlay.begin(setup.rule, opening.pilot_goal, opening.goals, []);
    this.showTitle();
  }

  private draw(now: number): void {
    this.frame = requestAnimationFrame((next) => this.draw(next));
    const { flight } = this;
    if (flight === null) return this.showLive(now);
    const { following, playback } = flight;
    const place = playback.at(now);
    const older = Math.floor(place);
    for (; flight.noted < older; flight.noted += 1) this.stage.note(following.ticks[flight.noted]!);
    const newer = Math.min(older + 1, following.ticks.length);
    this.stage.draw(following.posesAt(older), following.posesAt(newer), place - older, now, !playback.waits);
    this.overlay.show(following.ticks[older - 1] ?? null, following.history, older);
    if (playback.isDone && !flight.over && following.ending !== null) {
      flight.over = true;
      this.stage.end(following.ending);
    }
    this.showLive(now);
  }

  private showTitle(): void {
    const row = this.desk.feed.row(this.id);
    const setup = this.flight?.following.opening.setup;
    const rule = setup === undefined ? '' : `${RULE_NAMES[setup.rule.rule]} · seed ${setup.seed}`;
    this.title.replaceChildren(
      element('b', {}, row?.code ?? `participant ${this.id}`, ...(row === undefined ? [] : kindBadges(row))),
      element(
        'span',
        {},
        [row?.step == null ? '' : stepWords(row.step), row?.condition ?? ''].filter(Boolean).join(' · '),
      ),
      element('span', {}, rule),
      element('a', { href: `#/people/${this.id}` }, 'log and flights'),
    );
  }

  private showLive(now: number): void {
    const { state, words } = liveWords(this.flight, this.connected, now);
    if (this.live.textContent !== words) this.live.textContent = words;
    this.live.dataset['state'] = state;
  }
}

/** What is said about how live the picture is. */
function liveWords(
  flight: { following: Following; playback: Playback } | null,
  connected: boolean,
  now: number,
): { state: string; words: string } {
  if (!connected) return { state: 'away', words: 'No connection to the server; trying again…' };
  if (flight === null)
    return { state: 'idle', words: 'Nothing is under way. The next flight is shown as soon as it begins.' };
  const { following, playback } = flight;
  const exact = following.exact
    ? 'flown again here from the keys, bit for bit ✓'
    : '✕ differs here from what was flown';
  if (playback.isDone) {
    const { sign, word } = ENDING_WORDS[following.ending ?? 'abandoned'];
    return { state: 'over', words: `${sign} ${word} · ${exact}` };
  }
  if (following.ticks.length === 0) return { state: 'waits', words: 'Taking off…' };
  if (playback.waits) return { state: 'waits', words: `Waiting: the flight is paused, or its log is late · ${exact}` };
  return { state: 'live', words: `live, ${playback.behind_s(now).toFixed(1)} s behind · ${exact}` };
}
