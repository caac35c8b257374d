// node tools/page-parity.mjs WASM FOLDER: compares, in Node, what the native build wrote into FOLDER.
import { readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { compare, report } from './parity.mjs';

const [wasm, folder] = process.argv.slice(2);
const found = await compare(readFileSync(wasm), readdirSync(folder), (name) => readFileSync(join(folder, name)));
process.exit(report(found, `Node ${process.version}`) ? 0 : 1);
