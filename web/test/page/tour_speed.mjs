// Measures an exported tour on file://: milliseconds to the poster, to the picture of the first stop and to all tiles; frames per second on the ways.
//   node tour_speed.mjs FOLDER [RUNS WIDTH HEIGHT]
// Run it in the build folder's copy of web/, whose dist_test has the page with the hook of tests; the folder itself is left as it is. Prints medians.
import { mkdtempSync, readdirSync, rmSync, symlinkSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { open, start } from "./browser.mjs";

const [folder, runs = "5", width = "400", height = "250"] = process.argv.slice(2);
const HOOKED = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../../dist_test/tour.js");
const SIZE = { width: Number(width), height: Number(height), reduced: false, ready: false };

function median(values) {
  const sorted = values.filter(Number.isFinite).sort((a, b) => a - b);
  return sorted.length === 0 ? null : Math.round(10 * sorted[Math.floor(sorted.length / 2)]) / 10;
}

/** The tour with the other script. */
function hookedCopy() {
  const copy = mkdtempSync(path.join(tmpdir(), "tour_speed_"));
  for (const name of readdirSync(folder)) {
    symlinkSync(name === "tour.js" ? HOOKED : path.resolve(folder, name), path.join(copy, name));
  }
  return copy;
}

/** Milliseconds since the navigation when this becomes true, looked at with every picture of the screen. */
async function when(page, condition, argument = null) {
  await page.waitForFunction(condition, argument, { timeout: 120_000 });
  return page.evaluate(() => performance.now());
}

async function measureOpening(page) {
  const still = await when(page, () => window.__skyquilt?.statistics().frames > 0);
  const all = await when(page, () => window.__skyquilt.ready());
  const poster = await page.evaluate(
    () => performance.getEntriesByName("first-contentful-paint")[0]?.startTime ?? Number.NaN,
  );
  return { poster, still, all };
}

/** Milliseconds between pictures of the screen on the ways to all stops. */
async function measureWays(page) {
  await when(page, () => window.__skyquilt.state().map !== null);
  const count = await page.evaluate(() => window.__skyquilt.state().documents.tour.stops.length);
  await page.evaluate(() => {
    window.gaps = [];
    let last = null;
    const note = (now) => {
      const moving = window.__skyquilt.state().play?.phase === "moving";
      if (moving && last !== null) window.gaps.push(now - last);
      last = moving ? now : null;
      requestAnimationFrame(note);
    };
    requestAnimationFrame(note);
  });
  for (let i = 1; i < count; i += 1) {
    await page.keyboard.press("ArrowRight");
    await when(page, (index) => window.__skyquilt.state().play.progress.index === index, i);
    await when(page, () => window.__skyquilt.state().play.phase === "stop");
  }
  return page.evaluate(() => window.gaps);
}

const copy = hookedCopy();
const browser = await start();
try {
  const openings = [];
  let gaps = [];
  const problems = [];
  for (let run = 0; run < Number(runs); run += 1) {
    const opened = await open(browser, pathToFileURL(path.join(copy, "index.html")).href, SIZE);
    openings.push(await measureOpening(opened.page));
    if (run === 0) gaps = await measureWays(opened.page);
    problems.push(...opened.problems);
    await opened.context.close();
  }
  const sorted = gaps.sort((a, b) => a - b);
  const total = sorted.reduce((sum, gap) => sum + gap, 0);
  const figures = {
    size: `${width} x ${height}`,
    runs: openings.length,
    poster_ms: median(openings.map(({ poster }) => poster)),
    first_stop_ms: median(openings.map(({ still }) => still)),
    all_tiles_ms: median(openings.map(({ all }) => all)),
    frames_on_ways: sorted.length,
    median_frame_ms: median(sorted),
    p95_frame_ms: sorted[Math.floor(0.95 * sorted.length)] ?? null,
    fps: (1000 * sorted.length) / total,
    problems,
  };
  console.log(JSON.stringify(figures, null, 1));
} finally {
  await browser.close();
  rmSync(copy, { recursive: true });
}
