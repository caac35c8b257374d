// @vitest-environment jsdom
// What is flown is what the page says: nothing starts that was not chosen, and what cannot be had is said.

import './study/canvas';
import { createHash } from 'node:crypto';
import { readFileSync } from 'node:fs';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import type { ModelEntry } from '../src/api';
import type { Context } from '../src/context';
import { Core, type Setup } from '../src/core';
import { FlyView } from '../src/flyview';
import { Hangar } from '../src/hangar';
import { keepSettings, loadSettings } from '../src/settings';

/** A shipped model, as the server lists it. */
function shipped(name: string): ModelEntry {
  const card = JSON.parse(readFileSync(`../models/${name}.card.json`, 'utf8')) as ModelEntry['card'] & {
    kind: ModelEntry['kind'];
  };
  const hash = createHash('sha256').update(bytesOf(name)).digest('hex');
  return { hash, kind: card.kind, name: card.name, plant: card.task.plant, offered: true, card };
}
const bytesOf = (name: string) => readFileSync(`../models/${name}.safetensors`);

const LANDER = ['flag-lander-switches.values', 'flag-lander-switches.intent'];
const AXES = ['drone-continuous.values', 'drone-continuous.intent'];

let begun: Setup[];
let context: Context;
let view: FlyView;
const card = () => view.main.querySelector<HTMLElement>('.card:not([hidden])');
const shows = (kind: string) => vi.waitFor(() => expect(card()?.dataset['kind']).toBe(kind), 3000);
const press = (label: string) =>
  [...card()!.querySelectorAll('button')].find((button) => button.textContent.startsWith(label))!.click();

/** The fly page with these models, as the server has them. */
async function open(names: string[]): Promise<void> {
  const core = await Core.load(readFileSync('dist/cohelm_page.wasm'));
  const hangar = new Hangar(await core.another());
  const served = new Map(names.map((name) => [shipped(name).hash, bytesOf(name)]));
  vi.stubGlobal('fetch', (path: string) => {
    const bytes = served.get(/models\/([0-9a-f]+)/.exec(path)?.[1] ?? '');
    return Promise.resolve(bytes === undefined ? new Response('gone', { status: 404 }) : new Response(bytes));
  });
  hangar.models = names.map(shipped);
  const link = { begin: (setup: Setup) => begun.push(setup), end() {}, chunk() {} } as unknown as Context['link'];
  const session = { endings: [], last: null };
  context = { core, hangar, link, session, onModels: new Set(), onStored: new Set(), go() {} };
  view = new FlyView(context);
  document.body.replaceChildren(view.main, view.footer);
}

beforeEach(() => {
  begun = [];
  localStorage.clear();
});
afterEach(() => {
  view.dispose();
  vi.unstubAllGlobals();
});

describe('the fly page', () => {
  it('does not fly alone when the models of the chosen mode cannot be had for the next flight', async () => {
    await open(LANDER);
    await shows('ready');
    press('Start');
    await vi.waitFor(() => expect(view.main.querySelector('.clock')!.textContent).not.toBe('0.0 s'), 3000);
    window.dispatchEvent(new KeyboardEvent('keydown', { code: 'Escape' }));
    press('End this flight');
    await shows('abandoned');
    context.hangar.models = context.hangar.models.map((model) => ({ ...model, hash: '0'.repeat(64) }));
    press('Fly again');
    await shows('failed');
    expect(begun.map(({ rule }) => rule.rule)).toEqual(['misc-r']);
  });

  it('says by what the goal is inferred where no model does it as chosen', async () => {
    keepSettings({ ...loadSettings(), plant: 'drone', actions: 'continuous', inference: 'imagined' });
    await open(AXES);
    await shows('ready');
    expect(card()!.textContent).toContain('inferred by “calibrated”, not by “imagined: knows no goals”');
    const choice = (name: string) => view.footer.querySelector<HTMLOptionElement>(`option[value=${name}]`)!;
    expect([choice('imagined').disabled, choice('calibrated').selected]).toEqual([true, true]);
    press('Start');
    expect(begun[0]!.inference).toBe('calibrated');
    expect(loadSettings().inference).toBe('imagined');
  });

  it('says so, too, where there is no model for intent at all', async () => {
    keepSettings({ ...loadSettings(), plant: 'drone', actions: 'continuous' });
    await open(AXES.slice(0, 1));
    await shows('ready');
    expect(card()!.textContent).toContain('inferred by “nearest goal”, not by “calibrated”: no intent model');
    press('Start');
    expect(begun[0]!.inference).toBe('nearest');
  });

  it('lets less regret through on axes than with commands, and keeps what was chosen for each', async () => {
    await open([...LANDER, ...AXES]);
    await shows('ready');
    const kappa = () => view.footer.querySelector<HTMLInputElement>('[data-name="parameter kappa"]')!;
    const choose = (name: string, value: string) => {
      const box = view.footer.querySelector<HTMLSelectElement>(`[data-name=${name}]`)!;
      box.value = value;
      box.dispatchEvent(new Event('change'));
    };
    expect(kappa().value).toBe('0.7');
    kappa().value = '1.2';
    kappa().dispatchEvent(new Event('change'));
    choose('plant', 'drone');
    choose('actions', 'continuous');
    expect(kappa().value).toBe('0.2');
    await vi.waitFor(() => {
      press('Start');
      expect(begun[0]?.rule).toEqual({ rule: 'misc-r', kappa: 0.2 });
    }, 3000);
    choose('plant', 'flag-lander');
    choose('actions', 'switches');
    expect(kappa().value).toBe('1.2');
  });

  it('flies every rule that a person can choose', async () => {
    await open(LANDER);
    await shows('ready');
    const rule = () => view.footer.querySelector<HTMLSelectElement>('[data-name=rule]')!;
    const words = [...rule().options].map(({ value }) => value);
    expect(words).toHaveLength(12);
    for (const word of words) {
      begun = [];
      rule().value = word;
      rule().dispatchEvent(new Event('change'));
      await vi.waitFor(() => {
        press('Start');
        expect(begun[0]?.rule.rule).toBe(word);
      }, 3000);
    }
  });

  it('knows why an address asks for what cannot be flown', async () => {
    await open([]);
    const { hangar } = context;
    expect(hangar.whyNot({ plant: 'zeppelin', options: {} })).toContain(
      'no plant is called zeppelin; there are: flag-',
    );
    expect(hangar.whyNot({ plant: 'drone', options: { wind: 99 } })).toContain('wind');
    expect(hangar.whyNot({ plant: 'drone', options: { actions: 'continuous' } })).toBeNull();
  });
});
