import { defineConfig } from 'vite';

// The built page is committed and embedded in the binary: fixed names, no source maps, one script and one style sheet.
export default defineConfig({
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
