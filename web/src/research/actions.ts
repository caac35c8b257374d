// What can be done to a participant, each in a dialog that says what it does before it is done.

import { button, element } from '../dom';
import { say } from '../message';
import { reasonOf, sentence } from '../words';
import { copyButton } from './bits';
import type { Row } from './deskapi';
import * as api from './deskapi';
import type { Feed } from './feed';

interface Asked {
  title: string;
  content: (Node | string)[];
  /** The label of the button that does it; it stays shut until `ready` says yes. */
  label: string;
  danger?: boolean;
  ready?: () => boolean;
  act: () => Promise<void | HTMLElement[]>;
}

/** Opens a dialog. What `act` gives back is shown in its place, to be closed when it was read. */
function open({ title, content, label, danger = false, ready = () => true, act }: Asked): void {
  const remark = element('p', { class: 'remark', role: 'alert' });
  const go = element('button', { type: 'submit', class: danger ? 'primary danger' : 'primary' }, label);
  const cancel = button('Cancel', { class: 'secondary' }, () => box.close());
  const form = element('form', {}, element('h3', {}, title), ...content, remark);
  form.append(element('div', { class: 'actions' }, go, cancel));
  const box = element('dialog', { class: 'ask' }, form);
  let busy = false;
  const look = () => (go.disabled = busy || !ready());
  // The browser's Back shows another view, to which this question does not belong. What is being done shows how it ends.
  const leave = () => {
    if (!busy) box.close();
  };
  form.addEventListener('input', look);
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    if (busy) return;
    busy = true;
    look();
    const over = () => {
      busy = false;
      look();
    };
    void act()
      .finally(over)
      .then(
        (more) => {
          if (more === undefined) return box.close();
          const done = button('Done', { class: 'secondary' }, () => box.close());
          box.replaceChildren(element('h3', {}, title), ...more, element('div', { class: 'actions' }, done));
        },
        (error: unknown) => (remark.textContent = sentence(reasonOf(error))),
      );
  });
  box.addEventListener('close', () => {
    window.removeEventListener('hashchange', leave);
    box.remove();
  });
  window.addEventListener('hashchange', leave);
  look();
  document.body.append(box);
  box.showModal();
}

const field = (label: string, input: HTMLElement) => element('label', { class: 'field' }, label, input);
const paragraph = (...words: (Node | string)[]) => element('p', {}, ...words);

function linkRow(address: string): HTMLElement {
  const shown = element('input', { readonly: true, value: address, class: 'link', 'aria-label': 'Link' });
  shown.addEventListener('focus', () => shown.select());
  return element('div', { class: 'link-row' }, shown, copyButton(address));
}

/** The link of a participant, which the server tells once. */
function linkShown({ code, link }: api.Created): HTMLElement[] {
  const address = new URL(link, location.href).href;
  return [
    paragraph(
      element('b', {}, code),
      ' has this link. It is shown only now: the server keeps no copy that it could show.',
    ),
    linkRow(address),
    element(
      'p',
      { class: 'note' },
      'Whoever has the link is this participant. A new link can be made, which voids this one.',
    ),
  ];
}

export function create(feed: Feed): void {
  const { languages = [], open_link = null } = feed.study ?? {};
  const test = element('input', { type: 'checkbox' });
  const note = element('input', { maxlength: '500' });
  const choices = languages.map((language) => element('option', { value: language }, language));
  const language = element('select', {}, element('option', { value: '' }, 'as the study says'), ...choices);
  open({
    title: 'A new participant',
    content: [
      ...(languages.length > 1 ? [field('Language', language)] : []),
      field('Note (only the desk sees it)', note),
      ...(open_link === null
        ? []
        : [paragraph('Anybody can join by the open link, and makes themselves a participant:'), linkRow(open_link)]),
      element('label', { class: 'check' }, test, 'A trial run of mine: it fills no cell and is in no result'),
    ],
    label: 'Make the link',
    act: async () => {
      const made = await api.create({
        test: test.checked,
        language: language.value || null,
        note: note.value.trim() || null,
      });
      await feed.refresh();
      return linkShown(made);
    },
  });
}

export function newLink({ id, code }: Row): void {
  open({
    title: `A new link for ${code}`,
    content: [paragraph('The old link stops working at once, and so does the page that was opened with it.')],
    label: 'Make a new link',
    act: async () => linkShown(await api.newLink(id)),
  });
}

export function exclude(feed: Feed, { id, code, status }: Row): void {
  const reason = element('input', { required: true, maxlength: '500', list: 'reasons' });
  const usual = ['equipment failed', 'did not follow the instructions', 'interrupted from outside', 'took part before'];
  const reasons = element('datalist', { id: 'reasons' }, ...usual.map((value) => element('option', { value })));
  open({
    title: `Exclude ${code}`,
    content: [
      paragraph(
        status === 'completed'
          ? 'The data stay stored and exported, marked as excluded with this reason; the cell is open to somebody else.'
          : 'The session ends here. What was done stays stored and exported, marked as excluded with this reason; the cell is open to somebody else.',
      ),
      paragraph(
        'Decide by the rules of the study, not by how the flights went: the report counts and lists exclusions.',
      ),
      field('Reason', reason),
      reasons,
    ],
    label: 'Exclude',
    danger: true,
    ready: () => reason.value.trim() !== '',
    act: async () => {
      await api.exclude(id, reason.value.trim());
      await feed.refresh();
    },
  });
}

export function reinstate(feed: Feed, { id, code }: Row): void {
  open({
    title: `Reinstate ${code}`,
    content: [paragraph('The exclusion stays in the log; from now on the data count again.')],
    label: 'Reinstate',
    act: async () => {
      await api.reinstate(id);
      await feed.refresh();
    },
  });
}

/** Deletes everything: the code must be typed, so that no slip of a finger does it. */
export function withdraw(feed: Feed, { id, code }: Row, done: () => void): void {
  const typed = element('input', { autocomplete: 'off', spellcheck: 'false' });
  const gone = [
    'all flights: records, key logs, timing',
    'all answers: demographics, quiz, questionnaires',
    'the log of events and the notes of the desk',
    'the link: nobody can go on with it',
  ];
  open({
    title: `Withdraw ${code}`,
    content: [
      paragraph('For somebody who takes back their consent. This deletes, now and for good:'),
      element('ul', {}, ...gone.map((what) => element('li', {}, what))),
      paragraph(
        'What stays is a tombstone: the code, and when it was withdrawn, so that the report’s flow of participants adds up. Backups and exports that were made before are not reached from here.',
      ),
      field(`Type ${code} to delete it all`, typed),
    ],
    label: 'Delete everything',
    danger: true,
    ready: () => typed.value.trim() === code,
    act: async () => {
      await api.withdraw(id);
      await feed.refresh();
      say(`${code} was withdrawn; its data are deleted.`);
      done();
    },
  });
}

export function note(feed: Feed, { id, code }: Row): void {
  const text = element('textarea', { rows: '4', maxlength: '2000', required: true });
  open({
    title: `Note on ${code}`,
    content: [field('What happened (it goes into the log, with the time, and cannot be changed)', text)],
    label: 'Note it',
    ready: () => text.value.trim() !== '',
    act: async () => {
      await api.note(id, text.value.trim());
      await feed.refresh();
    },
  });
}
