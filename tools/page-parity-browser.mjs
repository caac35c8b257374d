// node tools/page-parity-browser.mjs CHROMIUM WASM FOLDER: compares, in Chromium, what the native build wrote into
// FOLDER. Nothing is served: the browser's requests are answered from here.
import { createRequire } from 'node:module';
import { readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { report } from './parity.mjs';

const { chromium } = createRequire(new URL('../web/package.json', import.meta.url))('playwright-core');

const [program, wasm, folder] = process.argv.slice(2);
const here = (name) => new URL(name, import.meta.url);

/** What a path of the browser's is answered with. */
function answer(path) {
  if (path === '/') return { contentType: 'text/html', body: '<!doctype html><title>parity</title>' };
  if (path === '/page.wasm') return { contentType: 'application/wasm', body: readFileSync(wasm) };
  if (path.endsWith('.mjs')) return { contentType: 'text/javascript', body: readFileSync(here(`.${path}`)) };
  const flight = path.match(/^\/flights\/([^/]+)$/);
  if (flight) return { contentType: 'application/octet-stream', body: readFileSync(join(folder, flight[1])) };
  return { status: 404, body: '' };
}

/** Runs inside the browser. */
async function compareThere(names) {
  const bytes = async (path) => {
    const answered = await fetch(path);
    if (!answered.ok) throw new Error(`${path}: ${answered.status}`);
    return new Uint8Array(await answered.arrayBuffer());
  };
  const { compare } = await import('/parity.mjs');
  return compare(await bytes('/page.wasm'), names, (name) => bytes(`/flights/${name}`));
}

const browser = await chromium.launch({
  executablePath: program,
  args: ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking'],
});
try {
  const page = await browser.newPage();
  await page.route('**/*', (route) => route.fulfill(answer(new URL(route.request().url()).pathname)));
  await page.goto('http://parity.test/');
  const found = await page.evaluate(compareThere, readdirSync(folder));
  process.exitCode = report(found, `Chromium ${browser.version()}`) ? 0 : 1;
} finally {
  await browser.close();
}
