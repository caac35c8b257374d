// The participant's page: opens the session, and lets jsPsych run what the server says remains.

import '../style.css';
import './study.css';
import { initJsPsych } from 'jspsych';
import { Deck, Keeper, type FlightShow } from '../../jspsych-cohelm/src';
import { element } from '../dom';
import { Frame, showState } from './frame';
import { KeyChoice } from './keychoice';
import { refreshRate } from './refresh';
import { Place, SessionClosed, type Closed } from './place';
import type { Session } from './steps';
import type { Study } from './study';
import { wordsOf, type Words } from './text';
import { runTimeline } from './timeline';

/** How long the display is watched when the page opens, ms. */
const WATCH_DISPLAY_MS = 600;
/** Tells the other tabs of this browser that this one is the live one now. */
const CHANNEL = 'cohelm.live';

class Page {
  private words: Words = wordsOf(navigator.language);
  private readonly frame: Frame;
  private readonly place: Place;
  private readonly channel = 'BroadcastChannel' in window ? new BroadcastChannel(CHANNEL) : null;
  private deck: Deck | null = null;
  private show: FlightShow | null = null;

  constructor(root: HTMLElement) {
    this.frame = new Frame(root, this.words, {
      withdraw: () => this.place.withdraw(),
      choose: (language) => void this.choose(language).catch((error: unknown) => this.failed(error, 'stuck')),
      opened: () => this.show?.hold(),
    });
    this.place = new Place({
      changed: (session) => this.changed(session),
      away: (away) => this.frame.away(away, () => this.place.tryNow()),
      closed: (why) => this.closed(why),
    });
    showState(this.frame.main, 'opening', this.words.states.opening);
  }

  async open(): Promise<void> {
    // A flight that another tab of this browser has in the air is kept there now, and goes on here.
    this.channel?.postMessage(this.place.tab);
    this.channel?.addEventListener('message', () => this.place.close('taken-over'));
    const refreshHz = await refreshRate(WATCH_DISPLAY_MS);
    await this.place.open(clientOf(refreshHz));
    if (this.hasEnded()) return;
    this.deck = await Deck.open({
      place: null,
      keeper: new Keeper(),
      tab: this.place.tab,
      connected: (connected) => this.frame.connected(connected),
      takenOver: () => this.place.close('taken-over'),
    });
    const { deck, place, words, frame } = this;
    const keys = new KeyChoice(place.session.participant.code);
    const inTheAir = (flying: boolean) => frame.fly(flying);
    const failed = (error: unknown) => this.failed(error, 'stuck');
    const study: Study = { place, words, deck, keys, refreshHz, inTheAir, failed };
    const display = element('div', { class: 'display' });
    frame.main.replaceChildren(display);
    await runTimeline(initJsPsych({ display_element: display }), study, (show) => (this.show = show));
    this.hasEnded();
  }

  private changed(session: Session): void {
    this.words = wordsOf(session.participant.language);
    this.frame.speak(this.words);
    this.frame.show(session);
  }

  /** Says how the study ended, if nothing of it remains. */
  private hasEnded(): boolean {
    const { status, steps, return_address } = this.place.session;
    if (steps.length > 0) return false;
    const how = status === 'declined' || status === 'withdrawn' || status === 'excluded' ? status : 'completed';
    this.frame.end();
    this.deck?.link.close();
    const { words } = this;
    if (return_address == null) showState(this.frame.main, how, words.states[how]);
    else {
      const state = { ...words.states[how], again: words.states.back };
      showState(this.frame.main, how, state, () => location.assign(return_address));
    }
    return true;
  }

  private closed(why: Closed): void {
    this.show?.dispose();
    this.deck?.link.close();
    this.frame.end();
    const { states } = this.words;
    if (why === 'taken-over') showState(this.frame.main, why, states.takenOver, () => location.reload());
    else showState(this.frame.main, why, states[why]);
  }

  /** The page is opened anew in the other language, at the same place. */
  private async choose(language: string): Promise<void> {
    this.show?.hold();
    await this.place.choose(language);
    location.reload();
  }

  /** Says that the page could not be opened, or cannot go on, and offers to open it anew. */
  failed(error: unknown, kind: 'unable' | 'stuck' = 'unable'): void {
    if (error instanceof SessionClosed) return;
    console.error(error);
    showState(this.frame.main, kind, this.words.states[kind], () => location.reload());
  }
}

/** The class of browser and the screen; nothing that names a person. */
function clientOf(refreshHz: number): Record<string, unknown> {
  const browser = /(Firefox|Edg|OPR|Chrome|Safari)\/(\d+)/.exec(navigator.userAgent);
  const system = /(Windows|Mac OS X|Android|iPhone|iPad|CrOS|Linux)/.exec(navigator.userAgent);
  return {
    browser: browser === null ? 'other' : `${browser[1]} ${browser[2]}`,
    system: system?.[1] ?? 'other',
    screen_px: [screen.width, screen.height],
    window_px: [innerWidth, innerHeight],
    pixel_ratio: devicePixelRatio,
    refresh_hz: refreshHz,
    language: navigator.language,
    reduced_motion: matchMedia('(prefers-reduced-motion: reduce)').matches,
  };
}

const page = new Page(document.getElementById('app')!);
page.open().catch((error: unknown) => page.failed(error));
