// A tour made in a real browser by clicks and keys, saved, read again, changed, undone, fought over by two windows, played, and left while it is saved.
// It stands about a house of the simulated survey, and stays in the project. Called by a test of the whole program with the two links that
// `skyquilt view PROJECT --edit` prints:
//   node tour_page.mjs LINK PLAY_LINK PROJECT TRUTH OUT
// Exits with 1 and the list of failures; screenshots are left in OUT.
import { createHash } from "node:crypto";
import { existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import path from "node:path";
import { PNG } from "pngjs";
import { open, report, screenshot, start } from "./browser.mjs";
import { boxGlb } from "./glb_files.mjs";
import { readSurface } from "./surface_mesh.mjs";
import { BOX, placeAbout, truthHouses } from "./things_check.mjs";
import { acrossHouse, checkWay, walk } from "./tour_ways.mjs";

const [link, playLink, project, truth, out] = process.argv.slice(2);
mkdirSync(out, { recursive: true });
const FILE = path.join(project, "tour.json");
const TITLE = '<img src="x" onerror="window.hacked = 1"> Spaziergang 散歩 نزهة';
const SCRIPT = "<script>window.hacked = 1</script> Löwe 塔 برج";
const TEXT = "First line\nsecond <b>line</b>\n最初の停留所\nالمحطة الأولى";
const CLICKED = 3;
const STOPS = 6;
const WAIT_MS = 20_000;

const failures = [];
const figures = {};
const house = truthHouses(truth)[0];
const place = placeAbout(house);
const surface = readSurface((name) => readFileSync(path.join(project, "surface", "tiles", name)));
const across = acrossHouse(surface, place, house.width_m / 2);

function expect(condition, text) {
  if (!condition) failures.push(text);
}

const saved = () => JSON.parse(readFileSync(FILE, "utf8"));
const state = (page) => page.evaluate(() => window.__skyquilt.state());
const stopsOf = async (page) => (await state(page)).documents.tour.stops;

async function waitSaved(page) {
  // The saving begins a second after the change.
  await page.waitForFunction(() => window.__skyquilt.state().save === "saved", null, { timeout: WAIT_MS });
}

const field = (page, label) => page.locator(".panel").getByLabel(label, { exact: true }).first();
const button = (page, name) => page.locator(".panel").getByRole("button", { name, exact: true });

/** By the words before it: a label's text has units and options too. */
const control = (form, words, kind) =>
  form.locator("label", { has: form.page().getByText(words, { exact: true }) }).locator(kind);

async function type(page, label, text) {
  await field(page, label).fill(text);
  await page.keyboard.press("Enter");
}

/** Turns the view and goes nearer, as a person does. */
async function moveView(page, dx, dy) {
  const canvas = page.locator("canvas").first();
  const { x, y, width, height } = await canvas.boundingBox();
  const [cx, cy] = [x + width / 2 - 150, y + height / 2];
  await page.mouse.move(cx, cy);
  await page.mouse.down({ button: "right" });
  await page.mouse.move(cx + dx, cy + dy, { steps: 4 });
  await page.mouse.up({ button: "right" });
  await page.mouse.wheel(0, -300);
  // The view glides to rest.
  await page.evaluate(() => window.__skyquilt.idle());
}

function picture(file) {
  const png = new PNG({ width: 60, height: 40 });
  for (let i = 0; i < png.data.length; i += 4) png.data.set([200, i % 251, 80, 255], i);
  const bytes = PNG.sync.write(png);
  writeFileSync(file, bytes);
  return bytes;
}

async function make(page) {
  await page.keyboard.press("u");
  await page.locator(".panel").waitFor();
  await type(page, "Title", TITLE);
  await button(page, "Add a stop here").click();
  // The view goes on from here; the first stop stays where it was.
  await page.locator("canvas").first().focus();
  await moveView(page, 160, 30);
  await page.locator("canvas").first().focus();
  await page.keyboard.press("Shift+K");
  await moveView(page, -320, -20);
  await page.locator("canvas").first().focus();
  await page.keyboard.press("Shift+K");
  const stops = await stopsOf(page);
  expect(stops.length === CLICKED, `${stops.length} stops instead of ${CLICKED}`);
  const apart = Math.hypot(...stops[0].pose.eyeEnu.map((value, i) => value - stops[1].pose.eyeEnu[i]));
  expect(apart > 1, `the stops are ${apart} m apart`);

  // The first one: title, text, picture, link, way, branch.
  await page.locator(".tour-stops .point-row").first().click();
  const form = page.locator(".tour-stops .point-form");
  await form.getByLabel("Title", { exact: true }).fill(SCRIPT);
  await page.keyboard.press("Enter");
  await form.getByLabel("Text", { exact: true }).fill(TEXT);
  await form.getByLabel("Link", { exact: true }).fill("javascript:alert(1)");
  await page.keyboard.press("Enter");
  expect((await stopsOf(page))[0].link === null, "a link that runs is taken");
  await form.getByLabel("Link", { exact: true }).fill("https://example.org/oak");
  await page.keyboard.press("Enter");
  const bytes = picture(path.join(out, "oak.png"));
  await form.locator('input[type="file"]').setInputFiles(path.join(out, "oak.png"));
  await page.waitForFunction(() => window.__skyquilt.state().documents.tour.stops[0].picture !== null);
  await control(form, "Way", "select").first().selectOption("over");
  await control(form, "Pause", "input").fill("1.5");
  await page.keyboard.press("Enter");
  await form.getByRole("button", { name: "Add a branch" }).click();
  await control(form, "Leads to", "select").selectOption({ index: 1 });
  await screenshot(page, out, "form");

  // A label by a click, its text typed at once.
  await button(page, "Label").click();
  await page
    .locator("canvas")
    .first()
    .click({ position: { x: 420, y: 420 } });
  await page.waitForFunction(() => window.__skyquilt.state().documents.tour.things.length === 1);
  await page.keyboard.type("Old oak");
  await page.keyboard.press("Enter");
  await waitSaved(page);
  const file = saved();
  const [first] = file.stops;
  expect(file.title === TITLE, `title ${file.title}`);
  expect(first.title === SCRIPT && first.text === TEXT, `first stop ${JSON.stringify(first)}`);
  expect(first.link?.url === "https://example.org/oak", `link ${JSON.stringify(first.link)}`);
  expect(first.next.path.kind === "over" && first.pause_s === 1.5, `way ${JSON.stringify(first.next)}`);
  expect(first.branches.length === 1 && first.branches[0].to === file.stops[2].id, JSON.stringify(first.branches));
  expect(file.things.length === 1 && file.things[0].text === "Old oak", JSON.stringify(file.things));
  const asset = `${createHash("sha256").update(bytes).digest("hex")}.png`;
  expect(first.picture === asset && file.assets[asset]?.name === "oak.png", `picture ${first.picture}`);
  expect(existsSync(path.join(project, "tour", "assets", asset)), "the picture is not in tour/assets");
}

/** Stops before and behind a house, and one that sees the box behind it; the second stop becomes brighter. */
async function makeMore(page) {
  expect(across !== null, "there is no way through the house");
  const canvas = page.locator("canvas").first();
  const lookAt = (eye, target) => page.evaluate(([e, t]) => window.__skyquilt.lookAt(e, t, 45), [eye, target]);
  const middle = place(0, 0.5 * house.ridge_height_m);
  for (const eye of [...(across ?? []), place(38, 24)]) {
    await lookAt(eye, middle);
    await canvas.focus();
    await page.keyboard.press("Shift+K");
  }
  expect((await stopsOf(page)).length === STOPS, `${(await stopsOf(page)).length} stops instead of ${STOPS}`);
  await page.locator(".tour-stops .point-row").nth(1).click();
  const form = page.locator(".tour-stops .point-form");
  await form.getByText("Look of the view", { exact: true }).click();
  await form.getByLabel("Own brightness", { exact: true }).check();
  await control(form, "Brighter", "input").fill("1");
  await page.keyboard.press("Enter");
  await waitSaved(page);
  expect(saved().stops[1].exposure_stops === 1, `brightness ${saved().stops[1].exposure_stops}`);
}

/** Files that are not what their names say are refused; the box is placed where the middle of the view is. */
async function placeBox(page) {
  const things = page.locator(".panel section", { has: page.getByRole("heading", { name: "In the scene" }) });
  const upload = async (name, bytes) => {
    writeFileSync(path.join(out, name), bytes);
    await things.locator('input[type="file"]').setInputFiles(path.join(out, name));
  };
  const refused = async (name, bytes, why) => {
    await upload(name, bytes);
    await page.locator(".notices").getByText(why).first().waitFor({ timeout: WAIT_MS });
    expect((await state(page)).tour.upload === null, `${name} is still being uploaded`);
  };
  const before = readFileSync(FILE, "utf8");
  const program = Buffer.from("MZ\x90 This program cannot be run in DOS mode");
  await refused("setup.glb", program, /setup\.glb was not uploaded.*not a model/);
  // Begins as a model does: here the server looks.
  const html = Buffer.from("glTF<html><script>window.hacked = 1</script>");
  await refused("shed.glb", html, /shed\.glb was not uploaded.*not saved/);
  expect(readFileSync(FILE, "utf8") === before, "a refused file changed the tour");

  const at = place(-(house.width_m / 2 + 6), 0);
  await page.evaluate(([e, t]) => window.__skyquilt.lookAt(e, t, 45), [[at[0] - 4, at[1] - 4, at[2] + 60], at]);
  await page.evaluate(() => window.__skyquilt.idle());
  await upload("box.glb", boxGlb(BOX.size, [1, 0, 1]));
  await page.waitForFunction(() => window.__skyquilt.state().tour.placing?.kind === "model");
  await page.locator("canvas").first().focus();
  await page.keyboard.press(".");
  await page.waitForFunction(() => window.__skyquilt.state().documents.tour.things.length === 2);
  const form = page.locator(".tour-things .point-form");
  await control(form, "Turned", "input").fill(String(BOX.yawDeg));
  await page.keyboard.press("Enter");
  await control(form, "Scale", "input").fill(String(BOX.scale));
  await page.keyboard.press("Enter");
  // At the last stop alone.
  await form.getByLabel("Shown at all stops", { exact: true }).uncheck();
  for (let i = 0; i < STOPS - 1; i += 1) await form.locator('fieldset input[type="checkbox"]').nth(i).uncheck();
  await screenshot(page, out, "box");
  await waitSaved(page);
  const { things: placed, stops } = saved();
  const box = placed[1];
  expect(box.stops?.join() === stops[STOPS - 1].id, `the box is shown at ${box.stops}`);
  expect(box.name === "box" && box.yaw_deg === BOX.yawDeg && box.scale === BOX.scale, JSON.stringify(box));
  const off = Math.hypot(box.at[0] - at[0], box.at[1] - at[1]);
  expect(off < 1, `the box stands ${off} m from where it was placed`);
}

async function reloadAndChange(page) {
  const before = readFileSync(FILE, "utf8");
  await page.reload();
  await page.waitForFunction(() => window.__skyquilt?.ready() === true, null, { timeout: 60_000 });
  expect((await stopsOf(page)).length === STOPS, "the stops are not there after a reload");
  await page.keyboard.press("u");
  await page.locator(".tour-stops .point-row").nth(1).click();
  await page.locator(".tour-stops .point-form").getByLabel("Title", { exact: true }).fill("The square");
  await page.keyboard.press("Enter");
  await waitSaved(page);
  expect(saved().stops[1].title === "The square", "the new title is not saved");
  await button(page, "Later").click();
  expect((await stopsOf(page))[2].title === "The square", "the stop is not later");
  await page.locator("canvas").first().focus();
  await page.keyboard.press("Control+z");
  await page.keyboard.press("Control+z");
  await page.waitForFunction(() => window.__skyquilt.state().documents.tour.stops[1].title === "Stop 2");
  await waitSaved(page);
  expect(readFileSync(FILE, "utf8") === before, "undo does not bring the file back");
}

async function twoWindows(page, context, problems) {
  const other = await context.newPage();
  other.on("pageerror", (error) => problems.push(`second window: ${error.message}`));
  await other.goto(new URL("/", link).href);
  await other.waitForFunction(() => window.__skyquilt?.ready() === true, null, { timeout: 60_000 });
  await other.keyboard.press("u");
  await type(other, "Title", "Theirs");
  await waitSaved(other);
  await type(page, "Title", "Mine");
  const card = page.locator(".notices").getByText("Another window has saved the tour");
  await card.waitFor({ timeout: WAIT_MS });
  await page.waitForTimeout(1500);
  expect(saved().title === "Theirs", "the other window's tour was overwritten");
  expect((await state(page)).documents.tour.title === "Mine", "the unsaved change is lost");
  await screenshot(page, out, "conflict");
  await page.locator(".notices").getByRole("button", { name: "Take the other version" }).click();
  await page.waitForFunction(() => window.__skyquilt.state().documents.tour.title === "Theirs");
  await waitSaved(page);
  await type(page, "Title", "Mine again");
  await waitSaved(page);
  await type(other, "Title", "Theirs again");
  await other.locator(".notices").getByRole("button", { name: "Keep mine" }).click({ timeout: WAIT_MS });
  await waitSaved(other);
  expect(saved().title === "Theirs again", "the version that was kept is not saved");
  await other.close();
  // As it was, so that what follows is saved without a question.
  await type(page, "Title", TITLE);
  await page.locator(".notices").getByRole("button", { name: "Keep mine" }).click({ timeout: WAIT_MS });
  await waitSaved(page);
}

const stopShown = (page, index) =>
  page.waitForFunction(
    (wanted) => {
      const { play } = window.__skyquilt.state();
      return play?.progress.index === wanted && play.phase === "stop";
    },
    index,
    { timeout: 60_000 },
  );

async function samePose(page, index) {
  const pose = await page.evaluate(() => window.__skyquilt.pose());
  const wanted = (await stopsOf(page))[index].pose;
  const off = Math.hypot(...pose.eyeEnu.map((value, i) => value - wanted.eyeEnu[i]));
  expect(off < 1e-6, `at stop ${index + 1} the camera is ${off} m away`);
}

async function play(page) {
  const before = readFileSync(FILE, "utf8");
  const count = (await stopsOf(page)).length;
  await page.locator(".panel").getByRole("button", { name: "Play", exact: true }).click();
  await stopShown(page, 0);
  await samePose(page, 0);
  expect((await page.locator(".player-card h2").textContent()) === SCRIPT, "the title is not shown as it is");
  expect((await page.evaluate(() => window.hacked)) === undefined, "a script in a title was run");
  expect((await page.locator(".player-card b, .player-card script").count()) === 0, "text became elements");
  const web = page.locator(".player-card a");
  const attributes = [await web.getAttribute("rel"), await web.getAttribute("target")];
  expect(attributes.join(" ") === "noopener noreferrer _blank", `the link opens with ${attributes}`);
  const size = await page.locator(".player-picture").evaluate((image) => image.naturalWidth);
  expect(size === 60, `the picture is ${size} pixels wide`);
  await page.evaluate(() => window.__skyquilt.idle());
  await screenshot(page, out, "play");
  // Next by the button, previous by key.
  await page.waitForFunction(() => window.__skyquilt.state().map !== null);
  await page.locator(".player-bar").getByRole("button", { name: "Next stop" }).click();
  await stopShown(page, 1);
  await samePose(page, 1);
  const spoken = await page.locator(".player [aria-live=polite]").first().textContent();
  expect(spoken === `Stop 2 of ${count}: Stop 2`, `it is read out: ${spoken}`);
  await page.keyboard.press("ArrowLeft");
  await stopShown(page, 0);
  // The branch leads to the third.
  await page.locator(".player-card .buttons button").first().click();
  await stopShown(page, 2);
  await page.keyboard.press("ArrowLeft");
  await stopShown(page, 0);
  // By itself, after 1.5 s.
  await page.locator("canvas").first().focus();
  await page.keyboard.press("Space");
  await stopShown(page, 1);
  await page.keyboard.press("Space");
  // Straight on there is a house.
  await goTo(page, CLICKED);
  const keyed = () => page.keyboard.press("ArrowRight");
  figures.ways_m = [checkWay(surface, await walk(page, keyed, CLICKED + 1), "over the house", expect)];
  await page.evaluate(() => window.__skyquilt.idle());
  await screenshot(page, out, "play_behind");
  // By itself to the last one, which is the end.
  await page.keyboard.press("Space");
  await stopShown(page, STOPS - 1);
  await page.waitForFunction(() => window.__skyquilt.state().play.playing === false);
  await goTo(page, 0);
  await page.setViewportSize({ width: 400, height: 700 });
  await page.evaluate(() => window.__skyquilt.idle());
  await screenshot(page, out, "play_small");
  await page.setViewportSize({ width: 1024, height: 640 });
  await page.keyboard.press("Escape");
  await page.locator(".toolbar").waitFor();
  expect((await state(page)).play === null, "Escape does not leave the tour");
  expect(readFileSync(FILE, "utf8") === before, "playing has changed the tour");
}

async function goTo(page, index) {
  await page.locator(".player-bar").getByRole("button", { name: "All stops" }).click();
  await page.locator(".player-list .point-row").nth(index).click();
  await stopShown(page, index);
}

async function until(condition, text) {
  const end = Date.now() + WAIT_MS;
  while (!condition() && Date.now() < end) await new Promise((done) => setTimeout(done, 50));
  expect(condition(), text);
}

/** The page is left while a save is under way, and with a change that was not sent yet. */
async function leave(page) {
  if ((await state(page)).panel !== "tour") await page.keyboard.press("u");
  // The answer to a save does not come.
  await page.evaluate(() => {
    const send = window.fetch;
    window.fetch = async (url, options) => {
      const answer = await send(url, options);
      if (options?.method === "PUT" && options.keepalive !== true) await new Promise(() => {});
      return answer;
    };
  });
  await type(page, "Title", "Half of it");
  await until(() => saved().title === "Half of it", "the first change is not saved");
  await type(page, "Title", TITLE);
  expect(saved().title === "Half of it" && (await state(page)).save !== "saved", "nothing is left to be saved");
  const asked = [];
  page.once("dialog", (dialog) => {
    asked.push(dialog.type());
    void dialog.accept();
  });
  await page.goto("about:blank");
  expect(asked.join() === "beforeunload", `before leaving it was asked: ${asked}`);
  await until(() => saved().title === TITLE, `the last change is lost: ${saved().title}`);
}

/** The other link: it opens with the tour, and nothing is ever sent to be saved. */
async function visit(browser) {
  const { page, problems } = await open(browser, playLink, { width: 1024, height: 640 });
  page.on("request", (request) => {
    if (request.method() !== "GET") problems.push(`a visitor's page sends ${request.method()} ${request.url()}`);
  });
  await stopShown(page, 0);
  await page.keyboard.press("ArrowRight");
  await stopShown(page, 1);
  await page.keyboard.press("Escape");
  await page.keyboard.press("u");
  expect(
    (await page.locator(".panel").getByRole("button", { name: "Add a stop here" }).count()) === 0,
    "visitors edit",
  );
  await page.waitForTimeout(1500);
  failures.push(...problems);
}

const browser = await start();
try {
  const { context, page, problems } = await open(browser, link, { width: 1024, height: 640 });
  await make(page);
  await makeMore(page);
  await placeBox(page);
  await reloadAndChange(page);
  await twoWindows(page, context, problems);
  await play(page);
  await leave(page);
  // Chromium names every refused save and upload on the console: these were asked for.
  failures.push(...problems.filter((text) => !/\b41[25]\b/.test(text)));
  await visit(browser);
} catch (error) {
  failures.push(`${error.stack}`);
} finally {
  await browser.close();
}
report(failures, figures);
