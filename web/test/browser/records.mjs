// The key log of a record, read by docs/records.md and by nobody's code.

const KINDS = ['down', 'up', 'release-all', 'stick'];

/** Events of a record. */
export function readEvents(record) {
  const view = new DataView(record.buffer, record.byteOffset, record.byteLength);
  const body = 9 + view.getUint32(5, true);
  const { ticks, events: count } = JSON.parse(new TextDecoder().decode(record.subarray(9, body)));
  let at = body;
  for (let action = 0; action < 2 * ticks; action += 1) at += view.getUint8(at) === 254 ? 17 : 1;
  const events = [];
  while (events.length < count) {
    const kind = KINDS[view.getUint8(at + 8)];
    events.push({
      tick: view.getUint32(at, true),
      atMs: view.getFloat32(at + 4, true),
      kind,
      control: view.getUint8(at + 9),
      ...(kind === 'stick' ? { stick: [0, 1, 2, 3].map((i) => view.getInt16(at + 10 + 2 * i, true)) } : {}),
    });
    at += kind === 'stick' ? 18 : 10;
  }
  return events;
}
