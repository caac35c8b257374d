// What can be read of a record without flying it: docs/records.md says what each byte is.

import type { Ending, KeyKind, Setup } from './core';

/** The formats this page reads: the second has a tape behind it, which only the loop reads. */
const WITH_TAPE = 2;
const FORMATS = [1, WITH_TAPE];
const NOTHING = 255;
const AXES = 254;
const STICK = 3;
/** Bytes of an event, and of one that moved a stick. */
const [EVENT, STICK_EVENT] = [10, 18];

/** An action as a record has it: the index of a command, four axes, or nothing. */
export type Recorded = number | [number, number, number, number] | null;

/** A record's contents. */
export interface FlightRecord {
  setup: Setup;
  ending: Ending;
  asked: Recorded[];
  executed: Recorded[];
  /** How many key events it has. */
  events: number;
  /** What a plant elsewhere said of itself; null if physics of ours flew it. */
  elsewhere: Elsewhere | null;
}

/** A plant elsewhere: its own name, and why it was lost, if it was. */
export interface Elsewhere {
  name: string;
  lost: string | null;
}

/** Bytes that are no record, or one of a format that this page does not read. */
export class RecordError extends Error {}

/** Reads a record; the loop checks it far more strictly before it flies it. */
export function readRecord(bytes: Uint8Array): FlightRecord {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (bytes.length < 9 || new TextDecoder().decode(bytes.subarray(0, 4)) !== 'CHLM') {
    throw new RecordError('This is no record of a flight.');
  }
  if (!FORMATS.includes(view.getUint8(4))) {
    throw new RecordError(
      `This record has format ${view.getUint8(4)}; this page reads formats ${FORMATS.join(' and ')}. Use the version of cohelm that wrote it.`,
    );
  }
  const body = 9 + view.getUint32(5, true);
  try {
    const header = JSON.parse(new TextDecoder().decode(bytes.subarray(9, body))) as {
      setup: Setup;
      ending: Ending;
      ticks: number;
      events: number;
    };
    const record: FlightRecord = {
      setup: header.setup,
      ending: header.ending,
      asked: [],
      executed: [],
      events: header.events,
      elsewhere: null,
    };
    let at = body;
    for (let tick = 0; tick < header.ticks; tick += 1) {
      for (const list of [record.asked, record.executed]) {
        const [action, next] = readAction(view, at);
        list.push(action);
        at = next;
      }
    }
    for (let event = 0; event < header.events; event += 1) {
      at += view.getUint8(at + 8) === STICK ? STICK_EVENT : EVENT;
    }
    if (view.getUint8(4) === WITH_TAPE) record.elsewhere = readElsewhere(bytes, view, at);
    return record;
  } catch (error) {
    throw new RecordError(`This record is damaged: ${String(error)}`);
  }
}

/** The header of a tape, which says whose states follow. */
function readElsewhere(bytes: Uint8Array, view: DataView, at: number): Elsewhere {
  const body = at + 4 + view.getUint32(at, true);
  const { about, lost } = JSON.parse(new TextDecoder().decode(bytes.subarray(at + 4, body))) as {
    about: { name: string };
    lost?: string | null;
  };
  return { name: about.name, lost: lost ?? null };
}

function readAction(view: DataView, at: number): [Recorded, number] {
  const kind = view.getUint8(at);
  if (kind === NOTHING) return [null, at + 1];
  if (kind !== AXES) return [kind, at + 1];
  const axis = (i: number) => view.getFloat32(at + 1 + 4 * i, true);
  return [[axis(0), axis(1), axis(2), axis(3)], at + 17];
}

/** The events of a key log that lie before a tick: how many, and their bytes. */
export function eventsBefore(log: Uint8Array, tick: number): { count: number; bytes: Uint8Array } {
  const view = new DataView(log.buffer, log.byteOffset, log.byteLength);
  let [at, count] = [0, 0];
  while (at + EVENT <= log.length && view.getUint32(at, true) < tick) {
    at += view.getUint8(at + 8) === STICK ? STICK_EVENT : EVENT;
    count += 1;
  }
  return { count, bytes: log.subarray(0, at) };
}

/** An event of a key log. */
export type LoggedKey =
  | { tick: number; atMs: number; kind: KeyKind; control: number }
  | { tick: number; atMs: number; kind: 'stick'; stick: [number, number, number, number] };

const KINDS: KeyKind[] = ['down', 'up', 'release-all'];

/** Reads the events of a key log; what is cut off or of no known kind ends the list. */
export function keyEvents(log: Uint8Array): LoggedKey[] {
  const view = new DataView(log.buffer, log.byteOffset, log.byteLength);
  const events: LoggedKey[] = [];
  for (let at = 0; at + EVENT <= log.length;) {
    const [tick, atMs, kind] = [view.getUint32(at, true), view.getFloat32(at + 4, true), view.getUint8(at + 8)];
    if (kind === STICK) {
      if (at + STICK_EVENT > log.length) break;
      const axis = (i: number) => view.getInt16(at + 10 + 2 * i, true);
      events.push({ tick, atMs, kind: 'stick', stick: [axis(0), axis(1), axis(2), axis(3)] });
    } else if (KINDS[kind] === undefined) break;
    else events.push({ tick, atMs, kind: KINDS[kind], control: view.getUint8(at + 9) });
    at += kind === STICK ? STICK_EVENT : EVENT;
  }
  return events;
}
