// A plant elsewhere in a real browser; `tools/external-test` says how to call it. One line a step; it ends with 1 at the
// first that fails. PAGE names another address for the page than the server's own.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "../web/node_modules/playwright-core/index.mjs";
import { Server } from "../web/test/browser/server.mjs";

const [folder] = process.argv.slice(2);
if (folder === undefined) {
  console.error("usage: tools/external-test FOLDER");
  process.exit(2);
}
mkdirSync(folder, { recursive: true });
const scratch = mkdtempSync(join(tmpdir(), "cohelm-external-"));

/** Starts the example and waits for its address. */
async function startPlant() {
  const child = spawn(
    "python3",
    ["examples/external-plant/plant.py", "--listen", "0"],
    { stdio: ["ignore", "pipe", "inherit"] },
  );
  const address = await new Promise((resolve, reject) => {
    let said = "";
    child.stdout.on("data", (bytes) => {
      said += bytes;
      const found = /listens at (\S+)\n/.exec(said);
      if (found !== null) resolve(found[1]);
    });
    child.on("error", () =>
      reject(new Error("this test flies a plant in Python: it needs python3")),
    );
    child.on("exit", (code) =>
      reject(new Error(`the plant ended with ${code}`)),
    );
  });
  return { child, address };
}

const plant = await startPlant();
const server = await Server.start(
  process.env.COHELM ?? "target/release/cohelm",
  join(scratch, "flights.db"),
  // The example's own dead man has this time as well: a busy machine needs more than the usual 250 ms.
  ["--external", plant.address, "--external-time-out", "2000"],
);
const executablePath = [
  process.env.CHROMIUM,
  "/usr/bin/chromium",
  "/usr/bin/chromium-browser",
  "/usr/bin/google-chrome",
].find((path) => path && existsSync(path));
const browser = await chromium.launch({
  executablePath,
  args: ["--headless", "--no-sandbox", "--disable-gpu"],
});
const page = await browser.newPage({ viewport: { width: 1366, height: 768 } });
page.setDefaultTimeout(20_000);
const complaints = [];
page.on("pageerror", (error) => complaints.push(error.message));

const shot = (name) =>
  page.screenshot({ path: join(folder, `external-${name}.png`) });
const card = (kind) => page.locator(`.card[data-kind="${kind}"]:not([hidden])`);
let passed = 0;
async function step(name, work) {
  await work();
  passed += 1;
  console.log(`ok   ${name}`);
}

/** How far the cart is from the person's goal, pixels to the right, by what is drawn. */
function offset() {
  return page.evaluate(() => {
    const middle = (name, within) => {
      const node = document.querySelector(`canvas.${name}`);
      const { width, height } = node;
      const { data } = node.getContext("2d").getImageData(0, 0, width, height);
      let [sum, count] = [0, 0];
      for (let i = 0; i < data.length; i += 4) {
        if (!within(data[i], data[i + 1], data[i + 2], data[i + 3])) continue;
        sum += (i / 4) % width;
        count += 1;
      }
      return count === 0 ? null : sum / count;
    };
    const amber = middle(
      "back",
      (r, g, b, a) => r > 225 && g > 140 && g < 205 && b < 80 && a > 249,
    );
    const craft = middle(
      "front",
      (r, g, b, a) => r > 120 && g > 130 && b > 150 && b >= r && a > 249,
    );
    return amber === null || craft === null ? null : craft - amber;
  });
}

try {
  await step("the page opens on the plant, which is ready", async () => {
    await page.goto(process.env.PAGE ?? server.url);
    await card("ready").waitFor();
    assert.match(await page.locator(".card h2").innerText(), /cart/);
    assert.ok((await offset()) !== null, "the cart and its goal are drawn");
    await shot("1-ready");
  });

  await step("Esc on the ready card leaves the plant ready", async () => {
    await page.keyboard.press("Escape");
    await page.keyboard.press("Enter");
    await page.locator(".card").waitFor({ state: "hidden" });
    await page.waitForFunction(
      () => document.querySelector(".clock").textContent !== "0.0 s",
    );
  });

  await step("who looks away is told that it was let go of", async () => {
    await page.keyboard.down("ArrowRight");
    await page.evaluate(() => {
      document.hasFocus = () => false;
    });
    // The server lets go after 0.3 s, and tells it when somebody is there again.
    await page.waitForTimeout(800);
    assert.equal(await page.locator(".let-go:not([hidden])").count(), 0);
    await page.evaluate(() => {
      delete document.hasFocus;
    });
    await page.locator(".let-go:not([hidden])").waitFor();
    await shot("2-let-go");
    assert.equal(await page.locator(".pressed .held").count(), 0);
    await page.keyboard.up("ArrowRight");
    await page.waitForTimeout(500);
    // Where the machine is busy, what was pressed may be let go of again.
    for (
      let i = 0;
      i < 20 && (await page.locator(".let-go:not([hidden])").count()) > 0;
      i += 1
    ) {
      await page.keyboard.press("ArrowRight", { delay: 100 });
      await page.waitForTimeout(200);
    }
    await page.locator(".let-go").waitFor({ state: "hidden" });
    await page.keyboard.press("Escape");
    await card("abandoned").waitFor();
  });

  await step("a picture that fails ends the flight and says why", async () => {
    await page.keyboard.press("Enter");
    await card("ready").waitFor();
    await page.keyboard.press("Enter");
    await page.locator(".card").waitFor({ state: "hidden" });
    await page.evaluate(() => {
      const pen = CanvasRenderingContext2D.prototype;
      window.whole = pen.clearRect;
      pen.clearRect = () => {
        throw new Error("no paint");
      };
    });
    await card("abandoned").waitFor();
    assert.match(
      await page.locator(".card").innerText(),
      /The picture cannot be drawn: no paint/,
    );
    await page.evaluate(() => {
      CanvasRenderingContext2D.prototype.clearRect = window.whole;
    });
    await page.keyboard.press("Enter");
    await card("ready").waitFor();
  });

  /** Drags the cart to its goal; where the machine is so busy that the drag is let go of, presses again. */
  async function drag(flight) {
    const [x, y] = [683, 300];
    await page.mouse.move(x, y);
    await page.mouse.down();
    let before = await offset();
    let then = performance.now();
    for (
      let i = 0;
      i < 600 && (await page.locator(".card:not([hidden])").count()) === 0;
      i += 1
    ) {
      await page.waitForTimeout(30);
      if ((await page.locator(".let-go:not([hidden])").count()) > 0) {
        await page.mouse.up();
        await page.mouse.move(x, y);
        await page.mouse.down();
      }
      const now = await offset();
      if (now === null || before === null) {
        before = now;
        continue;
      }
      const at = performance.now();
      const speed = ((now - before) / (at - then)) * 1000;
      [before, then] = [now, at];
      const push = Math.min(Math.max(-0.35 * now - 0.35 * speed, -80), 80);
      await page.mouse.move(x + push, y);
      if (flight === 0 && i === 20) await shot("3-drag");
    }
    await page.mouse.up();
  }

  let drags = 0;
  await step("a drag brings the cart to the person's goal", async () => {
    // What a busy machine ends (two seconds without a picture) is flown again.
    for (; drags === 0 || (await card("abandoned").count()) > 0; drags += 1) {
      assert.ok(drags < 3, "three drags were broken off");
      if (drags > 0) {
        await page.keyboard.press("Enter");
        await card("ready").waitFor();
      }
      await page.keyboard.press("Enter");
      await page.locator(".card").waitFor({ state: "hidden" });
      await drag(drags);
      await page.locator(".card:not([hidden])").waitFor();
    }
    await card("goal").waitFor();
    await shot("4-goal");
  });

  await step("its record is shown again from its states", async () => {
    await page.click(".card .secondary");
    await page.locator(".exact[data-identical=true]").waitFor();
    await shot("5-replay");
  });

  await step(
    "a plant that is killed ends the flight, and says why",
    async () => {
      await page.click("[data-tab=external]");
      await card("ready").waitFor();
      await page.keyboard.press("Enter");
      await page.keyboard.down("ArrowRight");
      await page.waitForTimeout(300);
      plant.child.kill("SIGKILL");
      await card("abandoned").waitFor();
      await page.keyboard.up("ArrowRight");
      assert.match(
        await page.locator(".card").innerText(),
        /The plant was lost: it closed the connection/,
      );
      await shot("6-lost");
      await page.keyboard.press("Enter");
      await card("unable").waitFor();
      const episodes = await server.episodes();
      assert.deepEqual(
        episodes.map(({ plant: name, ending }) => [name, ending]),
        [
          ["external", "abandoned"],
          ["external", "goal"],
          ...Array(drags - 1).fill(["external", "abandoned"]),
          ["external", "abandoned"],
          ["external", "abandoned"],
        ],
      );
    },
  );

  await step("nothing was complained of", () =>
    assert.deepEqual(complaints, []),
  );
  console.log(`external-test: ${passed} steps passed`);
} catch (error) {
  console.log(`FAILED after ${passed} steps: ${error.message ?? error}`);
  await shot("failed").catch(() => {});
  process.exitCode = 1;
} finally {
  await browser.close();
  await server.stop();
  plant.child.kill("SIGKILL");
  rmSync(scratch, { recursive: true, force: true });
}
