import { fileURLToPath } from 'node:url';
import { defineConfig, type Plugin } from 'vite';

/** The packages of others that the participant's page carries; notices.mjs has the licence of each. */
const CARRIED = ['jspsych', 'auto-bind', 'random-words', 'seedrandom'];

/** Any other package would need a notice (notices.mjs), so one that crept in ends the build. */
const onlyCarried: Plugin = {
  name: 'only-carried',
  generateBundle(_, bundle) {
    const isForeign = (id: string) => {
      const name = id.split('node_modules/').at(-1)!.split('/')[0]!;
      return id.includes('node_modules') && !CARRIED.includes(name);
    };
    for (const chunk of Object.values(bundle)) {
      const foreign = chunk.type === 'chunk' ? chunk.moduleIds.filter(isForeign) : [];
      if (foreign.length > 0)
        this.error(`the page would carry ${foreign.join(', ')}: add its licence to notices.mjs first`);
    }
  },
};

const page = (name: string) => fileURLToPath(new URL(`${name}.html`, import.meta.url));

// The built pages are committed and embedded in the binary: fixed names, no source maps, a script and a style sheet for
// each page, and one of each for what they share.
export default defineConfig({
  plugins: [onlyCarried],
  build: {
    outDir: 'dist',
    // The WebAssembly beside them is built by tools/build-wasm, not from here.
    emptyOutDir: false,
    target: 'es2022',
    sourcemap: false,
    modulePreload: false,
    assetsInlineLimit: 0,
    rolldownOptions: {
      input: { app: page('index'), study: page('study'), research: page('research') },
      output: {
        entryFileNames: '[name].js',
        chunkFileNames: '[name].js',
        assetFileNames: '[name][extname]',
        codeSplitting: {
          groups: [
            { name: 'jspsych', test: /node_modules/ },
            { name: 'shared', test: /web\/(src|jspsych-cohelm)\//, minShareCount: 2 },
          ],
        },
      },
    },
  },
  server: {
    proxy: {
      '/api': 'http://127.0.0.1:8080',
      '/join': 'http://127.0.0.1:8080',
      '/p/': 'http://127.0.0.1:8080',
      '/ws': { target: 'ws://127.0.0.1:8080', ws: true },
    },
  },
});
