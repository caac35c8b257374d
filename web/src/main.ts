// The page: fly, look at what was flown. One view at a time below one header.

import './style.css';
import { Core } from './core';
import { button, element } from './dom';
import { EpisodesView } from './episodesview';
import { FlyView } from './flyview';
import { Link } from './link';
import { say } from './message';

/** A view fills the space below the header, and lets go of everything when another takes its place. */
export interface View {
  readonly main: HTMLElement;
  readonly footer: HTMLElement;
  dispose(): void;
}

async function open(): Promise<void> {
  const app = document.getElementById('app')!;
  const core = await Core.load(fetch('/cohelm_page.wasm'));
  const status = element('span', { class: 'dot', 'data-state': 'off' }, 'connecting');
  const link = new Link((connected) => {
    status.dataset['state'] = connected ? 'on' : 'off';
    status.textContent = connected ? 'recording' : 'not connected: flights are kept here and sent later';
  });
  let view: View | null = null;
  const nav = element('nav', { 'aria-label': 'Views' });
  const tabs = { fly: 'Fly', episodes: 'Episodes' } as const;
  const show = (tab: keyof typeof tabs, made: View) => {
    view?.dispose();
    view = made;
    for (const item of nav.children) {
      if ((item as HTMLElement).dataset['tab'] === tab) item.setAttribute('aria-current', 'page');
      else item.removeAttribute('aria-current');
    }
    app.replaceChildren(header, made.main, made.footer);
  };
  const fly = () => show('fly', new FlyView(core, link));
  const episodes = () => show('episodes', new EpisodesView(core));
  nav.append(button(tabs.fly, { 'data-tab': 'fly' }, fly), button(tabs.episodes, { 'data-tab': 'episodes' }, episodes));
  const header = element('header', {},
    element('span', { class: 'brand' }, element('img', { src: '/favicon.svg', alt: '' }), 'cohelm'), nav,
    element('span', { class: 'status' }, status, element('span', {}, core.about().version)));
  fly();
}

open().catch((error: unknown) => say(`The page could not be opened: ${String(error)}`));
