// The browser test of a whole study; `tools/study-test` says how to call it. One line a step; it ends with 1 at the first
// that fails.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import {
  existsSync,
  mkdirSync,
  mkdtempSync,
  rmSync,
  writeFileSync,
} from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "../web/node_modules/playwright-core/index.mjs";
import { Line } from "../web/test/browser/cut.mjs";
import { Participant } from "../web/test/browser/participant.mjs";
import { Server } from "../web/test/browser/server.mjs";

const [folder, study = "web/test/browser/short.toml"] = process.argv.slice(2);
if (folder === undefined) {
  console.error("usage: tools/study-test FOLDER [STUDY]");
  process.exit(2);
}
mkdirSync(folder, { recursive: true });
const scratch = mkdtempSync(join(tmpdir(), "cohelm-study-"));
const [database, secretFile] = [
  join(scratch, "study.db"),
  join(scratch, "secret"),
];
const SECRET = "a secret of this test alone";
writeFileSync(secretFile, `${SECRET}\n`);
const program = process.env.COHELM ?? "target/release/cohelm";
const server = await Server.study(program, study, [
  "--database",
  database,
  "--secret-file",
  secretFile,
]);
const line = await Line.to(server.url);

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
const complaints = [];
let expectsTrouble = false;
/** Until the researcher logs in, and after the server was killed, the desk is told that it is not known. */
let deskIsOut = true;

async function opened(viewport) {
  const context = await browser.newContext({ viewport, colorScheme: "light" });
  const page = await context.newPage();
  page.setDefaultTimeout(30_000);
  page.on("pageerror", (error) => complaints.push(error.stack));
  page.on("console", (message) => {
    const isOut = deskIsOut && /401|Authentication/.test(message.text());
    if (message.type() === "error" && !expectsTrouble && !isOut)
      complaints.push(message.text());
  });
  return page;
}

let passed = 0;
async function step(name, work) {
  const since = performance.now();
  await work();
  passed += 1;
  console.log(
    `ok   ${name} (${((performance.now() - since) / 1000).toFixed(1)} s)`,
  );
}

/** Something that breaks lines on purpose, about which the browser may complain. */
async function troubled(work) {
  expectsTrouble = true;
  await work();
  await new Promise((resolve) => setTimeout(resolve, 300));
  expectsTrouble = false;
}

let shots = 0;
const shot = (page, name) => {
  shots += 1;
  return page.screenshot({
    path: join(folder, `${String(shots).padStart(2, "0")}-${name}.png`),
  });
};

const desk = await opened({ width: 1440, height: 860 });
const page = await opened({ width: 1280, height: 800 });
const text = (selector) => desk.locator(selector).first().innerText();
let watched = false;
let link = "";
let code = "";

async function researcherMakesALink() {
  await desk.goto(`${server.url}/desk`);
  await desk.waitForSelector("input[name=secret]");
  await shot(desk, "desk-login");
  await troubled(async () => {
    await desk.fill("input[name=secret]", "not the secret");
    await desk.click("button[type=submit]");
    await desk.waitForSelector("text=not the secret");
  });
  await desk.fill("input[name=secret]", SECRET);
  await desk.click("button[type=submit]");
  await desk.waitForSelector(".tally b");
  deskIsOut = false;
  await desk.goto(`${server.url}/desk#/people`);
  await desk.click("text=New participant…");
  await desk.click("text=Make the link");
  link = await desk.inputValue("dialog .link-row input >> nth=0");
  code = await text("dialog b");
  await shot(desk, "desk-link");
  assert.match(link, /\/p\/[\w-]{20,}$/);
  await desk.click("dialog >> text=Done");
}

/** Keeps the craft in the air with the main engine, for half a second and then until the work is done. */
async function aloft(work) {
  let isDone = false;
  const doing = page
    .waitForTimeout(500)
    .then(work)
    .then(
      () => null,
      (error) => error,
    );
  doing.then(() => (isDone = true));
  while (!isDone) {
    await page.keyboard.press("ArrowUp", { delay: 90 });
    await page.waitForTimeout(60);
  }
  const error = await doing;
  if (error !== null) throw error;
}

/** What befalls the participant in the air: something in each flight. */
const troubles = {
  1: async () => {
    // Nobody at the keys would be down in two seconds, and the page would come back to the next flight.
    await aloft(() => page.reload());
    await page.waitForSelector(".card[data-kind=interrupted]");
    await shot(page, "interrupted");
  },
  2: () => aloft(watch),
  3: () =>
    troubled(() =>
      aloft(async () => {
        await watch();
        line.cut();
        await page.waitForTimeout(1_500);
        await shot(page, "connection-cut");
        line.mend();
      }),
    ),
  4: () =>
    troubled(() =>
      aloft(async () => {
        deskIsOut = true;
        await server.kill();
        await server.startAgain();
      }),
    ),
};

/** Looks at the flight in the air, if it lasts long enough to be found. */
async function watch() {
  if (watched) return;
  await desk.goto(`${server.url}/desk#/`);
  const link = desk.locator("a.watch");
  watched = await link.click({ timeout: 5_000 }).then(
    () => true,
    () => false,
  );
  if (!watched) return;
  await desk.waitForSelector(".live");
  await desk.waitForTimeout(1_000);
  await shot(desk, "desk-live");
}

async function participantGoesThrough() {
  await page.goto(link.replace(server.url, line.url));
  const had = new Set();
  const participant = new Participant(page, {
    see: async (name) => {
      if (had.has(name)) return;
      had.add(name);
      await shot(page, name);
    },
    inTheAir: async (number) => troubles[number]?.(),
  });
  await participant.walkTo("thanks");
  for (const screen of ["consent", "device", "form", "instructions", "quiz"])
    assert.ok(participant.seen.includes(screen), `${screen} was not seen`);
  assert.ok(participant.seen.includes("flight-interrupted"));
  assert.ok(watched, "no flight was seen live");
}

async function nothingIsAskedTwice() {
  await page.reload();
  await page.waitForSelector("[data-screen]:not([data-screen=opening])");
  assert.equal(await new Participant(page).asked(), "thanks");
}

async function researcherLooksAtIt() {
  await desk.goto(`${server.url}/desk#/people`);
  await desk.reload();
  await troubled(async () => {
    // Sessions of the desk end with the server, which was killed.
    await desk.waitForSelector("input[name=secret]");
    await desk.fill("input[name=secret]", SECRET);
    await desk.click("button[type=submit]");
    await desk.waitForSelector(`text=${code}`);
  });
  deskIsOut = false;
  await shot(desk, "desk-participants");
  await desk.goto(`${server.url}/desk#/`);
  await desk.waitForSelector(".tally b");
  await desk.waitForTimeout(500);
  await shot(desk, "desk-overview");
  await desk.goto(`${server.url}/desk#/people`);
  await desk.click(`a:has-text("${code}")`);
  await desk.waitForTimeout(800);
  await shot(desk, "desk-participant");
}

async function researcherAsksWhatIf() {
  await desk.goto(`${server.url}/desk#/episodes`);
  await desk.waitForSelector("tr.opens");
  await shot(desk, "desk-flights");
  await desk.goto(`${server.url}/desk#/episodes/1`);
  await desk.waitForSelector(".player");
  await desk.waitForSelector("text=bit for bit");
  await desk.waitForTimeout(800);
  await desk.keyboard.press("Space");
  await shot(desk, "desk-replay");
  await desk.click("text=What if, from here");
  await desk.waitForSelector(".verdict-line:not([hidden])");
  await desk.waitForTimeout(2_000);
  await shot(desk, "desk-what-if");
}

async function researcherDeletes() {
  await desk.goto(`${server.url}/desk#/people`);
  await desk.waitForSelector(".menu summary");
  await desk.click(".menu summary >> nth=0");
  await desk.click("text=Withdraw…");
  await shot(desk, "desk-withdraw");
  await desk.fill("dialog input", code);
  await desk.click("dialog button[type=submit]");
  await desk.waitForSelector("td >> text=withdrawn");
  const episodes = await desk.evaluate(async () =>
    (await fetch("/api/desk/episodes")).json(),
  );
  assert.deepEqual(episodes.episodes ?? episodes, []);
}

const said = (...words) => execFileSync(program, words, { encoding: "utf8" });

try {
  await step("the researcher logs in and makes a link", researcherMakesALink);
  await step(
    "a participant goes from the link to the thanks, past a reload, a cut connection and a killed server in mid-flight",
    participantGoesThrough,
  );
  await step("a finished study asks nothing again", nothingIsAskedTwice);
  await step("the researcher sees who did what", researcherLooksAtIt);
  await step(
    "a flight is replayed, and flown under another rule",
    researcherAsksWhatIf,
  );
  await step(
    "every flight verifies bit for bit, and the study exports",
    async () => {
      const verified = JSON.parse(
        said("verify", "episodes", "--database", database, "--json"),
      );
      assert.ok(verified.finished > 0);
      assert.equal(verified.identical, verified.finished);
      assert.equal(verified.in_the_air + verified.refused, 0);
      said("study", "export", database, "--out", join(folder, "export"));
      rmSync(join(folder, "study.db"), { force: true });
      said("study", "backup", database, join(folder, "study.db"));
    },
  );
  await step("whoever withdraws is deleted", researcherDeletes);
  assert.deepEqual(complaints, [], "the pages complained");
  console.log(`${passed} steps, screenshots in ${folder}`);
} catch (error) {
  console.error(error);
  await shot(page, "FAILED-participant").catch(() => {});
  await shot(desk, "FAILED-desk").catch(() => {});
  process.exitCode = 1;
} finally {
  await browser.close();
  line.close();
  await server.stop();
  rmSync(scratch, { recursive: true, force: true });
}
