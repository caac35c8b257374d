import { defineConfig, type Plugin } from 'vite';

/** The page carries no package of others: one that crept in would need a notice (notices.mjs), so it ends the build. */
const onlyOurOwn: Plugin = {
  name: 'only-our-own',
  generateBundle(_, bundle) {
    for (const chunk of Object.values(bundle)) {
      const foreign = chunk.type === 'chunk' ? chunk.moduleIds.filter((id) => id.includes('node_modules')) : [];
      if (foreign.length > 0)
        this.error(`the page would carry ${foreign.join(', ')}: add its licence to notices.mjs first`);
    }
  },
};

// The built page is committed and embedded in the binary: fixed names, no source maps, one script and one style sheet.
export default defineConfig({
  plugins: [onlyOurOwn],
  build: {
    outDir: 'dist',
    // The WebAssembly beside them is built by tools/build-wasm, not from here.
    emptyOutDir: false,
    target: 'es2022',
    sourcemap: false,
    modulePreload: false,
    cssCodeSplit: false,
    assetsInlineLimit: 0,
    rollupOptions: {
      output: { entryFileNames: 'app.js', chunkFileNames: '[name].js', assetFileNames: 'app[extname]' },
    },
  },
  server: { proxy: { '/api': 'http://127.0.0.1:8080', '/ws': { target: 'ws://127.0.0.1:8080', ws: true } } },
});
