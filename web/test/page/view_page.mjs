// The viewer in a real browser, over a project with ground truth. Called by tests/e2e/view.py:
//   node view_page.mjs LINK PROJECT TRUTH PROGRAM OUT
// Exits with 1 and the list of failures; screenshots are left in OUT.
import { execFileSync } from "node:child_process";
import { existsSync, readFileSync } from "node:fs";
import path from "node:path";
import { PNG } from "pngjs";
import { canvasPicture, differing, open, report, save, screenshot, start } from "./browser.mjs";
import { renderPose, rotateBack } from "./render_pose.mjs";
import { checkThings, truthHouses } from "./things_check.mjs";

const [link, project, truth, program, out] = process.argv.slice(2);
const WIDTH = 400;
const HEIGHT = 250;

const failures = [];
const figures = {};

function expect(condition, text) {
  if (!condition) failures.push(text);
}

function add(a, b, factor = 1) {
  return a.map((value, i) => value + factor * b[i]);
}

function distance(a, b) {
  return Math.hypot(...a.map((value, i) => value - b[i]));
}

/** A level camera at `eye` that looks at `target`, as cam_from_enu (w, x, y, z). */
async function lookAt(page, eye, target, fovyDeg) {
  return page.evaluate(([e, t, f]) => window.__skyquilt.lookAt(e, t, f), [eye, target, fovyDeg]);
}

async function settled(page) {
  return page.evaluate(() => window.__skyquilt.settle());
}

const rendered = (pose, name) => renderPose({ program, project, out, width: WIDTH, height: HEIGHT }, pose, name);

function depthAt(file, x, y) {
  return Number(execFileSync("gdallocationinfo", ["-valonly", file, String(x), String(y)]).toString());
}

async function checkPictures(page, description) {
  const middle = description.min_enu.map((low, i) => (low + description.max_enu[i]) / 2);
  middle[2] = description.ground_m;
  const reach = Math.max(
    description.max_enu[0] - description.min_enu[0],
    description.max_enu[1] - description.min_enu[1],
  );
  await page.evaluate(() => window.__skyquilt.setLayer("exact", false));
  await lookAt(page, add(middle, [0.3 * reach, -0.5 * reach, 0.5 * reach]), middle, 45);
  await page.evaluate(() => window.__skyquilt.idle());
  const first = await canvasPicture(page);
  save(first, path.join(out, "mesh_1.png"));
  await lookAt(page, add(middle, [-0.2 * reach, -0.3 * reach, 0.35 * reach]), middle, 45);
  await page.evaluate(() => window.__skyquilt.idle());
  const mesh = await canvasPicture(page);
  save(mesh, path.join(out, "mesh_2.png"));
  figures.moved = differing(first, mesh, 16);
  expect(figures.moved > 0.2, `moving changes ${figures.moved} of the picture`);
  await page.evaluate(() => window.__skyquilt.setLayer("exact", true));
  const frame = await settled(page);
  expect(frame.w === WIDTH && frame.h === HEIGHT, `the last pass has ${frame.w} x ${frame.h} pixels`);
  const exact = await canvasPicture(page);
  save(exact, path.join(out, "settled.png"));
  await screenshot(page, out, "page_small");
  figures.rested = differing(mesh, exact, 4);
  expect(figures.rested > 0.05, `resting changes ${figures.rested} of the picture`);

  const pose = await page.evaluate(() => window.__skyquilt.pose());
  const reference = rendered(pose, "reference");
  figures.different = differing(exact, PNG.sync.read(readFileSync(reference.png)), 2);
  expect(figures.different <= 0.01, `${figures.different} of the settled picture differ from 'skyquilt render'`);

  // A click's coordinate against the depth image.
  const places = [
    [WIDTH / 2, HEIGHT / 2],
    [WIDTH / 4, HEIGHT / 2],
    [(3 * WIDTH) / 4, (2 * HEIGHT) / 3],
  ];
  figures.clicks_m = [];
  for (const [x, y] of places) {
    const column = Math.floor(x);
    const row = Math.floor(y);
    const depth = depthAt(reference.depth, column, row);
    if (!Number.isFinite(depth)) continue;
    // The middle of the pixel, where the depth image has its ray.
    const px = [column + 0.5, row + 0.5];
    const picked = await page.evaluate((at) => window.__skyquilt.pickAt(at), px);
    if (picked.field === null) {
      failures.push(`no point of the field at ${px}`);
      continue;
    }
    const focal = HEIGHT / 2 / Math.tan((pose.fovyDeg * Math.PI) / 360);
    const ray = [(px[0] - WIDTH / 2) / focal, (px[1] - HEIGHT / 2) / focal, 1];
    const direction = rotateBack(
      pose.rotation,
      ray.map((value) => value / Math.hypot(...ray)),
    );
    figures.clicks_m.push(distance(picked.field.enu, add(pose.eyeEnu, direction, depth)));
  }
  expect(
    figures.clicks_m.length > 0 && Math.max(...figures.clicks_m) <= description.gsd_m,
    `clicks are ${figures.clicks_m} m off`,
  );
}

/** The eaves along a house's length, measured between two clicks from obliquely above. */
async function checkHouse(page, description) {
  const houses = truthHouses(truth);
  expect(houses.length > 0, "no house in the truth");
  figures.houses = [];
  for (const house of houses.slice(0, 3)) {
    const yaw = (house.yaw_deg * Math.PI) / 180;
    const along = [Math.cos(yaw), Math.sin(yaw), 0];
    const across = [-Math.sin(yaw), Math.cos(yaw), 0];
    const top = house.ground_z_m + house.ridge_height_m;
    const middle = [house.east_m, house.north_m, top];
    // The ends of the ridge, or of a flat roof's middle line, half a pixel of the photos inside.
    const ends = [-1, 1].map((side) => add(middle, along, side * (house.length_m / 2 - description.gsd_m / 2)));
    await lookAt(page, add(add(middle, across, 30), [0, 0, 45]), middle, 40);
    await settled(page);
    const points = [];
    for (const end of ends) {
      const px = await page.evaluate((point) => window.__skyquilt.project(point), end);
      const picked = await page.evaluate((where) => window.__skyquilt.pickAt(where), px);
      if (picked.field !== null) points.push(picked.field.enu);
    }
    if (points.length < 2) continue;
    figures.houses.push({
      id: house.id,
      truth_m: house.length_m,
      measured_m: distance(points[0], points[1]) + description.gsd_m,
    });
  }
  await screenshot(page, out, "house");
  const errors = figures.houses.map((one) => Math.abs(one.measured_m - one.truth_m));
  expect(errors.length >= 2, `only ${errors.length} houses could be measured`);
  const worst = Math.max(...errors);
  expect(worst <= 2 * description.gsd_m, `houses are ${errors} m too long or short; GSD ${description.gsd_m} m`);
}

async function checkTools(page, description) {
  const middle = description.min_enu.map((low, i) => (low + description.max_enu[i]) / 2);
  middle[2] = description.ground_m;
  await lookAt(page, add(middle, [0, -60, 60]), middle, 45);
  await page.evaluate(() => window.__skyquilt.idle());
  await page.evaluate(() => window.__skyquilt.run("tool.distance"));
  const canvas = page.locator("canvas").first();
  await canvas.click({ position: { x: 120, y: 130 } });
  await canvas.click({ position: { x: 250, y: 140 } });
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => window.__skyquilt.state().documents.measurements.length === 1);
  await page.waitForFunction(() =>
    window.__skyquilt.state().documents.measurements[0].points.every((point) => point.source === "field"),
  );
  const [measured] = await page.evaluate(() => window.__skyquilt.state().documents.measurements);
  figures.distance = measured.result.slope;
  expect(
    measured.kind === "distance" && measured.result.slope.value > 1 && measured.result.slope.sigma > 0,
    `distance: ${JSON.stringify(measured.result)}`,
  );
  await page.waitForFunction(() => window.__skyquilt.state().save === "saved", null, { timeout: 20_000 });
  const file = path.join(project, "measurements.geojson");
  expect(existsSync(file), "measurements.geojson is not written");
  if (existsSync(file))
    expect(JSON.parse(readFileSync(file, "utf8")).features.length === 1, "measurements.geojson has not one feature");
  for (let i = 0; i < 3; i += 1) await page.evaluate(() => window.__skyquilt.run("edit.undo"));
  const left = await page.evaluate(() => window.__skyquilt.state().documents.measurements.length);
  expect(left === 0, `${left} measurements after undo`);
  await page.keyboard.press("Escape");
}

/** The panel of buildings, a click on a model in the view, and its height in the system of the maps. */
async function checkBuildings(page, description) {
  const count = description.buildings?.count ?? 0;
  expect(count > 0, `no buildings: ${JSON.stringify(description.missing)}`);
  if (count === 0) return;
  await page.evaluate(() => window.__skyquilt.run("panel.buildings"));
  await page.waitForFunction(() => window.__skyquilt.state().buildings.set !== null);
  const rows = page.locator(".buildings tbody tr");
  await rows.first().waitFor();
  expect((await rows.count()) === count, `${await rows.count()} rows for ${count} buildings`);
  const building = await page.evaluate(() => {
    const { buildings } = window.__skyquilt.state().buildings.set;
    return [...buildings].sort((a, b) => b.measures.area.value - a.measures.area.value)[0];
  });
  const { vertices } = building.solid;
  const middle = [0, 1, 2].map((axis) => vertices.reduce((sum, vertex) => sum + vertex[axis] / vertices.length, 0));
  await lookAt(page, add(middle, [0, -30, 40]), middle, 45);
  await page.evaluate(() => window.__skyquilt.idle());
  const [x, y] = await page.evaluate((point) => window.__skyquilt.project(point), middle);
  await page.locator("canvas").first().click({ position: { x, y } });
  const chosen = await page.evaluate(() => window.__skyquilt.state().selectedBuilding);
  expect(chosen === building.id, `a click on building ${building.id} chose ${chosen}`);
  // On the ellipsoid, as the maps have it.
  const roof = description.origin.height_m + building.measures.ridge.value;
  const shown = await page
    .locator(".building-card .fact", { hasText: /^Roof\d/ })
    .locator("dd")
    .textContent();
  figures.roof = { expected_m: roof, shown };
  expect(Math.abs(Number.parseFloat(shown) - roof) < 0.06, `the roof is at ${roof} m, the card says ${shown}`);
  await screenshot(page, out, "buildings");
  await page.keyboard.press("Escape");
  expect(
    (await page.evaluate(() => window.__skyquilt.state().selectedBuilding)) === null,
    "Escape keeps the chosen building",
  );
  await page.evaluate(() => window.__skyquilt.setLayer("buildings", false));
}

async function checkPhoto(page, description) {
  const index = description.photos.findIndex((photo) => photo.available && !photo.is_test);
  await page.evaluate((photo) => window.__skyquilt.openPhoto(photo), index);
  await page.waitForFunction((photo) => window.__skyquilt.state().compare?.photo === photo, index);
  const pose = await page.evaluate(() => window.__skyquilt.pose());
  const photo = description.photos[index];
  expect(
    distance(pose.eyeEnu, photo.position) < 1e-3,
    `the camera is ${distance(pose.eyeEnu, photo.position)} m from the photo's`,
  );
  const dot = Math.abs(pose.rotation.reduce((sum, value, i) => sum + value * photo.rotation[i], 0));
  figures.photo_turn_deg = (2 * Math.acos(Math.min(1, dot)) * 180) / Math.PI;
  expect(figures.photo_turn_deg < 0.05, `the camera is turned by ${figures.photo_turn_deg} degrees`);
  await page.evaluate(() => window.__skyquilt.settle());
  await page.waitForTimeout(300);
  await screenshot(page, out, "photo");
  await page.keyboard.press("Escape");
  await page.waitForFunction(() => window.__skyquilt.state().compare === null);
}

const browser = await start();
try {
  const { page, problems, seconds } = await open(browser, link, { width: WIDTH, height: HEIGHT });
  figures.open_s = seconds;
  const description = await page.evaluate(async () => (await fetch("/data/project.json")).json());
  await checkPictures(page, description);
  await checkHouse(page, description);
  const tools = { width: WIDTH, height: HEIGHT, out, expect, figures, lookAt, settled, rendered };
  await checkThings(page, truthHouses(truth)[0], tools);
  await page.setViewportSize({ width: 1024, height: 640 });
  await checkTools(page, description);
  await checkBuildings(page, description);
  await checkPhoto(page, description);
  await page.evaluate(() => window.__skyquilt.settle());
  await screenshot(page, out, "page");
  failures.push(...problems);
} catch (error) {
  failures.push(`${error.stack}`);
} finally {
  await browser.close();
}
report(failures, figures);
