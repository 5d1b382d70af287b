// Measures the page: seconds to the first picture, and frames per second while the camera moves over the surface with the engine idle.
//   node speed.mjs LINK [WIDTH HEIGHT SECONDS]
// The link must lead to a front end that was built with --test-hook (skyquilt view FOLDER --front-end build/ci/web/dist_test).
import { open, start } from "./browser.mjs";

const [link, width = "400", height = "250", seconds = "10"] = process.argv.slice(2);
const browser = await start();
try {
  const {
    page,
    problems,
    seconds: opened,
  } = await open(browser, link, { width: Number(width), height: Number(height) });
  const renderer = await page.evaluate(() => {
    const gl = document.createElement("canvas").getContext("webgl2");
    const info = gl?.getExtension("WEBGL_debug_renderer_info");
    return info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : "unknown";
  });
  await page.evaluate(() => window.__skyquilt.idle());
  // A slow orbit, one step per animation frame.
  const result = await page.evaluate(async (duration) => {
    const hook = window.__skyquilt;
    hook.setLayer("exact", false);
    const project = await (await fetch("/data/project.json")).json();
    const middle = project.min_enu.map((low, i) => (low + project.max_enu[i]) / 2);
    middle[2] = project.ground_m;
    const reach = 0.4 * Math.max(project.max_enu[0] - project.min_enu[0], project.max_enu[1] - project.min_enu[1]);
    const times = [];
    const begin = performance.now();
    while (performance.now() - begin < 1000 * duration) {
      const turn = (performance.now() - begin) / 4000;
      hook.lookAt(
        [middle[0] + reach * Math.cos(turn), middle[1] + reach * Math.sin(turn), middle[2] + reach],
        middle,
        50,
      );
      await new Promise((done) => requestAnimationFrame(done));
      times.push(performance.now());
    }
    const gaps = times
      .slice(1)
      .map((time, i) => time - times[i])
      .sort((a, b) => a - b);
    return {
      frames: gaps.length,
      median_ms: gaps[Math.floor(gaps.length / 2)],
      p95_ms: gaps[Math.floor(0.95 * gaps.length)],
      fps: (1000 * times.length) / (times[times.length - 1] - times[0]),
    };
  }, Number(seconds));
  console.log(
    JSON.stringify({ renderer, size: `${width} x ${height}`, first_picture_s: opened, ...result, problems }, null, 1),
  );
} finally {
  await browser.close();
}
