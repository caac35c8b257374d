// Every plant, flown in the browser; `tools/plants-test` says how to call it. One line a step; it ends with 1 at the first
// that fails. Whoever flies here sees what a person sees: the picture's pixels and the readings over it.
import assert from "node:assert/strict";
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { Tester } from "../web/test/browser/chromium.mjs";
import { Participant } from "../web/test/browser/participant.mjs";
import { Server } from "../web/test/browser/server.mjs";
import * as canvas from "../web/test/browser/canvas.mjs";
import { readEvents } from "../web/test/browser/records.mjs";

const [folder] = process.argv.slice(2);
if (folder === undefined) {
  console.error("usage: tools/plants-test FOLDER");
  process.exit(2);
}
mkdirSync(folder, { recursive: true });
const scratch = mkdtempSync(join(tmpdir(), "cohelm-plants-"));
const program = process.env.COHELM ?? "target/release/cohelm";
const server = await Server.start(program, join(scratch, "flights.db"), []);
const tester = await Tester.start(folder);
const page = await tester.page({ width: 1280, height: 720 });

const card = (kind) => page.locator(`.card[data-kind="${kind}"]:not([hidden])`);
const anyEnding = page.locator(
  ".card:not([hidden]):is([data-kind=goal], [data-kind=elsewhere], [data-kind=crash], [data-kind=out-of-bounds], [data-kind=time-limit])",
);

/** Opens the page with a task, as `cohelm fly --task` names it in the address, in the first of these modes that there is. */
async function open(query, modes) {
  await page.goto(`${server.url}/?${query}`);
  await page.locator(".stage .card:not([hidden])").waitFor();
  for (const mode of modes) {
    const choice = page.locator(`[data-mode="${mode}"]`);
    if ((await choice.getAttribute("aria-disabled")) === "true") continue;
    await choice.click();
    await card("ready").waitFor();
    // The world is drawn with the next frame.
    await page.waitForTimeout(200);
    return mode;
  }
  assert.fail(`none of ${modes.join(", ")} can be flown with ${query}`);
}

/** What is read over the picture: speed to the right and upwards, units a second, and tilt to the left, rad. */
const readings = () =>
  page.evaluate(() => {
    const spans = [
      ...document.querySelectorAll(".hud .readings > span:not([hidden])"),
    ];
    const of = (sign) =>
      spans.map((span) => span.textContent).find((text) => text.includes(sign));
    const speed = (less, more) => {
      const size = (text) => Number.parseFloat(text.slice(1));
      const [down, up] = [of(less), of(more)];
      return down !== undefined ? -size(down) : up !== undefined ? size(up) : 0;
    };
    const turned = /rotate\((-?[\d.e-]+)deg\)/.exec(
      document.querySelector(".hud .dial i").style.transform,
    );
    return {
      vx: speed("←", "→"),
      vy: speed("↓", "↑"),
      tilt: (-Number(turned?.[1] ?? 0) * Math.PI) / 180,
    };
  });

/** Hands at the keys: each of the two directions is asked for by a key, or by none. */
class Keys {
  held = new Set();

  async ask([x, y]) {
    const wanted = new Set();
    if (Math.abs(x) > 0.38) wanted.add(x > 0 ? "ArrowRight" : "ArrowLeft");
    if (Math.abs(y) > 0.38) wanted.add(y > 0 ? "ArrowUp" : "ArrowDown");
    for (const key of this.held)
      if (!wanted.has(key)) await page.keyboard.up(key);
    for (const key of wanted)
      if (!this.held.has(key)) await page.keyboard.down(key);
    this.held = wanted;
  }
}

/** A hand at the mouse: the picture is pressed once, and dragged from there. */
class Stick {
  middle = { x: 640, y: 420 };
  /** Pixels of a full deflection. */
  reach = 80;
  isHeld = false;

  async ask([x, y]) {
    if (Math.hypot(x, y) < 0.05 && !this.isHeld) return;
    if (!this.isHeld) {
      await page.mouse.move(this.middle.x, this.middle.y);
      await page.mouse.down();
      this.isHeld = true;
    }
    await page.mouse.move(
      this.middle.x + this.reach * x,
      this.middle.y - this.reach * y,
    );
  }

  async letGo() {
    if (this.isHeld) await page.mouse.up();
    this.isHeld = false;
  }
}

/** Where one's own goal is: a cup, or what is amber of a pad. */
const cup = () => canvas.disc(page, "back", canvas.AMBER, 14);
const pad = () => canvas.middle(page, "back", canvas.AMBER);

const within = (value, most) => Math.min(Math.max(value, -most), most);

/** Pixels between the middles of hand and cup when the circles touch, at this size of the window: there the hand is to rest. */
const TOUCHING = 49;

/** What is asked of the arm: straight to the cup, and slower before it; with keys that is by taps. */
function reach(taps) {
  let looks = 0;
  return async (goal) => {
    looks += 1;
    const hand = await canvas.disc(page, "front", canvas.PAINT, 21);
    const [x, y] = [goal.x - hand.x, hand.y - goal.y];
    const far = Math.hypot(x, y);
    // What was asked goes on for a while: the joints lag behind.
    const near = far < TOUCHING + 20;
    if (
      hand.pixels === 0 ||
      far < TOUCHING - 3 ||
      (near && taps && looks % 4 !== 0)
    )
      return [0, 0];
    const pace = taps || !near ? 1 : 0.25;
    return [(pace * x) / far, (pace * y) / far];
  };
}

/** What is asked of what flies: lean against distance and drift, come down slowly over the goal. */
function descend({ lean, sink }) {
  let last = 0;
  return async (goal) => {
    const [craft, { vx, vy, tilt }] = [
      await canvas.craft(page),
      await readings(),
    ];
    const [off, height] = [(craft.x - goal.x) / 50, (goal.y - craft.y) / 50];
    const spin = (tilt - last) / 0.06;
    last = tilt;
    const wanted =
      within(lean[0] * off + lean[1] * vx, 0.3) -
      tilt -
      lean[2] * within(spin, 2);
    const waits = Math.abs(off) > 0.5 + 0.3 * Math.max(height, 0) ? 1.5 : 0;
    const climb = within(0.8 * (waits - height), 2) - sink - vy;
    return [within(-wanted / 0.1, 1), within(climb / 0.3, 1)];
  };
}

const DRONE = { lean: [0.1, 0.16, 0.35], sink: 0.4 };
const LANDER = { lean: [0.06, 0.12, 0.3], sink: 0.2 };

let flown = 0;
/** A flight from its first picture to its ending, and what is stored of it. */
async function flies(
  name,
  { query, modes, marked, hands, asks, kinds, endings },
) {
  await tester.step(name, async () => {
    const mode = await open(query, modes);
    const file = name.replaceAll(/[^a-z]+/g, "-");
    await tester.shot(page, `${file}-1-ready`);
    const goal = await marked();
    await page.keyboard.press("Enter");
    const begun = Date.now();
    let seen = false;
    while ((await anyEnding.count()) === 0 && Date.now() - begun < 60_000) {
      await hands.ask(await asks(goal));
      if (!seen && Date.now() - begun > 800) {
        await tester.shot(page, `${file}-2-under-way`);
        seen = true;
      }
      await page.waitForTimeout(20);
    }
    await hands.letGo?.();
    await hands.ask([0, 0]);
    await anyEnding.waitFor();
    await tester.shot(page, `${file}-3-end`);
    flown += 1;
    const [episode] = await stored(flown);
    console.log(`     ${mode}: ${episode.ending} after ${episode.ticks} ticks`);
    assert.ok(endings.includes(episode.ending), `it ended ${episode.ending}`);
    assert.equal(episode.plant, new URLSearchParams(query).get("task"));
    const log = readEvents(await server.record(episode.id));
    assert.ok(
      log.length > 1 && log.every((event) => kinds.includes(event.kind)),
      JSON.stringify(log.slice(0, 9)),
    );
  });
}

/** All episodes, the newest first, as soon as that many have ended. */
async function stored(count) {
  for (let waited = 0; waited < 100; waited += 1) {
    const episodes = await server.episodes();
    if (
      episodes.filter((episode) => episode.state === "finished").length >= count
    )
      return episodes;
    await page.waitForTimeout(100);
  }
  return assert.fail(`${count} finished episodes`);
}

const SECRET = "a secret of this test alone";

/** Who takes part in a study with the drone reads what the drone's controls are called: nothing of a lander. */
async function readsOfTheDronesKeys() {
  const secretFile = join(scratch, "secret");
  writeFileSync(secretFile, `${SECRET}\n`);
  const study = await Server.study(program, "studies/drone.toml", [
    "--database",
    join(scratch, "study.db"),
    "--secret-file",
    secretFile,
  ]);
  try {
    const participant = await tester.page({ width: 1280, height: 800 });
    await participant.goto(await linkOf(study));
    await new Participant(participant).walkTo("instructions");
    const read = async () =>
      (
        await participant.locator("[data-screen=instructions]").innerText()
      ).replaceAll(/\s+/g, " ");
    await tester.shot(participant, "study-1-task");
    assert.match(await read(), /what you steer your goal, marked ★/);
    await participant.click("[data-screen] .primary");
    await participant.locator(".keys-picture").waitFor();
    await tester.shot(participant, "study-2-keys");
    const named = await participant
      .locator(".bindings .binding b")
      .allInnerTexts();
    assert.deepEqual(named, ["down", "up", "left", "right"]);
    assert.doesNotMatch(await read(), /engine|craft/i);
    await participant.close();
  } finally {
    await study.stop();
  }
}

/** A link of one's own, as the researcher makes it. */
async function linkOf({ url }) {
  const ask = async (path, body, cookie = "") => {
    const headers = {
      "content-type": "application/json",
      "x-cohelm-desk": "1",
      origin: url,
      cookie,
    };
    const answer = await fetch(url + path, {
      method: "POST",
      headers,
      body: JSON.stringify(body),
    });
    assert.ok(
      answer.ok,
      `${path}: ${answer.status} ${await answer.clone().text()}`,
    );
    return answer;
  };
  const login = await ask("/api/desk/login", { secret: SECRET });
  const cookie = login.headers.get("set-cookie").split(";")[0];
  const made = await ask(
    "/api/desk/participants",
    { language: "en", note: "", test: true },
    cookie,
  );
  return (await made.json()).link;
}

const ANY = ["goal", "elsewhere", "crash", "out-of-bounds", "time-limit"];
const byKeys = (asks) => ({
  hands: new Keys(),
  asks,
  kinds: ["down", "up", "release-all"],
});
const byMouse = (asks) => ({
  hands: new Stick(),
  asks,
  kinds: ["stick", "release-all"],
});
const levers = (task) => ({ query: `task=${task}`, modes: ["misc-r"] });
// On axes with help where there are values for them, alone where there are none.
const axes = (task) => ({
  query: `task=${task}&actions=continuous`,
  modes: ["misc-r", "hic"],
});
// An arm is slow enough for a pilot who looks twenty times a second to be held to taking a cup, which the help may take for
// another; what flies is not.
const drone = { marked: pad, endings: ANY };
const lander = drone;
const arm = { marked: cup, endings: ["goal", "elsewhere"] };

const flights = {
  "the drone, by keys": {
    ...drone,
    ...levers("drone"),
    ...byKeys(descend(DRONE)),
  },
  "the drone on axes, by keys": {
    ...drone,
    ...axes("drone"),
    ...byKeys(descend(DRONE)),
  },
  "the drone on axes, by mouse": {
    ...drone,
    ...axes("drone"),
    ...byMouse(descend(DRONE)),
  },
  "the arm, by keys": { ...arm, ...levers("arm"), ...byKeys(reach(true)) },
  "the arm on axes, by keys": {
    ...arm,
    ...axes("arm"),
    ...byKeys(reach(true)),
  },
  "the arm on axes, by mouse": {
    ...arm,
    ...axes("arm"),
    ...byMouse(reach(false)),
  },
  "the lander on axes, by keys": {
    ...lander,
    ...axes("flag-lander"),
    ...byKeys(descend(LANDER)),
  },
  "the lander on axes, by mouse": {
    ...lander,
    ...axes("flag-lander"),
    ...byMouse(descend(LANDER)),
  },
};

try {
  for (const [name, flight] of Object.entries(flights))
    await flies(name, flight);
  await tester.step(
    "a study names the drone's controls as the drone does",
    readsOfTheDronesKeys,
  );
  await tester.step("nothing was complained of", () =>
    assert.deepEqual(tester.complaints, []),
  );
  console.log(
    `plants-test: ${tester.passed} steps passed; screenshots in ${folder}`,
  );
} catch (error) {
  console.log(`FAILED after ${tester.passed} steps: ${error.message ?? error}`);
  if (tester.complaints.length > 0)
    console.log(`the page complained: ${tester.complaints.join("; ")}`);
  await tester.shot(page, "failed").catch(() => {});
  process.exitCode = 1;
} finally {
  await tester.browser.close();
  await server.stop();
  rmSync(scratch, { recursive: true, force: true });
}
