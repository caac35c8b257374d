// The page: fly, here or elsewhere, look at what was flown. One view at a time below one header; the address says which.

import './style.css';
import { episodeBytes } from './api';
import type { Context, View } from './context';
import { Core } from './core';
import { button, element } from './dom';
import { EpisodesView } from './episodesview';
import { externalPlant } from './external';
import { ExternalView } from './externalview';
import { FlyView } from './flyview';
import { Hangar, taskIn } from './hangar';
import { LearningBadge } from './learning';
import { Link } from './link';
import { say } from './message';
import { ReplayView } from './replayview';
import { keepSettings, loadSettings } from './settings';
import { reasonOf, sentence } from './words';

async function open(): Promise<void> {
  const core = await Core.load(fetch('/cohelm_page.wasm'));
  const hangar = new Hangar(await core.another());
  await hangar.refresh().catch(() => {
    // The link says that the server is away; as soon as it is there the models are asked for again.
  });
  const task = taskIn(location.search);
  const wrong = task === null ? null : hangar.whyNot(task);
  const asked = hangar.ask(wrong === null ? task : null);
  if (asked !== null) keepSettings({ ...loadSettings(), ...asked });
  const status = element('span', { class: 'dot', role: 'status', 'data-state': 'off' }, 'connecting');
  const badge = new LearningBadge();
  const context: Context = {
    core,
    hangar,
    link: linkOf(),
    session: { endings: [], last: null },
    onModels: new Set(),
    onStored: new Set(),
    go: (place) => (location.hash = `#/${place}`),
  };
  const models = async (learning: string | null) => {
    hangar.learning = learning;
    const { learned } = badge;
    try {
      await hangar.refresh();
    } catch (error) {
      say(`The list of models could not be read: ${reasonOf(error)}`);
    }
    if (learning !== null) await badge.refresh();
    context.onModels.forEach((told) => told(badge.learned > learned));
  };

  function linkOf(): Link {
    return new Link(`${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/ws`, {
      state: (connected, waiting) => {
        status.dataset['state'] = connected ? 'on' : 'off';
        const kept = waiting === 0 ? '' : waiting === 1 ? ', 1 flight waits' : `, ${waiting} flights wait`;
        status.textContent = connected ? `recording${kept}` : `no connection: flights are kept and sent later${kept}`;
      },
      trouble: (text) => say(text),
      welcome: (about) => void models(about.values),
      newModel: (hash) => void models(hash),
      stored: (episode) => context.onStored.forEach((told) => told(episode)),
    });
  }

  const elsewhere = await externalPlant().catch(() => null);
  show(context, status, badge, elsewhere !== null);
  if (wrong !== null)
    say(`The address asks for what cannot be flown: ${sentence(wrong)} What was flown last is shown instead.`, 60);
}

/** Puts the header up, and below it the view that the address names. */
function show(context: Context, status: HTMLElement, badge: LearningBadge, elsewhere: boolean): void {
  const tab = (place: string, name: string) => element('a', { href: `#/${place}`, 'data-tab': place }, name);
  const tabs = [...(elsewhere ? [tab('external', 'Plant')] : []), tab('fly', 'Fly'), tab('episodes', 'Episodes')];
  const header = element(
    'header',
    {},
    element('span', { class: 'brand' }, element('img', { src: '/favicon.svg', alt: '' }), 'cohelm'),
    element('nav', { 'aria-label': 'Views' }, ...tabs),
    element(
      'span',
      { class: 'status' },
      badge.node,
      status,
      element('a', { href: '/notices.txt', title: 'Licences of what is in this page' }, context.core.about().version),
    ),
  );
  let view: View | null = null;
  const turn = () => {
    const place = location.hash.replace(/^#\/?/, '') || (elsewhere ? 'external' : 'fly');
    view?.dispose();
    view = viewOf(context, place);
    for (const link of tabs) {
      if (place.startsWith(link.dataset['tab']!)) link.setAttribute('aria-current', 'page');
      else link.removeAttribute('aria-current');
    }
    document.getElementById('app')!.replaceChildren(header, view.main, view.footer);
  };
  window.addEventListener('hashchange', turn);
  // A page that is left in mid-flight hands in what was flown so far; what cannot be sent now is sent next time.
  window.addEventListener('pagehide', () => view?.dispose());
  window.addEventListener('pageshow', (event) => {
    if (event.persisted) turn();
  });
  turn();
}

function viewOf(context: Context, place: string): View {
  const episode = /^episodes\/(\d+)$/.exec(place)?.[1];
  if (episode !== undefined) {
    const id = Number(episode);
    return new ReplayView(context, {
      title: `Episode ${id}`,
      bytes: () => episodeBytes(id),
      back: { label: 'Episodes', place: 'episodes' },
    });
  }
  const { last } = context.session;
  if (place === 'again' && last !== null) {
    return new ReplayView(context, {
      title: 'Your last flight',
      bytes: () => Promise.resolve(last),
      back: { label: 'Fly', place: 'fly' },
    });
  }
  if (place === 'external') return new ExternalView(context);
  return place === 'episodes' ? new EpisodesView(context) : new FlyView(context);
}

open().catch((error: unknown) => {
  const again = button('Try again', { class: 'primary' }, () => location.reload());
  document
    .getElementById('app')!
    .replaceChildren(
      element(
        'main',
        { class: 'page' },
        element(
          'article',
          { class: 'sheet' },
          element('h2', {}, 'The page could not be opened'),
          element('p', {}, sentence(reasonOf(error))),
          element('p', {}, 'It needs a browser of 2022 or later with WebAssembly, and the server that it came from.'),
          element('div', { class: 'actions' }, again),
        ),
      ),
    );
});
