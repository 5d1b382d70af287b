// Starts Debian's Chromium and opens the viewer in it. Whatever a page must never do is collected in `problems`: errors on the console, reports of the
// content security policy, requests to other hosts.
import { writeFileSync } from "node:fs";
import path from "node:path";
import { chromium } from "playwright-core";
import { PNG } from "pngjs";

const FLAGS = [
  "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader",
  "--hide-scrollbars",
  "--disable-background-networking",
];

export async function start() {
  const root = process.getuid?.() === 0;
  return chromium.launch({
    executablePath: process.env.SKYQUILT_CHROMIUM ?? "/usr/bin/chromium",
    headless: true,
    args: root ? [...FLAGS, "--no-sandbox"] : FLAGS,
  });
}

/** Opens the link in a fresh profile. `ready`: also waits until the scene has drawn its tiles. */
export async function open(
  browser,
  link,
  { width, height, ready = true, dark = false, touch = false, reduced = true } = {},
) {
  const context = await browser.newContext({
    viewport: { width, height },
    deviceScaleFactor: 1,
    colorScheme: dark ? "dark" : "light",
    hasTouch: touch,
    // Without animations a test does not wait for them.
    reducedMotion: reduced ? "reduce" : "no-preference",
    acceptDownloads: true,
  });
  const page = await context.newPage();
  const problems = [];
  // Files have no origin of their own.
  const origin = link.startsWith("file:") ? "file://" : new URL(link).origin;
  page.on("console", (message) => {
    if (message.type() === "error" || /Content Security Policy/i.test(message.text()))
      problems.push(`console: ${message.text()}`);
  });
  page.on("pageerror", (error) => problems.push(`exception: ${error.message}`));
  page.on("request", (request) => {
    const url = request.url();
    if (!url.startsWith(origin) && !url.startsWith("blob:") && !url.startsWith("data:"))
      problems.push(`foreign request: ${url}`);
  });
  page.on("response", (response) => {
    if (response.status() >= 400) {
      problems.push(`${response.status()} for ${response.url()}`);
    }
  });
  const started = Date.now();
  await page.goto(link);
  if (ready) {
    await page.waitForFunction(() => window.__skyquilt?.ready() === true, null, { timeout: 60_000 });
  }
  return { context, page, problems, seconds: (Date.now() - started) / 1000 };
}

/** The canvas of the scene as a PNG of pngjs. */
export async function canvasPicture(page) {
  const { w, h, rgba } = await page.evaluate(() => window.__skyquilt.capturePixels());
  const picture = new PNG({ width: w, height: h });
  Buffer.from(rgba, "base64").copy(picture.data);
  return picture;
}

export function save(picture, file) {
  writeFileSync(file, PNG.sync.write(picture));
}

/** Share of pixels that differ by more than `most` of 255 in a channel. */
export function differing(a, b, most) {
  if (a.width !== b.width || a.height !== b.height)
    throw new Error(`${a.width} x ${a.height} against ${b.width} x ${b.height}`);
  let count = 0;
  for (let i = 0; i < a.data.length; i += 4) {
    for (let c = 0; c < 3; c += 1) {
      if (Math.abs(a.data[i + c] - b.data[i + c]) > most) {
        count += 1;
        break;
      }
    }
  }
  return count / (a.width * a.height);
}

export async function screenshot(page, folder, name) {
  await page.screenshot({ path: path.join(folder, `${name}.png`) });
}

/** Prints the failures and figures of a check; with failures the program ends with 1. */
export function report(failures, figures = null) {
  if (figures !== null) console.log(JSON.stringify(figures, null, 1));
  if (failures.length === 0) return;
  console.log(failures.map((text) => `FAILED: ${text}`).join("\n"));
  process.exitCode = 1;
}
