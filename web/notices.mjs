// node notices.mjs [--check]: writes public/notices.txt, the licences of what others made and this page carries: the
// crates inside cohelm_page.wasm, Rust's standard library, and jsPsych with what it needs. With --check it writes nothing
// and fails if the file is out of date. vite.config.ts refuses to bundle any other package.
//
// Where a licence may be chosen it is MIT, if that is among them.
import { execFileSync } from 'node:child_process';
import { existsSync, readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const HERE = dirname(fileURLToPath(import.meta.url));
const FILE = join(HERE, 'public', 'notices.txt');
const TARGET = 'wasm32-unknown-unknown';
const RULE = '-'.repeat(100);

const HEAD = `Third-party notices

The pages of cohelm are licensed under MIT OR Apache-2.0, as cohelm is. The file jspsych.js carries jsPsych and the packages
that it needs, for the participant's page; the other scripts and the styles carry no code of others. The file cohelm_page.wasm carries the crates below, compiled, and parts of Rust's standard library.
The physics follow the methods of Box2D by Erin Catto (https://box2d.org, zlib licence), and sine and cosine those of Arm's
optimized routines (https://github.com/ARM-software/optimized-routines, MIT OR Apache-2.0 WITH LLVM-exception); both were
written anew.
`;

const STANDARD_LIBRARY = `Rust's standard library: MIT OR Apache-2.0, https://github.com/rust-lang/rust
Copyright (c) The Rust Project Contributors, and the authors of the crates that it is built with (compiler_builtins,
dlmalloc, hashbrown, libm and others), under the same terms or MIT.`;

/** Packages of npm in jspsych.js. Where the package brings no file with its licence, `holder` is who it names. */
const CARRIED = [
  { name: 'jspsych', home: 'https://www.jspsych.org', holder: 'Copyright (c) 2014-2018 Joshua R. de Leeuw' },
  { name: 'auto-bind', home: 'https://github.com/sindresorhus/auto-bind', file: 'license' },
  { name: 'random-words', home: 'https://github.com/apostrophecms/random-words', file: 'LICENSE' },
  {
    name: 'seedrandom',
    home: 'https://github.com/davidbau/seedrandom',
    holder: 'Copyright 2019 David Bau. lib/alea.js: Copyright (C) 2010 by Johannes Baagøe <baagoe@baagoe.org>',
  },
];

function cargo(...words) {
  return execFileSync('cargo', words, { cwd: HERE, encoding: 'utf8', maxBuffer: 1 << 28 });
}

/** Packages whose code is in the page, without our own: what is needed at run time, by the features that it takes. */
function crates() {
  const tree = cargo(
    'tree',
    '--locked',
    '--package',
    'cohelm-page',
    '--target',
    TARGET,
    '--edges',
    'normal,no-proc-macro',
    '--prefix',
    'none',
    '--no-dedupe',
    '--format',
    '{p}',
  );
  const needed = new Set(tree.split('\n').map((line) => line.split(' ').slice(0, 2).join(' ')));
  const { packages } = JSON.parse(cargo('metadata', '--locked', '--format-version', '1', '--filter-platform', TARGET));
  return packages
    .filter(({ name, version, source }) => source !== null && needed.has(`${name} v${version}`))
    .sort((a, b) => (a.name < b.name ? -1 : a.name > b.name ? 1 : 0));
}

/** The text of a package's licence: MIT's where that may be chosen, otherwise what it has. */
function licence({ name, license, manifest_path }) {
  const folder = dirname(manifest_path);
  const files = readdirSync(folder)
    .filter((file) => /^(licen[sc]e|copying|unlicense)/i.test(file))
    .sort();
  const mit = /\bMIT\b/.test(license) ? files.find((file) => /mit/i.test(file)) : undefined;
  const chosen = mit ?? files.find((file) => /^licen[sc]e(\.(txt|md))?$/i.test(file)) ?? files[0];
  if (chosen !== undefined) return readFileSync(join(folder, chosen), 'utf8');
  const own = join(HERE, '..', 'LICENSE-APACHE');
  if (license === 'Apache-2.0' && existsSync(own)) return readFileSync(own, 'utf8');
  throw new Error(`${name} (${license}) has no file with its licence in ${folder}`);
}

/** What is said of a package of npm. */
function carried({ name, home, file, holder }) {
  const folder = join(HERE, 'node_modules', name);
  const { version, license } = JSON.parse(readFileSync(join(folder, 'package.json'), 'utf8'));
  if (license !== 'MIT') throw new Error(`${name} has the licence ${license}, where MIT was expected`);
  const text =
    file === undefined
      ? readFileSync(join(HERE, '..', 'LICENSE-MIT'), 'utf8').replace(/^Copyright .*$/m, holder)
      : readFileSync(join(folder, file), 'utf8');
  return [`${name} ${version}: ${license}, ${home}`, '', text.trim()].join('\n');
}

function notices() {
  const texts = crates().map((made) =>
    [
      `${made.name} ${made.version}: ${made.license}, ${made.repository ?? made.homepage ?? `https://crates.io/crates/${made.name}`}`,
      ...(made.authors.length > 0 ? [`Authors: ${made.authors.join(', ')}`] : []),
      '',
      licence(made).replaceAll('\r', '').trim(),
    ].join('\n'),
  );
  const text = [HEAD, ...texts, STANDARD_LIBRARY, ...CARRIED.map(carried)].join(`\n${RULE}\n`);
  return `${text
    .split('\n')
    .map((line) => line.trimEnd())
    .join('\n')}\n`;
}

const text = notices();
if (!process.argv.includes('--check')) {
  writeFileSync(FILE, text);
  console.log(`notices: ${FILE}, ${text.length} bytes`);
} else if (!existsSync(FILE) || readFileSync(FILE, 'utf8') !== text) {
  console.error('notices: web/public/notices.txt is out of date; run node web/notices.mjs, then build the page');
  process.exit(1);
} else {
  console.log('notices: up to date');
}
