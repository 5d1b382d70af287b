// A tour that `skyquilt tour` exported, played from file:// in a real browser:
//   node exported_page.mjs FOLDER PROJECT PROGRAM OUT
// Its pictures must be of 400 x 250 pixels and its script that of tests. Exits with 1 and the list of failures; screenshots are left in OUT.
import { mkdirSync, readFileSync } from "node:fs";
import path from "node:path";
import { pathToFileURL } from "node:url";
import { PNG } from "pngjs";
import { canvasPicture, differing, open, report, save, screenshot, start } from "./browser.mjs";
import { renderPose } from "./render_pose.mjs";

const [folder, project, program, out] = process.argv.slice(2);
const SIZE = { width: 400, height: 250 };
const failures = [];
const figures = {};
mkdirSync(out, { recursive: true });

/** The canvas at each stop beside `skyquilt render` of its pose. */
async function checkStops(page) {
  const { stops } = JSON.parse(readFileSync(path.join(project, "tour.json"), "utf8"));
  figures.differing = [];
  for (const [i, stop] of stops.entries()) {
    if (i > 0) await page.keyboard.press("ArrowRight");
    await page.waitForFunction(
      (id) => window.__skyquilt.state().play?.stop?.id === id && window.__skyquilt.state().play.phase === "stop",
      stop.id,
      { timeout: 30_000 },
    );
    await page.evaluate(() => window.__skyquilt.settle());
    const picture = await canvasPicture(page);
    save(picture, path.join(out, `stop_${i + 1}.png`));
    const pose = { eyeEnu: stop.pose.eye_enu, rotation: stop.pose.rotation, fovyDeg: stop.pose.fovy_deg };
    const { png } = renderPose({ program, project, out, ...SIZE }, pose, `rendered_${i + 1}`);
    const share = differing(picture, PNG.sync.read(readFileSync(png)), 8);
    figures.differing.push(share);
    if (share > 0.01) failures.push(`stop ${i + 1}: ${share} of the picture differ from 'skyquilt render'`);
  }
}

const browser = await start();
try {
  const { page, seconds, problems } = await open(browser, pathToFileURL(path.join(folder, "index.html")).href, SIZE);
  figures.open_s = seconds;
  await checkStops(page);
  await page.setViewportSize({ width: 1000, height: 640 });
  await page.evaluate(() => window.__skyquilt.settle());
  await screenshot(page, out, "exported");
  failures.push(...problems);
} catch (error) {
  failures.push(`${error.stack}`);
} finally {
  await browser.close();
}
report(failures, figures);
