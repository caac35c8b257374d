// The researcher's page: the study at a glance, its participants, any flight in the air and any that was flown.

import '../style.css';
import './desk.css';
import { Core } from '../core';
import { button, element } from '../dom';
import { Hangar } from '../hangar';
import { say } from '../message';
import { reasonOf } from '../words';
import * as api from './deskapi';
import { Feed } from './feed';
import { FlightDeskView } from './flightdesk';
import { FlightListView } from './flightlist';
import { LoginView, troubleView } from './login';
import { OverviewView } from './overview';
import { Peek } from './peek';
import { PeopleView } from './people';
import { PersonView } from './person';
import type { Desk, DeskView } from './place';
import { themeSwitch } from './theme';
import { WatchView } from './watch';

const app = document.getElementById('app')!;
document.body.classList.add('desk');

/** Shows the door, or what lies behind it. */
async function open(): Promise<void> {
  const feed = new Feed(() => location.reload());
  const quiet = new Feed(() => {});
  await quiet.refresh();
  if (quiet.trouble instanceof api.NotLetIn) {
    app.replaceChildren(new LoginView(() => void open()).main);
    return;
  }
  if (quiet.trouble !== null) {
    app.replaceChildren(troubleView(quiet.trouble).main);
    return;
  }
  await feed.open();
  show(deskOf(feed));
}

function deskOf(feed: Feed): Desk {
  let loop: ReturnType<Desk['loop']> | null = null;
  const load = async () => {
    const core = await Core.load(fetch('/cohelm_page.wasm'));
    const hangar = new Hangar(await core.another());
    await hangar.refresh().catch((error: unknown) => say(`The list of models could not be read: ${reasonOf(error)}`));
    return { core, second: await core.another(), hangar };
  };
  // What could not be loaded is loaded anew by whoever asks next.
  const loadAnew = () =>
    load().catch((error: unknown) => {
      loop = null;
      throw error;
    });
  return {
    feed,
    peek: new Peek(feed),
    loop: () => (loop ??= loadAnew()),
    go: (place) => (location.hash = `#/${place}`),
  };
}

function show(desk: Desk): void {
  const tab = (place: string, name: string) => element('a', { href: `#/${place}`, 'data-tab': place }, name);
  const tabs = [tab('overview', 'Overview'), tab('people', 'Participants'), tab('episodes', 'Flights')];
  const state = element('span', { class: 'dot', role: 'status' });
  const leave = button('Log out', { class: 'quiet-button' }, () => void api.logout().finally(() => location.reload()));
  const title = element('span', { class: 'study-title' });
  const header = element(
    'header',
    { class: 'desk-head' },
    element('a', { class: 'brand', href: '#/overview' }, element('img', { src: '/favicon.svg', alt: '' }), 'desk'),
    title,
    element('nav', { 'aria-label': 'Views' }, ...tabs),
    element('span', { class: 'status' }, state, themeSwitch(), leave),
  );
  const tell = () => {
    const { trouble, study } = desk.feed;
    state.dataset['state'] = trouble === null ? 'on' : 'off';
    state.textContent = trouble === null ? 'live' : `not up to date: ${reasonOf(trouble)}`;
    title.textContent = study?.title ?? '';
    const air = desk.feed.rows.filter((row) => row.in_air !== null).length;
    document.title = `${air > 0 ? `▶ ${air} · ` : ''}${study?.name ?? 'cohelm'}: the desk`;
    title.title = `${study?.name ?? ''}, ${study?.hash ?? ''}`;
  };
  desk.feed.listen(tell);
  tell();
  let view: DeskView | null = null;
  const turn = () => {
    const place = location.hash.replace(/^#\/?/, '') || 'overview';
    view?.dispose();
    view = viewOf(desk, place);
    const here = place.startsWith('watch') ? 'people' : place;
    for (const link of tabs) {
      if (here.startsWith(link.dataset['tab']!)) link.setAttribute('aria-current', 'page');
      else link.removeAttribute('aria-current');
    }
    app.replaceChildren(header, view.main);
  };
  window.addEventListener('hashchange', turn);
  turn();
}

function viewOf(desk: Desk, place: string): DeskView {
  const [, kind, number] = /^(people|watch|episodes)\/(\d+)$/.exec(place) ?? [];
  const id = Number(number);
  if (kind === 'people') return new PersonView(desk, id);
  if (kind === 'watch') return new WatchView(desk, id);
  if (kind === 'episodes') return new FlightDeskView(desk, id);
  if (place === 'people') return new PeopleView(desk);
  if (place === 'episodes') return new FlightListView(desk);
  return new OverviewView(desk);
}

open().catch((error: unknown) => app.replaceChildren(troubleView(error).main));
