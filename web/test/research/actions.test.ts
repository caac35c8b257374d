// @vitest-environment jsdom
// A question of the desk: what it asks is done once, and it goes when another view comes.

import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import * as actions from '../../src/research/actions';
import type { Row } from '../../src/research/deskapi';
import type { Feed } from '../../src/research/feed';

const ROW = { id: 7, code: 'K4QT', status: 'under-way' } as Row;
const feed = { refresh: () => Promise.resolve() } as Feed;
/** Posts that wait for their answer. */
let posts: ((answer: Response) => void)[] = [];
const passes = () => new Promise((resume) => setTimeout(resume));
const find = <Found extends HTMLElement>(selector: string) => document.querySelector<Found>(selector)!;
const isOpen = () => document.querySelector('dialog') !== null;

beforeEach(() => {
  posts = [];
  vi.stubGlobal('fetch', () => new Promise((resolve) => posts.push(resolve)));
  // jsdom has no modal dialogs.
  HTMLDialogElement.prototype.showModal = function () {
    this.open = true;
  };
  HTMLDialogElement.prototype.close = function () {
    this.open = false;
    this.dispatchEvent(new Event('close'));
  };
});
afterEach(() => {
  document.body.replaceChildren();
  vi.unstubAllGlobals();
});

function asked(): void {
  actions.note(feed, ROW);
  find<HTMLTextAreaElement>('textarea').value = 'The chair broke.';
  find('form').dispatchEvent(new Event('input'));
}
const submit = () => find('form').dispatchEvent(new Event('submit', { cancelable: true }));

describe('a question', () => {
  it('that is answered twice is done once', async () => {
    asked();
    submit();
    submit();
    expect(find<HTMLButtonElement>('[type=submit]').disabled).toBe(true);
    expect(posts.length).toBe(1);
    posts[0]!(Response.json({}));
    await passes();
    expect(isOpen()).toBe(false);
  });

  it('whose answer was not taken can be answered again', async () => {
    asked();
    submit();
    posts[0]!(Response.json({ error: 'the disk is full' }, { status: 503 }));
    await passes();
    expect(find('.remark').textContent).toBe('The disk is full.');
    submit();
    expect(posts.length).toBe(2);
  });

  it('goes when another view comes, unless it is being answered', () => {
    asked();
    window.dispatchEvent(new Event('hashchange'));
    expect(isOpen()).toBe(false);
    asked();
    submit();
    window.dispatchEvent(new Event('hashchange'));
    expect(isOpen()).toBe(true);
  });
});
