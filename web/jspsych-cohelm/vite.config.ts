import { copyFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { defineConfig } from 'vite';

const here = (path: string) => fileURLToPath(new URL(path, import.meta.url));

// One module, one style sheet and the loop, to be copied into an experiment. jsPsych stays the experiment's own.
export default defineConfig({
  root: here('.'),
  publicDir: false,
  plugins: [
    {
      name: 'the-loop',
      closeBundle: () => copyFileSync(here('../dist/cohelm_page.wasm'), here('dist/cohelm_page.wasm')),
    },
  ],
  build: {
    target: 'es2022',
    lib: { entry: here('src/index.ts'), formats: ['es'], fileName: 'jspsych-cohelm', cssFileName: 'jspsych-cohelm' },
    rolldownOptions: { external: ['jspsych'] },
  },
});
