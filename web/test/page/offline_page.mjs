// The page of an exported tour in a real browser, from file:// and from a plain web server:
//   node offline_page.mjs DIST OUT
// DIST has the bundles with the hook of tests, OUT gets the folder of the tour and screenshots. Exits with 1 and the list of failures.
import { renameSync, rmSync } from "node:fs";
import path from "node:path";
import { pathToFileURL } from "node:url";
import { canvasPicture, differing, open, report, save, screenshot, start } from "./browser.mjs";
import { colourOf, GROUND, MODEL_AT, rayOf, rotationOf, STILL, stillOf, writeSample } from "./export_sample.mjs";
import { serve } from "./static_server.mjs";

const [dist, out] = process.argv.slice(2);
const SIZE = { width: STILL.width, height: STILL.height };
const failures = [];
const figures = {};

function expect(condition, text) {
  if (!condition) failures.push(text);
}

/** A JPEG of a picture of pngjs, made by the browser. */
function jpegEncoder(page) {
  return async ({ width, height, data }) => {
    const encoded = await page.evaluate(
      async ([w, h, base64]) => {
        const text = atob(base64);
        const rgba = Uint8ClampedArray.from({ length: text.length }, (_, i) => text.charCodeAt(i));
        const canvas = new OffscreenCanvas(w, h);
        canvas.getContext("2d").putImageData(new ImageData(rgba, w, h), 0, 0);
        const blob = await canvas.convertToBlob({ type: "image/jpeg", quality: 0.95 });
        const bytes = new Uint8Array(await blob.arrayBuffer());
        let letters = "";
        for (let at = 0; at < bytes.length; at += 8192)
          letters += String.fromCharCode(...bytes.subarray(at, at + 8192));
        return btoa(letters);
      },
      [width, height, data.toString("base64")],
    );
    return Buffer.from(encoded, "base64");
  };
}

/** Share of pixels in rows `from` to `to` whose colour is farther than `most` from the expected one. */
function unlike(picture, from, to, most, expected) {
  let count = 0;
  for (let row = from; row < to; row += 1) {
    for (let column = 0; column < picture.width; column += 1) {
      const at = 4 * (row * picture.width + column);
      const colour = expected(column, row);
      if (colour.some((value, k) => Math.abs(value - picture.data[at + k]) > most)) count += 1;
    }
  }
  return count / ((to - from) * picture.width);
}

function fly(page, pose) {
  return page.evaluate((at) => window.__skyquilt.flyTo(at), pose);
}

function poseOf({ pose }, rotation = pose.rotation) {
  return { eyeEnu: pose.eye_enu, rotation, fovyDeg: pose.fovy_deg, orthoHeightM: null };
}

async function checkStop(page, stop, name, { there = false } = {}) {
  if (!there) await fly(page, poseOf(stop));
  await page.evaluate(() => window.__skyquilt.settle());
  const picture = await canvasPicture(page);
  save(picture, path.join(out, `${name}.png`));
  const share = differing(picture, stillOf(stop), 8);
  figures[name] = share;
  expect(share <= 0.01, `${name}: ${share} of the picture are not the still`);
}

async function checkTurning(page, stop) {
  figures.turned = [];
  for (const [yawDeg, pitchDeg] of [
    [180, -10],
    [75, -89],
    [300, 60],
  ]) {
    const rotation = rotationOf(yawDeg, pitchDeg);
    await fly(page, poseOf(stop, rotation));
    await page.evaluate(() => window.__skyquilt.settle());
    const picture = await canvasPicture(page);
    save(picture, path.join(out, `turned_${yawDeg}.png`));
    // The panorama's pixels are 0.35 degrees wide, and it is a JPEG.
    const share = unlike(picture, 0, SIZE.height, 6, (column, row) =>
      colourOf(rayOf(rotation, stop.pose.fovy_deg, SIZE, [column + 0.5, row + 0.5])),
    );
    figures.turned.push(share);
    expect(share <= 0.01, `turned to ${yawDeg}, ${pitchDeg}: ${share} of the picture show another direction`);
  }
}

/** The panorama is seen beside the still where the window is wider than it. */
async function checkWide(page, stop) {
  await page.setViewportSize({ width: 600, height: SIZE.height });
  await fly(page, poseOf(stop));
  await page.evaluate(() => window.__skyquilt.settle());
  const picture = await canvasPicture(page);
  save(picture, path.join(out, "wide.png"));
  const still = stillOf(stop);
  const { rotation, fovy_deg } = stop.pose;
  figures.wide = unlike(picture, 0, SIZE.height, 8, (column, row) => {
    const at = 4 * (row * SIZE.width + column - 100);
    if (column >= 100 && column < 500) return [...still.data.subarray(at, at + 3)];
    return colourOf(rayOf(rotation, fovy_deg, picture, [column + 0.5, row + 0.5]));
  });
  expect(figures.wide <= 0.01, `${figures.wide} of the wide picture are neither still nor panorama`);
  await page.setViewportSize(SIZE);
  // The pictures of this size come before the next check counts them.
  await page.evaluate(() => window.__skyquilt.settle());
}

async function checkBetween(page, [from, to]) {
  const before = await page.evaluate(() => window.__skyquilt.statistics().frames);
  const eyeEnu = from.pose.eye_enu.map((value, i) => (value + to.pose.eye_enu[i]) / 2);
  await fly(page, { ...poseOf(from, rotationOf(0, -60)), eyeEnu });
  await page.evaluate(() => window.__skyquilt.idle());
  await page.waitForTimeout(400);
  const picture = await canvasPicture(page);
  save(picture, path.join(out, "between.png"));
  figures.between = unlike(picture, 0, SIZE.height, 4, () => GROUND);
  // A label may lie over it.
  expect(figures.between <= 0.01, `between the stops ${figures.between} of the picture are not the ground`);
  const after = await page.evaluate(() => window.__skyquilt.statistics().frames);
  expect(after === before, `${after - before} pictures came where there is none`);
}

/** Title, text, picture and map of a stop; keys and a drag. */
async function checkPlaying(page, stops) {
  await page.setViewportSize({ width: 1000, height: 640 });
  // Where the checks before have left the view.
  await page.keyboard.press("r");
  await page.keyboard.press("ArrowLeft");
  await page.waitForFunction((id) => window.__skyquilt.state().play.stop.id === id, stops[0].id);
  await page.waitForFunction(() => window.__skyquilt.state().play.phase === "stop");
  const card = page.locator(".player-card");
  const title = await card.getByRole("heading").textContent();
  expect(title === stops[0].title, `the title is ${title}`);
  expect((await page.title()) === "A <i>small</i> tour", `the page's title is ${await page.title()}`);
  const words = await card.locator(".player-words").textContent();
  expect(words === stops[0].text, `the text is ${words}`);
  await page.waitForFunction(() => document.querySelector(".player-picture")?.naturalWidth === 40);
  const [link] = await card
    .locator("a")
    .evaluateAll((all) => all.map(({ href, rel, target }) => ({ href, rel, target })));
  expect(link.href === stops[0].link.url && link.target === "_blank", `the link is ${JSON.stringify(link)}`);
  await page.waitForFunction(() => window.__skyquilt.state().map !== null);
  await page.waitForFunction(() => window.__skyquilt.visibleTexts().includes("l1"));
  await screenshot(page, out, "player");
  expect((await page.getByLabel("Leave the tour").count()) === 0, "there is nowhere to leave the tour to");
  await page.keyboard.press("Escape");

  const eye = () => page.evaluate(() => window.__skyquilt.pose().eyeEnu);
  await page.mouse.move(700, 300);
  await page.mouse.down();
  await page.mouse.move(500, 330, { steps: 4 });
  await page.mouse.up();
  await page.evaluate(() => window.__skyquilt.settle());
  const looking = await page.evaluate(() => window.__skyquilt.state().play.phase);
  expect(looking === "look", `after a drag the phase is ${looking}`);
  const moved = (await eye()).map((value, i) => value - stops[0].pose.eye_enu[i]);
  expect(Math.hypot(...moved) < 1e-6, `a drag moves the eye by ${moved}`);

  await page.keyboard.press("ArrowRight");
  await page.waitForFunction((id) => window.__skyquilt.state().play.stop.id === id, stops[1].id);
  await page.waitForFunction(() => window.__skyquilt.state().play.phase === "stop");
  const there = (await eye()).map((value, i) => value - stops[1].pose.eye_enu[i]);
  expect(Math.hypot(...there) < 1e-6, `the next stop is ${there} off`);
  const [x, y] = await page.evaluate((at) => window.__skyquilt.project(at), MODEL_AT);
  await page.waitForFunction((px) => window.__skyquilt.thingAt(px) === "m1", [x, y]);
  await page.getByLabel("All stops").click();
  const missing = await page.locator(".player-list details").textContent();
  expect(/The model "tree" is left out/.test(missing), `what is missing: ${missing}`);
  const errors = await page.evaluate(() => window.__skyquilt.state().notices.map(({ text }) => text));
  expect(errors.length === 0, `messages: ${errors}`);
}

const browser = await start();
try {
  const folder = path.join(path.resolve(out), "tour");
  rmSync(folder, { recursive: true, force: true });
  const painter = await browser.newPage();
  const stops = await writeSample(folder, dist, jpegEncoder(painter));
  await painter.close();
  const link = pathToFileURL(path.join(folder, "index.html")).href;

  const local = await open(browser, link, SIZE);
  figures.open_s = local.seconds;
  await checkStop(local.page, stops[0], "first_stop");
  await checkTurning(local.page, stops[0]);
  await checkWide(local.page, stops[0]);
  await checkBetween(local.page, stops);
  await checkStop(local.page, stops[1], "second_stop");
  await checkPlaying(local.page, stops);
  failures.push(...local.problems);
  await local.context.close();

  const { server, link: served } = await serve(folder);
  const remote = await open(browser, served, { ...SIZE, reduced: false });
  await checkStop(remote.page, stops[0], "served", { there: true });
  await remote.page.keyboard.press("ArrowRight");
  await remote.page.waitForFunction(() => window.__skyquilt.state().play.phase === "moving");
  await remote.page.waitForFunction(() => window.__skyquilt.state().play.phase === "stop");
  await checkStop(remote.page, stops[1], "walked", { there: true });
  failures.push(...remote.problems.map((text) => `served: ${text}`));
  await remote.context.close();
  server.close();

  // A folder that was not copied whole.
  renameSync(path.join(folder, "data", "tour.json.js"), path.join(folder, "tour.json.js"));
  const broken = await open(browser, link, { ...SIZE, ready: false });
  const alert = broken.page.getByRole("alert");
  await alert.waitFor();
  const said = await alert.textContent();
  expect(/data\/tour\.json\.js could not be loaded/.test(said), `without tour.json the page says: ${said}`);
  await screenshot(broken.page, out, "broken");
} catch (error) {
  failures.push(`${error.stack}`);
} finally {
  await browser.close();
}
report(failures, figures);
