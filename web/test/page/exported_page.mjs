// A tour that was made by clicks and exported by `skyquilt tour`, with the engine stopped: from file:// and from a plain web server, in a real browser.
//   node exported_page.mjs FOLDER PROJECT PROGRAM OUT
// It is that of tour_page.mjs, and a model that is none was put into it by hand. Its pictures must be of 400 x 250 pixels and its script that of tests.
// Exits with 1 and the list of failures; screenshots are left in OUT.
import { mkdirSync, readFileSync } from "node:fs";
import path from "node:path";
import { pathToFileURL } from "node:url";
import { PNG } from "pngjs";
import { canvasPicture, differing, open, report, save, screenshot, start } from "./browser.mjs";
import { renderPoses } from "./render_pose.mjs";
import { serve } from "./static_server.mjs";
import { packedFile, readSurface } from "./surface_mesh.mjs";
import { boxAgainstDepth, expectHalfHidden, pixelsInBox } from "./things_check.mjs";
import { checkWay, walk } from "./tour_ways.mjs";

const [folder, project, program, out] = process.argv.slice(2);
const SIZE = { width: 400, height: 250 };
const failures = [];
const figures = {};
mkdirSync(out, { recursive: true });
const tour = JSON.parse(readFileSync(path.join(project, "tour.json"), "utf8"));
const { stops } = tour;
const LAST = stops.length - 1;

function expect(condition, text) {
  if (!condition) failures.push(text);
}

/** What `skyquilt render` makes of the stops, those of one brightness together. */
function renderStops() {
  const rendered = new Map();
  for (const brightness of new Set(stops.map(({ exposure_stops }) => exposure_stops))) {
    const views = stops
      .filter(({ exposure_stops }) => exposure_stops === brightness)
      .map(({ id, pose }) => ({
        name: id,
        pose: { eyeEnu: pose.eye_enu, rotation: pose.rotation, fovyDeg: pose.fovy_deg },
      }));
    const context = { program, project, out, ...SIZE };
    const made = renderPoses(context, views, `rendered_${brightness}`, String(brightness ?? "normal"));
    for (const [id, files] of made) rendered.set(id, files);
  }
  return rendered;
}

async function arrived(page, index) {
  await page.waitForFunction(
    (id) => window.__skyquilt.state().play?.stop?.id === id && window.__skyquilt.state().play.phase === "stop",
    stops[index].id,
    { timeout: 30_000 },
  );
  await page.evaluate(() => window.__skyquilt.settle());
}

/** What a person sees of the view: with what the browser makes of the canvas, and without what lies over it. */
async function seen(page) {
  const hide = (how) =>
    page.evaluate((visibility) => {
      for (const one of document.querySelectorAll("#ui, #stage :not(canvas)")) one.style.visibility = visibility;
    }, how);
  await hide("hidden");
  const picture = PNG.sync.read(await page.screenshot());
  await hide("");
  return picture;
}

/** At the last stop the box stands behind the house. Afterwards it is away. */
async function checkBox(page, depthFile) {
  const box = tour.things.find(({ kind, name }) => kind === "model" && name === "box");
  await page.waitForFunction((at) => window.__skyquilt.project(at) !== null, box.at);
  const picture = await canvasPicture(page);
  save(picture, path.join(out, "box.png"));
  const inBox = await pixelsInBox(page, box.at, SIZE.width, SIZE.height);
  await page.evaluate(() => window.__skyquilt.setThings([]));
  await page.evaluate(() => window.__skyquilt.idle());
  figures.box = boxAgainstDepth(inBox, depthFile, picture, await canvasPicture(page));
  expectHalfHidden("the box in the exported tour", figures.box, inBox, expect);
}

async function checkStops(page, rendered) {
  figures.differing = [];
  for (const [i, { id, exposure_stops }] of stops.entries()) {
    if (i > 0) await page.keyboard.press("ArrowRight");
    await arrived(page, i);
    if (i === LAST) await checkBox(page, rendered.get(id).depth);
    const picture = exposure_stops === null ? await canvasPicture(page) : await seen(page);
    save(picture, path.join(out, `stop_${i + 1}.png`));
    const share = differing(picture, PNG.sync.read(readFileSync(rendered.get(id).png)), 8);
    figures.differing.push(share);
    expect(share <= 0.01, `stop ${i + 1}: ${share} of the picture differ from 'skyquilt render'`);
  }
}

/** Texts are shown as texts, and nothing of them was run. */
async function checkTexts(page) {
  const card = page.locator(".player-card");
  expect((await card.getByRole("heading").textContent()) === stops[0].title, "the first stop has another title");
  expect((await card.locator(".player-words").textContent()) === stops[0].text, "the first stop has another text");
  expect((await page.locator(".player b, .player script, .player img[src=x]").count()) === 0, "text became elements");
  expect((await page.title()) === tour.title, `the page's title is ${await page.title()}`);
  await page.waitForFunction(() => document.querySelector(".player-picture")?.naturalWidth === 60);
  await page.getByRole("button", { name: "All stops" }).click();
  const list = page.locator(".player-list");
  expect((await list.getByRole("heading").textContent()) === tour.title, "the list has another title");
  const missing = await list.locator("details li").allTextContents();
  expect(missing.length === 2 && /"Shed" is left out/.test(missing.join()), `what is missing: ${missing.join(" ")}`);
  await screenshot(page, out, "list");
  await page.getByRole("button", { name: "All stops" }).click();
  expect((await page.evaluate(() => window.hacked)) === undefined, "a script in a text was run");
}

const browser = await start();
try {
  const rendered = renderStops();
  const local = await open(browser, pathToFileURL(path.join(folder, "index.html")).href, SIZE);
  figures.open_s = local.seconds;
  await checkStops(local.page, rendered);
  await local.page.setViewportSize({ width: 1000, height: 640 });
  for (let i = LAST; i > 0; i -= 1) {
    await local.page.keyboard.press("ArrowLeft");
    await arrived(local.page, i - 1);
  }
  await checkTexts(local.page);
  await screenshot(local.page, out, "exported");
  failures.push(...local.problems);
  await local.context.close();

  const surface = readSurface((name) => packedFile(folder, `tiles/${name}`));
  const { server, link } = await serve(path.resolve(folder));
  const remote = await open(browser, link, SIZE);
  await remote.page.waitForFunction(() => window.__skyquilt.state().map !== null);
  figures.ways_m = [];
  const first = await walk(remote.page, () => remote.page.keyboard.press("ArrowRight"), 1);
  figures.ways_m.push(checkWay(surface, first, "to stop 2", expect));
  // Without animation to the one before the last; tour_page.mjs has walked over the house.
  for (let i = 2; i < LAST; i += 1) {
    await remote.page.keyboard.press("ArrowRight");
    await arrived(remote.page, i);
  }
  const last = await walk(remote.page, () => remote.page.keyboard.press("ArrowRight"), LAST);
  figures.ways_m.push(checkWay(surface, last, "to the last stop", expect));
  const errors = await remote.page.evaluate(() => window.__skyquilt.state().notices.map(({ text }) => text));
  expect(errors.length === 0, `messages: ${errors}`);
  expect((await remote.page.evaluate(() => window.hacked)) === undefined, "a script in a text was run");
  failures.push(...remote.problems.map((text) => `served: ${text}`));
  await remote.context.close();
  server.close();
} catch (error) {
  failures.push(`${error.stack}`);
} finally {
  await browser.close();
}
report(failures, figures);
