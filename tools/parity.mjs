// Flies again what the native build flew, and demands its very bytes. Knows neither Node nor a browser: the files of a
// folder come in as a list of names and a function that reads one of them.
import { loadPage } from './page.mjs';

/**
 * Does what each NAME.json says with the built page, and demands of each flight the very bytes of NAME.chlm, the record
 * that the native build wrote (digests of all states and decisions are among them); then has the page replay every
 * record, those of pilots without keys included.
 */
export async function compare(wasm, names, read) {
  const page = await loadPage(wasm);
  const flier = new Flier(page, read);
  const records = names.filter((name) => name.endsWith('.chlm')).sort();
  const different = [];
  let ticks = 0;
  for (const name of records) {
    const native = await read(name);
    const script = name.replace(/chlm$/, 'json');
    const told = [];
    if (names.includes(script)) {
      const { record, digests } = await flier.fly(JSON.parse(new TextDecoder().decode(await read(script))));
      if (!same(native, record)) told.push(`flown, its digests are ${JSON.stringify(digests)}`);
    }
    const replay = page.replay(native);
    if (!replay.identical) told.push(`replayed: ${JSON.stringify(replay)}`);
    ticks += page.watch(native).ticks;
    if (told.length) different.push(`${name} differs: ${told.join('; ')}`);
  }
  return { flights: records.length, ticks, different };
}

/** Prints what `compare` found; true if it was something, and all the same. */
export function report({ flights, ticks, different }, where) {
  different.forEach((line) => console.log(line));
  console.log(`${where}: ${flights} flights, ${ticks} ticks, ${flights - different.length} identical`);
  return flights > 0 && different.length === 0;
}

class Flier {
  constructor(page, read) {
    Object.assign(this, { page, read, loaded: new Set() });
  }

  async fly({ models, setup, events, ticks }) {
    const { page } = this;
    await this.load(models);
    page.begin(setup);
    const queue = [...events];
    const change = (due) => {
      while (queue.length && due(queue[0])) {
        const event = queue.shift();
        page.change(event.change, event.at_ms);
      }
    };
    for (let tick = 0; tick < ticks; tick += 1) {
      change((event) => event.tick === tick);
      page.tick();
    }
    change(() => true);
    const digests = page.digests();
    return { record: page.finish(), digests };
  }

  async load(models) {
    for (const model of models.filter((name) => !this.loaded.has(name))) {
      this.page.addModel(await this.read(model));
      this.loaded.add(model);
    }
  }
}

const same = (a, b) => a.length === b.length && a.every((byte, index) => byte === b[index]);
