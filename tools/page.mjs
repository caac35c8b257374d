// The built page's WebAssembly as an object: the least that JavaScript needs to call crates/cohelm-page/src/abi.rs.

/** Instantiates the bytes of web/dist/cohelm_page.wasm. */
export async function loadPage(bytes) {
  const { instance } = await WebAssembly.instantiate(bytes);
  return new Page(instance.exports);
}

class Page {
  constructor(exports) {
    this.exports = exports;
  }

  about = () => json(this.call('about'));
  addModel = (bytes) => json(this.call('model', bytes));
  begin = (setup) => json(this.call('begin', text(JSON.stringify(setup))));
  tick = () => json(this.call('tick'));
  events = (from) => this.call('events', null, from);
  digests = () => json(this.call('digests'));
  finish = () => this.call('finish');
  watch = (record) => json(this.call('watch', record));
  seek = (ticks) => json(this.call('seek', null, ticks));
  replay = (record) => json(this.call('replay', record));

  /** A change as the key log has it: {down: 2}, {up: 2}, {stick: [x, y, z, w]} or "release-all". */
  change(change, atMs) {
    if (change === 'release-all') this.call('key', null, 2, 0, atMs);
    else if ('down' in change) this.call('key', null, 0, change.down, atMs);
    else if ('up' in change) this.call('key', null, 1, change.up, atMs);
    else this.call('stick', null, ...change.stick, atMs);
  }

  /** Calls a function with bytes for its input, if it takes any, and numbers; gives a copy of the bytes it answers. */
  call(name, input, ...numbers) {
    if (input) {
      const place = this.exports.cohelm_input(input.length);
      if (place === 0) throw new Error(`${input.length} bytes are too many`);
      new Uint8Array(this.exports.memory.buffer, place, input.length).set(input);
    }
    let length;
    try {
      length = this.exports[`cohelm_${name}`](...numbers);
    } catch (trap) {
      const message = this.output(this.exports.cohelm_panic());
      throw new Error(`the page stopped: ${new TextDecoder().decode(message)}`, { cause: trap });
    }
    const output = this.output(Math.abs(length));
    if (length < 0) throw new Error(new TextDecoder().decode(output));
    return output;
  }

  output(length) {
    return new Uint8Array(this.exports.memory.buffer, this.exports.cohelm_output(), length).slice();
  }
}

const text = (string) => new TextEncoder().encode(string);
const json = (bytes) => (bytes.length ? JSON.parse(new TextDecoder().decode(bytes)) : null);
