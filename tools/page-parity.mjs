// node tools/page-parity.mjs WASM FOLDER: does what FOLDER/*.json say with the built page, and demands of each flight
// the very bytes of the record that the native build wrote beside it (digests of all states and decisions are among
// them); then has the page replay every record, those of pilots without keys included.
import { readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { loadPage } from './page.mjs';

const [wasm, folder] = process.argv.slice(2);
const page = await loadPage(readFileSync(wasm));

const loaded = new Set();

function fly(script) {
  for (const model of script.models.filter((name) => !loaded.has(name))) {
    page.addModel(readFileSync(join(folder, model)));
    loaded.add(model);
  }
  page.begin(script.setup);
  const events = script.events[Symbol.iterator]();
  let event = events.next().value;
  for (let tick = 0; tick < script.ticks; tick += 1) {
    while (event && event.tick === tick) {
      page.change(event.change, event.at_ms);
      event = events.next().value;
    }
    page.tick();
  }
  while (event) {
    page.change(event.change, event.at_ms);
    event = events.next().value;
  }
  const digests = page.digests();
  return { record: page.finish(), digests };
}

const files = readdirSync(folder).sort();
const records = files.filter((name) => name.endsWith('.chlm'));
let ticks = 0;
const different = [];
for (const name of records) {
  const native = readFileSync(join(folder, name));
  const script = name.replace(/chlm$/, 'json');
  const told = [];
  if (files.includes(script)) {
    const { record, digests } = fly(JSON.parse(readFileSync(join(folder, script), 'utf8')));
    if (Buffer.compare(native, record) !== 0) told.push(`flown, its digests are ${JSON.stringify(digests)}`);
  }
  const replay = page.replay(native);
  if (!replay.identical) told.push(`replayed: ${JSON.stringify(replay)}`);
  ticks += page.watch(native).ticks;
  if (told.length) {
    different.push(name);
    console.log(`${name} differs: ${told.join('; ')}`);
  }
}
console.log(`${records.length} flights, ${ticks} ticks, ${records.length - different.length} identical`);
process.exit(records.length > 0 && different.length === 0 ? 0 : 1);
