// node tools/page-parity.mjs WASM FOLDER: does what FOLDER/*.json say with the built page, and demands of each flight
// the very bytes of the record that the native build wrote beside it (states' and decisions' digests are among them).
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

const names = readdirSync(folder).filter((name) => name.endsWith('.json')).sort();
let ticks = 0;
const different = [];
for (const name of names) {
  const script = JSON.parse(readFileSync(join(folder, name), 'utf8'));
  const native = readFileSync(join(folder, name.replace(/json$/, 'chlm')));
  const { record, digests } = fly(script);
  ticks += digests.ticks;
  const replay = page.replay(native);
  if (Buffer.compare(native, record) !== 0 || !replay.identical) {
    different.push(name);
    console.log(`${name}: differs; the page's digests: ${JSON.stringify(digests)}, its replay: ${JSON.stringify(replay)}`);
  }
}
console.log(`${names.length} flights, ${ticks} ticks, ${names.length - different.length} identical`);
process.exit(names.length > 0 && different.length === 0 ? 0 : 1);
