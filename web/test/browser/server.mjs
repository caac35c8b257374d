// The server that the browser test flies against: one that runs already, or one of its own.
import { spawn } from 'node:child_process';
import { once } from 'node:events';

/** How long a program may take to say its address, or to end, ms. */
const PATIENCE_MS = 20_000;

export class Server {
  url = '';
  isAway = false;

  constructor(program, words) {
    this.program = program;
    this.words = words;
    this.child = null;
  }

  /** One that runs already. */
  static running(url) {
    const server = new Server(null, []);
    server.url = url.replace(/\/$/, '');
    return server;
  }

  /** Starts `cohelm fly` on a database. */
  static async start(program, database, options) {
    const server = new Server(program, ['fly', '--database', database, ...options]);
    await server.launch('0');
    return server;
  }

  /** Starts `cohelm study run` on a study's file. */
  static async study(program, file, options) {
    const server = new Server(program, ['study', 'run', file, ...options]);
    await server.launch('0');
    return server;
  }

  /** Ends as a loss of power would end it. */
  async kill() {
    this.isAway = true;
    const { child } = this;
    this.child = null;
    child.kill('SIGKILL');
    if (child.exitCode === null) await once(child, 'exit');
  }

  get isOurs() {
    return this.program !== null;
  }

  /** Comes back under the same address. */
  async startAgain() {
    await this.launch(new URL(this.url).port);
    this.isAway = false;
  }

  /** Ends as Ctrl-C would end it. */
  async stop() {
    if (this.child === null) return;
    this.isAway = true;
    const { child } = this;
    this.child = null;
    child.kill('SIGTERM');
    const late = setTimeout(() => child.kill('SIGKILL'), PATIENCE_MS);
    if (child.exitCode === null) await once(child, 'exit');
    clearTimeout(late);
  }

  /** All episodes, the newest first. */
  async episodes() {
    const all = [];
    for (let before = ''; ;) {
      const { episodes, next } = await (await fetch(`${this.url}/api/episodes?limit=1000${before}`)).json();
      all.push(...episodes);
      if (next === null) return all;
      before = `&before=${next}`;
    }
  }

  async record(id) {
    return new Uint8Array(await (await fetch(`${this.url}/api/episodes/${id}`)).arrayBuffer());
  }

  async launch(port) {
    const child = spawn(this.program, [...this.words, '--port', port], { stdio: ['ignore', 'pipe', 'inherit'] });
    this.child = child;
    this.url = await new Promise((resolve, reject) => {
      let said = '';
      child.stdout.on('data', (bytes) => {
        said += bytes;
        const address = /http:\/\/[\d.:[\]a-z]+/.exec(said);
        if (address !== null) resolve(address[0]);
      });
      child.on('error', reject);
      child.on('exit', (code) =>
        reject(new Error(`${this.program} ended with ${code} before it said its address: ${said}`)),
      );
      setTimeout(() => reject(new Error(`${this.program} did not say its address`)), PATIENCE_MS).unref();
    });
  }
}
