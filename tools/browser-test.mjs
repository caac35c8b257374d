// The browser test; `tools/browser-test` says how to call it. One line a step; it ends with 1 at the first that fails.
import assert from "node:assert/strict";
import { existsSync, mkdirSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "../web/node_modules/playwright-core/index.mjs";
import { Server } from "../web/test/browser/server.mjs";
import * as canvas from "../web/test/browser/canvas.mjs";
import { readEvents } from "../web/test/browser/records.mjs";

const [folder, ...rest] = process.argv.slice(2);
if (folder === undefined) {
  console.error(
    "usage: tools/browser-test FOLDER [URL | -- OPTIONS OF cohelm fly]",
  );
  process.exit(2);
}
mkdirSync(folder, { recursive: true });
const scratch = mkdtempSync(join(tmpdir(), "cohelm-browser-"));
const server =
  rest[0] !== undefined && rest[0] !== "--"
    ? Server.running(rest[0])
    : await Server.start(
        process.env.COHELM ?? "target/release/cohelm",
        join(scratch, "flights.db"),
        rest.slice(1),
      );

const executablePath = [
  process.env.CHROMIUM,
  "/usr/bin/chromium",
  "/usr/bin/chromium-browser",
  "/usr/bin/google-chrome",
].find((path) => path && existsSync(path));
const browser = await chromium.launch({
  executablePath,
  args: [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
  ],
});
const context = await browser.newContext({
  viewport: { width: 1366, height: 768 },
});
const page = await context.newPage();
page.setDefaultTimeout(15_000);
const complaints = [];
page.on("pageerror", (error) => complaints.push(error.message));
page.on("console", (message) => {
  if (
    message.type() === "error" &&
    !(server.isAway && message.text().includes("WebSocket"))
  )
    complaints.push(message.text());
});

let passed = 0;
/** A step of the test: its name in one line, and how long it took. */
async function step(name, work) {
  const since = performance.now();
  await work();
  passed += 1;
  console.log(
    `ok   ${name} (${((performance.now() - since) / 1000).toFixed(1)} s)`,
  );
}

const shot = (name) => page.screenshot({ path: join(folder, `${name}.png`) });
const card = (kind) => page.locator(`.card[data-kind="${kind}"]:not([hidden])`);
const anyEnding = page.locator(
  ".card:not([hidden]):is([data-kind=goal], [data-kind=elsewhere], [data-kind=crash], [data-kind=out-of-bounds], [data-kind=time-limit])",
);
const seconds = async () =>
  Number.parseFloat(await page.locator(".hud .clock").innerText());
/** The flight's clock and the page's, read at once. */
const moment = () =>
  page.evaluate(() => ({
    world_s: Number.parseFloat(
      document.querySelector(".hud .clock").textContent,
    ),
    here_s: performance.now() / 1000,
  }));
/** Waits until the flight's clock has moved on. */
async function aTick() {
  const since = await seconds();
  await assertSoon(async () => (await seconds()) > since, "the clock moves");
}
const held = (count) =>
  assertSoon(
    async () => (await page.locator(".hud kbd.held").count()) === count,
    `${count} held keys are shown`,
  );
/** Chooses how fast the next flight is flown. */
async function speed(scale) {
  await page.selectOption("footer > label select", scale);
  await card("ready").waitFor();
}
const finished = async (count) => {
  await assertSoon(
    async () =>
      (await server.episodes()).filter(
        (episode) => episode.state === "finished",
      ).length >= count,
    `${count} finished episodes`,
  );
  return server.episodes();
};

async function assertSoon(holds, what) {
  for (
    const until = Date.now() + 10_000;
    Date.now() < until;
    await page.waitForTimeout(50)
  ) {
    if (await holds()) return;
  }
  assert.fail(`it did not come to this: ${what}`);
}

async function choose(mode) {
  await page.click(`[data-mode="${mode}"]`);
  await card("ready").waitFor();
  // The world is drawn with the next frame.
  await page.waitForTimeout(120);
}

try {
  const before = (await server.episodes()).length;

  await step(
    "the page opens, connected, with the person’s own goal marked in amber",
    async () => {
      await page.goto(server.url);
      await card("ready").waitFor();
      await page.locator(".dot[data-state=on]").waitFor();
      await choose("misc-r");
      const amber = await canvas.columns(page, "back", canvas.AMBER);
      assert.equal(
        amber.groups,
        1,
        `one goal and no other is amber, found ${amber.groups} groups`,
      );
      assert.ok(amber.count > 500, `amber covers ${amber.count} pixels`);
      await shot("1-ready");
    },
  );

  await step(
    "the footer fits into one row, and nothing is cut off",
    async () => {
      const { height } = await page.locator("footer").boundingBox();
      assert.ok(height < 64, `the footer is ${height} px high`);
      assert.ok(
        await page.evaluate(
          () =>
            document.documentElement.scrollWidth <= innerWidth &&
            document.documentElement.scrollHeight <= innerHeight,
        ),
      );
    },
  );

  await step(
    "a flight in MISC-R, from start to end, with the overlay",
    async () => {
      await page.keyboard.press("o");
      await page.locator(".overlay").waitFor();
      await page.keyboard.press("Enter");
      const start = await canvas.craft(page);
      await assertSoon(
        async () => {
          const later = await canvas.craft(page);
          return Math.hypot(later.x - start.x, later.y - start.y) > 3;
        },
        `the craft moves from ${JSON.stringify(start)}`,
      );
      await page.keyboard.down("ArrowUp");
      await held(1);
      assert.equal(await page.locator(".overlay .values .row").count(), 6);
      assert.match(
        await page.locator(".overlay .chip.asked").innerText(),
        /main on/,
      );
      await shot("2-misc-r");
      await page.keyboard.up("ArrowUp");
      for (let i = 0; i < 160 && (await anyEnding.count()) === 0; i += 1) {
        await page.keyboard.press("ArrowUp", { delay: 90 });
        await page.waitForTimeout(60);
      }
      await anyEnding.waitFor();
      await shot("3-misc-r-end");
      await page.keyboard.press("o");
    },
  );

  await step(
    "a flight alone: the flame burns while the key is held, and only then",
    async () => {
      await choose("hic");
      // It flies through this step and the next: at this speed for ten seconds, with nobody's help.
      await speed("0.25");
      await page.keyboard.press("Enter");
      const dark = await canvas.count(page, "front", canvas.FIRE);
      await page.keyboard.down("ArrowUp");
      // The browser's own auto-repeat: the same key comes again without having been released.
      await page.keyboard.down("ArrowUp");
      let bright = 0;
      await assertSoon(async () => {
        bright = await canvas.count(page, "front", canvas.FIRE);
        return bright > dark + 150;
      }, `fire while the key is held, ${dark} pixels before`);
      await page.keyboard.up("ArrowUp");
      await assertSoon(
        async () =>
          (await canvas.count(page, "front", canvas.FIRE)) < bright / 2,
        `less fire after the key was released, ${bright} pixels before`,
      );
      assert.equal(await anyEnding.count(), 0, "it still flies");
    },
  );

  await step(
    "when the window loses its focus, keys are released and time stands still",
    async () => {
      await page.keyboard.down("ArrowUp");
      await page.keyboard.down("ArrowLeft");
      await held(2);
      await loseFocus();
      await card("paused").waitFor();
      const stopped = await seconds();
      await shot("4-paused");
      await page.waitForTimeout(400);
      assert.equal(await seconds(), stopped);
      await page.keyboard.up("ArrowUp");
      await page.keyboard.up("ArrowLeft");
      await page.keyboard.press("Enter");
      await assertSoon(
        async () =>
          (await seconds()) > stopped || (await anyEnding.count()) > 0,
        "the flight goes on",
      );
      assert.equal(await page.locator(".hud kbd.held").count(), 0);
      await anyEnding.waitFor({ timeout: 60_000 });
      await shot("5-alone-end");
      await speed("1");
    },
  );

  await step(
    "the robot flies alone, at half the speed, until it is stopped",
    async () => {
      await choose("demo");
      await speed("0.5");
      await page.keyboard.press("Enter");
      await assertSoon(async () => (await seconds()) > 0.1, "the clock runs");
      const from = await moment();
      await page.waitForTimeout(1500);
      const to = await moment();
      const rate = (to.world_s - from.world_s) / (to.here_s - from.here_s);
      assert.ok(
        rate > 0.35 && rate < 0.6,
        `${rate.toFixed(2)} seconds of the world in a second`,
      );
      await page.keyboard.press("Escape");
      await page.click(".card .secondary");
      await card("abandoned").waitFor();
      await speed("1");
    },
  );

  let alone;
  await step("all flights are stored, as they were flown", async () => {
    const [robot, newest, older] = await finished(before + 3);
    assert.deepEqual(
      [robot.rule, newest.rule, older.rule],
      ["robot", "hic", "misc-r"],
    );
    assert.deepEqual([robot.ending, robot.time_scale], ["abandoned", 0.5]);
    for (const episode of [newest, older]) {
      assert.equal(episode.pilot, "person");
      assert.ok(
        episode.ticks > 20,
        `episode ${episode.id} has ${episode.ticks} ticks`,
      );
    }
    assert.match(older.values ?? "", /^[0-9a-f]{64}$/);
    alone = newest;
  });

  await step(
    "its key log has every press once and the release at the pause",
    async () => {
      const kinds = readEvents(await server.record(alone.id)).map(
        (event) => event.kind,
      );
      assert.deepEqual(kinds, ["down", "up", "down", "down", "release-all"]);
    },
  );

  await step(
    "the list shows them, and a click replays one, bit for bit",
    async () => {
      await page.click("[data-tab=episodes]");
      const rows = page.locator("tbody tr");
      await rows.first().waitFor();
      assert.equal(await rows.count(), Math.min(before + 3, 50));
      await shot("6-episodes");
      await rows.nth(2).click();
      await page.locator(".exact[data-identical=true]").waitFor();
      await page.selectOption(".player select", "4");
      await assertSoon(
        async () => /Play/.test(await page.locator(".play").innerText()),
        "the replay plays to its end",
      );
      await shot("7-replay");
    },
  );

  await step(
    "the scrubber goes to any moment, by mouse and by keys",
    async () => {
      const slider = page.locator(".scrubber input");
      const { x, y, width, height } = await slider.boundingBox();
      const time = async () =>
        Number.parseFloat(await page.locator(".time").innerText());
      const at = async (part) => {
        await page.mouse.click(x + part * width, y + height / 2);
        await page.waitForTimeout(150);
        return { time: await time(), place: await canvas.craft(page) };
      };
      const [late, early] = [await at(0.8), await at(0.1)];
      assert.ok(
        late.time > 4 * early.time,
        `${early.time} s and ${late.time} s`,
      );
      assert.ok(
        Math.hypot(late.place.x - early.place.x, late.place.y - early.place.y) >
          20,
        "the craft is elsewhere",
      );
      await page.keyboard.press("ArrowRight");
      assert.equal((await time()).toFixed(2), (early.time + 0.02).toFixed(2));
      await shot("8-scrubbed");
    },
  );

  await step(
    "a plant with axes is steered by a drag on the picture",
    async () => {
      await page.keyboard.press("Escape");
      await page.click("[data-tab=fly]");
      await choose("hic");
      await page.click("footer .choices > button");
      await page.selectOption("select[data-name=plant]", "point");
      await card("ready").waitFor();
      await page.locator(".card .drag").waitFor();
      // Pushed that far it is out of bounds in two seconds.
      await speed("0.25");
      await page.keyboard.press("Enter");
      const stick = page.locator(".stage .stick:not([hidden])");
      assert.equal(await stick.count(), 0);
      await page.mouse.move(500, 400);
      await page.mouse.down();
      await page.mouse.move(560, 330, { steps: 4 });
      await stick.waitFor({ state: "attached" });
      await aTick();
      await shot("9-drag");
      await page.mouse.up();
      await stick.waitFor({ state: "detached" });
      // What is let go of counts at the next tick; before it the pause would let go of everything.
      await aTick();
      await page.keyboard.press("Escape");
      await page.click(".card .secondary");
      await card("abandoned").waitFor();
      const [dragged] = await finished(before + 4);
      const log = readEvents(await server.record(dragged.id));
      assert.ok(log.every((event) => event.kind === "stick"));
      assert.ok(log.some(({ stick: [x, y] }) => x > 15_000 && y > 15_000));
      assert.deepEqual(log.at(-1).stick, [0, 0, 0, 0]);
      await speed("1");
      await page.click("footer .choices > button");
      await page.selectOption("select[data-name=plant]", "flag-lander");
      await card("ready").waitFor();
    },
  );

  if (server.isOurs) {
    await step(
      "what is flown while the server is away is delivered when it is back",
      async () => {
        await page.keyboard.press("Escape");
        await page.click("[data-tab=fly]");
        await choose("hic");
        await server.stop();
        await page.locator(".dot[data-state=off]").waitFor();
        await page.keyboard.press("Enter");
        await page.keyboard.press("ArrowLeft", { delay: 150 });
        await anyEnding.waitFor();
        await shot("10-away");
        await server.startAgain();
        const [newest] = await finished(before + 5);
        assert.equal(newest.rule, "hic");
      },
    );
  }

  await step(
    "on a phone nothing is cut off, and a finger on a button steers",
    async () => {
      const phone = await browser.newContext({
        viewport: { width: 390, height: 844 },
        hasTouch: true,
        isMobile: true,
      });
      const small = await phone.newPage();
      small.on("pageerror", (error) => complaints.push(error.message));
      await small.goto(server.url);
      await small.locator('.card[data-kind="ready"]:not([hidden])').waitFor();
      assert.ok(
        await small.evaluate(
          () => document.documentElement.scrollWidth <= innerWidth,
        ),
      );
      await small.tap(".card .primary");
      const { x, y, width, height } = await small
        .locator(".touch-keys button")
        .first()
        .boundingBox();
      assert.ok(Math.min(width, height) >= 44, `${width} × ${height} pixels`);
      const finger = await phone.newCDPSession(small);
      const touch = (type, touchPoints) =>
        finger.send("Input.dispatchTouchEvent", { type, touchPoints });
      const held = (count) =>
        small.waitForFunction(
          (wanted) =>
            document.querySelectorAll(".hud kbd.held").length === wanted,
          count,
        );
      await touch("touchStart", [{ x: x + width / 2, y: y + height / 2 }]);
      await held(1);
      await small.screenshot({ path: join(folder, "11-phone.png") });
      await touch("touchEnd", []);
      await held(0);
      await phone.close();
    },
  );

  await step("nothing was complained of", () =>
    assert.deepEqual(complaints, []),
  );
  console.log(`browser-test: ${passed} steps passed; screenshots in ${folder}`);
} catch (error) {
  console.log(`FAILED after ${passed} steps: ${error.message ?? error}`);
  if (complaints.length > 0)
    console.log(`the page complained: ${complaints.join("; ")}`);
  await shot("failed").catch(() => {});
  process.exitCode = 1;
} finally {
  await browser.close();
  await server.stop();
  rmSync(scratch, { recursive: true, force: true });
}

/** Another tab comes to the front. Playwright pretends that every page has the focus, so that is switched off first. */
async function loseFocus() {
  const devtools = await context.newCDPSession(page);
  await devtools.send("Emulation.setFocusEmulationEnabled", { enabled: false });
  const other = await context.newPage();
  await other.bringToFront();
  await assertSoon(
    () => page.evaluate(() => !document.hasFocus()),
    "the page loses its focus",
  );
  await other.close();
  await page.bringToFront();
  await devtools.send("Emulation.setFocusEmulationEnabled", { enabled: true });
}
