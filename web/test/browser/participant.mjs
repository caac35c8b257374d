// Goes through a study in the page as a participant does, with keyboard and mouse: reads what is on the screen, does
// what it asks, and is over at the thanks. What it answers is pressed at random places by a machine, so it is for
// participants that are marked as tests.

/** How long a screen may take to come, ms. */
const PATIENCE_MS = 60_000;
/** Whatever a participant can be asked for: a screen, or a card over a flight. */
const ASKS = '[data-screen], .stage .card:not([hidden])';

export class Participant {
  /** Flights that were begun so far. */
  flights = 0;
  /** Screens in the order seen. */
  seen = [];

  /** `see(name)` is told each screen when it has come; `inTheAir(number)` each flight as it begins. */
  constructor(page, { see = async () => {}, inTheAir = async () => {} } = {}) {
    this.page = page;
    this.see = see;
    this.inTheAir = inTheAir;
  }

  /** Goes on until the screen with this name has come. */
  async walkTo(goal = 'thanks') {
    for (;;) {
      const name = await this.asked();
      if (this.seen.at(-1) !== name) {
        this.seen.push(name);
        await this.see(name);
      }
      if (name === goal) return;
      await this.answer(name);
    }
  }

  /** What is on the screen now: the name of a screen, or `flight-` and the kind of a card. */
  async asked() {
    await this.page.waitForSelector(ASKS, { timeout: PATIENCE_MS });
    return this.page.evaluate((asks) => {
      const node = document.querySelector(asks);
      return node?.dataset.screen ?? `flight-${node?.dataset.kind}`;
    }, ASKS);
  }

  async answer(name) {
    const { page } = this;
    if (name === 'consent') await page.check('#agree');
    if (name === 'form' || name === 'questionnaire') await this.fill();
    if (name === 'quiz') await this.quiz();
    if (name === 'device') await this.device();
    else if (name === 'flight-ready' || name === 'flight-interrupted') await this.fly();
    else if (['opening', 'flight-saving', 'flight-loading'].includes(name)) await page.waitForTimeout(200);
    else if (name.startsWith('flight-')) await page.keyboard.press('Enter');
    else await this.goOn();
  }

  /** Presses what leads on, and waits until something else is asked. */
  async goOn(button = '.primary:enabled') {
    const { page } = this;
    const before = await page.$('[data-screen]');
    await page.click(`[data-screen] ${button}`, { timeout: PATIENCE_MS });
    const left = () => before.evaluate((node) => !node.isConnected).catch(() => true);
    for (let waited = 0; waited < 20 && !(await left()); waited += 1) await page.waitForTimeout(100);
  }

  async device() {
    const { page } = this;
    await page.click('[data-screen=device] .primary');
    await page.waitForSelector('.good, .bad', { timeout: PATIENCE_MS });
    await this.see('device-done');
    const isSlow = (await page.$('.bad')) !== null;
    if (!isSlow) await this.goOn();
    else if ((await page.$('[data-screen=device] .secondary')) !== null) await this.goOn('.secondary');
  }

  /** Answers every question. */
  async fill() {
    for (const field of await this.page.$$('.field')) {
      const kind = await field.getAttribute('data-kind');
      if (kind === 'number') await (await field.$('input')).fill('42');
      else if (kind === 'text') await (await field.$('input, textarea')).fill('A test.');
      else if ((await field.$('input.line')) !== null) await this.touch(await field.$('input.line'));
      else {
        const options = await field.$$('label');
        await options[Math.floor(options.length / 2)].click();
      }
    }
    await this.see('filled');
  }

  /** Touches a line a little right of its middle. */
  async touch(line) {
    await line.scrollIntoViewIfNeeded();
    const { x, y, width, height } = await line.boundingBox();
    await this.page.mouse.click(x + 0.6 * width, y + height / 2);
  }

  /** Tries the answers to each question in turn, until they are right. */
  async quiz() {
    const { page } = this;
    this.tries = (this.tries ?? -1) + 1;
    for (const field of await page.$$('.field')) {
      const options = await field.$$('label');
      await options[this.tries % options.length].click();
    }
  }

  /** Flies until the flight is over, however that may be. */
  async fly() {
    const { page } = this;
    await page.keyboard.press('Enter');
    await page.waitForSelector('.countdown', { state: 'visible' });
    await page.waitForSelector('.countdown', { state: 'hidden', timeout: PATIENCE_MS });
    this.flights += 1;
    await this.inTheAir(this.flights);
    const isOver = async () => (await page.$(ASKS)) !== null;
    while (!(await isOver())) {
      await page.keyboard.press('ArrowUp', { delay: 90 });
      await page.waitForTimeout(60);
    }
  }
}
