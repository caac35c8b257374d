// A Chromium for a browser test, and what every such test does with it: steps, screenshots, complaints.
import { existsSync } from 'node:fs';
import { join } from 'node:path';
import { chromium } from '../../node_modules/playwright-core/index.mjs';

const PLACES = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];
/** How long something may take to come, ms. */
const PATIENCE_MS = 15_000;

export class Tester {
  passed = 0;
  complaints = [];

  constructor(browser, folder) {
    this.browser = browser;
    this.folder = folder;
  }

  /** Starts the browser that CHROMIUM names, or the one of this machine. */
  static async start(folder) {
    const executablePath = [process.env.CHROMIUM, ...PLACES].find((path) => path && existsSync(path));
    const quiet = ['--disable-gpu', '--no-first-run', '--disable-background-networking', '--disable-component-update'];
    const args = ['--headless', '--no-sandbox', '--disable-quic', '--disable-sync', ...quiet];
    return new Tester(await chromium.launch({ executablePath, args }), folder);
  }

  /** A page of its own, as somebody has it who was never here. */
  async page(viewport) {
    const context = await this.browser.newContext({ viewport });
    const page = await context.newPage();
    page.setDefaultTimeout(PATIENCE_MS);
    page.on('pageerror', (error) => this.complaints.push(error.message));
    page.on('console', (message) => {
      if (message.type() === 'error') this.complaints.push(message.text());
    });
    return page;
  }

  /** One line a step: its name, and how long it took. */
  async step(name, work) {
    const since = performance.now();
    await work();
    this.passed += 1;
    console.log(`ok   ${name} (${((performance.now() - since) / 1000).toFixed(1)} s)`);
  }

  shot(page, name) {
    return page.screenshot({ path: join(this.folder, `${name}.png`) });
  }
}
