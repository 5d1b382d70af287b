// Things that a tour places: a box behind a house is hidden by it, in the view of the mesh and in a settled exact frame, to two pixels; texts are hidden
// too, and markers are chosen by the keyboard. What must be seen is computed here from depths: of the mesh by its own picks, of the frame from the depth
// image of `skyquilt render`.
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import path from "node:path";
import { canvasPicture, save } from "./browser.mjs";
import { boxGlb, signGlb } from "./glb_files.mjs";

const FOV_DEG = 45;
/** Of 255. Magenta is far from everything in the scene. */
const DIFFERENT = 24;
const MOST_PX = 2;
export const BOX = { size: [7, 11, 4], yawDeg: 30, scale: 1.25 };

/** Distance along the ray to the box that stands at `at`; NaN: it misses. */
function boxDistance(at, origin, direction) {
  const yaw = (BOX.yawDeg * Math.PI) / 180;
  // Into the box's own axes: ahead is where the yaw points, clockwise from north.
  const ahead = [Math.sin(yaw), Math.cos(yaw)];
  const right = [Math.cos(yaw), -Math.sin(yaw)];
  const own = (v) => [v[0] * right[0] + v[1] * right[1], v[0] * ahead[0] + v[1] * ahead[1], v[2]];
  const o = own(origin.map((value, i) => value - at[i]));
  const d = own(direction);
  const [x, y, z] = BOX.size.map((value) => value * BOX.scale);
  const low = [-x / 2, -z / 2, 0];
  const high = [x / 2, z / 2, y];
  let [near, far] = [0, Number.POSITIVE_INFINITY];
  for (const i of [0, 1, 2]) {
    const [a, b] = [(low[i] - o[i]) / d[i], (high[i] - o[i]) / d[i]];
    near = Math.max(near, Math.min(a, b));
    far = Math.min(far, Math.max(a, b));
  }
  return near < far ? near : Number.NaN;
}

/** Values of a picture of depth at these pixels. */
function depthsAt(file, pixels) {
  const input = pixels.map((px) => px.join(" ")).join("\n");
  const text = execFileSync("gdallocationinfo", ["-valonly", file], { input }).toString();
  const lines = text.split("\n").slice(0, pixels.length);
  return lines.map((line) => (line.trim() === "" ? Number.NaN : Number(line)));
}

/** Pixels where the pictures differ. */
function changedPixels(a, b) {
  const changed = new Uint8Array(a.width * a.height);
  for (let i = 0; i < changed.length; i += 1) {
    for (let c = 0; c < 3; c += 1) {
      if (Math.abs(a.data[4 * i + c] - b.data[4 * i + c]) > DIFFERENT) changed[i] = 1;
    }
  }
  return changed;
}

/** The houses of the truth that can be measured, from the middle outwards. */
export function truthHouses(file) {
  // The ridge of a gable roof is as long as the house; that of a hip roof is not.
  const houses = JSON.parse(readFileSync(file, "utf8")).buildings.filter(
    (one) => one.inside_area && one.length_m > 6 && (one.roof === "gable" || one.roof === "flat"),
  );
  const at = (one) => Math.hypot(one.east_m, one.north_m);
  return houses.sort((a, b) => at(a) - at(b));
}

/** Where a house of the truth is: metres across its ridge, and up from its ground. */
export function placeAbout(house) {
  const yaw = (house.yaw_deg * Math.PI) / 180;
  const across = [-Math.sin(yaw), Math.cos(yaw)];
  const { east_m, north_m, ground_z_m } = house;
  return (metres, up) => [east_m + across[0] * metres, north_m + across[1] * metres, ground_z_m + up];
}

/** How many pixels differ from the truth, and how many of them are farther than two pixels from its edge. */
function against(truth, drawn, width, height) {
  let wrong = 0;
  let far = 0;
  for (let y = 0; y < height; y += 1) {
    for (let x = 0; x < width; x += 1) {
      const here = truth[y * width + x];
      if (drawn[y * width + x] === here) continue;
      wrong += 1;
      let edge = false;
      for (let j = Math.max(0, y - MOST_PX); j <= Math.min(height - 1, y + MOST_PX); j += 1) {
        for (let i = Math.max(0, x - MOST_PX); i <= Math.min(width - 1, x + MOST_PX); i += 1) {
          if (truth[j * width + i] !== here) edge = true;
        }
      }
      if (!edge) far += 1;
    }
  }
  return { seen: truth.reduce((sum, value) => sum + value, 0), wrong, far };
}

async function urlOf(page, bytes) {
  return page.evaluate((base64) => {
    const own = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
    return URL.createObjectURL(new Blob([own]));
  }, bytes.toString("base64"));
}

/** A textured sign before the house shows its picture's values as they are. */
async function checkSign(page, at, yawDeg, { expect, out }) {
  const color = [10, 200, 30];
  const url = await urlOf(page, signGlb(color));
  const sign = { kind: "model", id: "sign", at, yawDeg, scale: 4, name: "sign", url };
  await page.evaluate((list) => window.__skyquilt.setThings(list), [sign]);
  await page.evaluate(() => window.__skyquilt.idle());
  const picture = await canvasPicture(page);
  const px = await page.evaluate((point) => window.__skyquilt.project(point), [at[0], at[1], at[2] + 2]);
  const first = 4 * (Math.floor(px[1]) * picture.width + Math.floor(px[0]));
  const shown = [...picture.data.subarray(first, first + 3)];
  expect(
    shown.every((value, i) => Math.abs(value - color[i]) <= 1),
    `the sign is ${shown}, not ${color}`,
  );
  // The models of buildings are translucent: they must not shine over what stands before them.
  await page.evaluate(() => window.__skyquilt.setLayer("buildings", true));
  await page.waitForFunction(() => window.__skyquilt.state().buildings.set !== null);
  await page.evaluate(() => window.__skyquilt.idle());
  const models = await canvasPicture(page);
  save(models, path.join(out, "things_models.png"));
  await page.evaluate(() => window.__skyquilt.setLayer("buildings", false));
  const changed = changedPixels(picture, models);
  const count = changed.reduce((sum, value) => sum + value, 0);
  expect(count > 500, `the models of buildings change ${count} pixels`);
  expect(changed[first / 4] === 0, "a model of a building is drawn over the sign before it");
}

/** Pixels of a rectangle that holds the box. */
async function pixelsAround(page, { at, scale }, width, height) {
  const reach = (Math.hypot(BOX.size[0], BOX.size[2]) / 2) * scale;
  const corners = [-reach, reach].flatMap((x) =>
    [-reach, reach].flatMap((y) => [0, BOX.size[1] * scale].map((z) => [at[0] + x, at[1] + y, at[2] + z])),
  );
  const places = await page.evaluate((points) => points.map((point) => window.__skyquilt.project(point)), corners);
  const range = (i, size) => {
    const values = places.map((px) => px[i]);
    const low = Math.max(0, Math.floor(Math.min(...values)));
    const high = Math.min(size, Math.ceil(Math.max(...values)));
    return Array.from({ length: high - low }, (_, k) => low + k);
  };
  return range(1, height).flatMap((y) => range(0, width).map((x) => [x, y]));
}

/** Pixels of the box that stands at `at`, whatever is before it, with its distance along their rays. */
export async function pixelsInBox(page, at, width, height) {
  const pixels = await pixelsAround(page, { at, scale: BOX.scale }, width, height);
  const { eyeEnu, rays } = await page.evaluate(
    (places) => ({
      eyeEnu: window.__skyquilt.pose().eyeEnu,
      rays: places.map(([x, y]) => window.__skyquilt.rayAt([x + 0.5, y + 0.5]).direction),
    }),
    pixels,
  );
  return pixels.map((px, k) => ({ px, t: boxDistance(at, eyeEnu, rays[k]) })).filter(({ t }) => Number.isFinite(t));
}

/** Where it must be seen before a surface at these distances. */
function seenOf(inBox, distances, width, height) {
  const seen = new Uint8Array(width * height);
  for (const [k, { px, t }] of inBox.entries()) if (!(distances[k] <= t)) seen[px[1] * width + px[0]] = 1;
  return seen;
}

/** The box in a picture, beside the depth image of `skyquilt render`. */
export function boxAgainstDepth(inBox, depthFile, picture, without) {
  const { width, height } = picture;
  const depths = depthsAt(
    depthFile,
    inBox.map(({ px }) => px),
  );
  return against(seenOf(inBox, depths, width, height), changedPixels(picture, without), width, height);
}

export function expectHalfHidden(name, { seen, far }, inBox, expect) {
  expect(seen > 200 && seen < inBox.length - 200, `${name}: ${seen} of ${inBox.length} pixels of the box are seen`);
  expect(far === 0, `${name}: ${far} pixels of the box are wrong, farther than ${MOST_PX} pixels from its edge`);
}

/** `house`: of the truth; `tools`: what view_page.mjs has. */
export async function checkThings(page, house, tools) {
  const { width, height, out, expect, figures, lookAt, settled, rendered } = tools;
  const from = placeAbout(house);
  const across = [0, 1].map((i) => from(1, 0)[i] - from(0, 0)[i]);
  const at = from(-(house.width_m / 2 + 6), -0.5);
  await lookAt(page, from(38, 24), from(0, 0.6 * house.ridge_height_m), FOV_DEG);
  const url = await urlOf(page, boxGlb(BOX.size, [1, 0, 1]));
  const box = { kind: "model", id: "box", at, yawDeg: BOX.yawDeg, scale: BOX.scale, name: "box", url };
  const texts = [
    { kind: "label", id: "hidden", at: from(-(house.width_m / 2 + 1), 0.5), text: "behind <b>the house</b>" },
    { kind: "marker", id: "above", at: from(0, house.ridge_height_m + 4), text: "屋根 🏠" },
  ];
  const show = (list) => page.evaluate((things) => window.__skyquilt.setThings(things), list);
  const pictureWith = async (list, wait) => {
    await show(list);
    await wait();
    return canvasPicture(page);
  };
  const idle = () => page.evaluate(() => window.__skyquilt.idle());
  const pose = await page.evaluate(() => window.__skyquilt.pose());
  const inBox = await pixelsInBox(page, at, width, height);
  expect(inBox.length > 500, `the box has ${inBox.length} pixels`);
  const seenBefore = (distances) => seenOf(inBox, distances, width, height);

  await page.evaluate(() => window.__skyquilt.setLayer("exact", false));
  await checkSign(page, from(12, 8), (Math.atan2(across[0], across[1]) * 180) / Math.PI, tools);
  const meshWith = await pictureWith([box], idle);
  save(meshWith, path.join(out, "things_mesh.png"));
  const top = await page.evaluate((point) => window.__skyquilt.project(point), [at[0], at[1], at[2] + 12]);
  const picks = await page.evaluate((px) => [window.__skyquilt.thingAt(px), window.__skyquilt.placeAt(px)], top);
  const picked = picks[1] === null ? Number.NaN : Math.hypot(...picks[1].enu.map((value, i) => value - at[i]));
  expect(picks[0] === "box" && picked < 15, `under the box's upper part are ${JSON.stringify(picks)}`);
  const meshWithout = await pictureWith([], idle);
  const distances = await page.evaluate(
    (places) => window.__skyquilt.meshDistances(places),
    inBox.map(({ px }) => [px[0] + 0.5, px[1] + 0.5]),
  );
  figures.things_mesh = against(seenBefore(distances), changedPixels(meshWith, meshWithout), width, height);

  // Without the surface, so that nothing but the frame can hide the box.
  await page.evaluate(() => window.__skyquilt.setLayer("surface", false));
  await page.evaluate(() => window.__skyquilt.setLayer("exact", true));
  const frameWith = await pictureWith([box, ...texts], () => settled(page));
  save(frameWith, path.join(out, "things_exact.png"));
  const visible = await page.evaluate(() => window.__skyquilt.visibleTexts());
  expect(visible.join() === "above", `seen are the texts ${visible}`);
  const marker = page.getByRole("button", { name: texts[1].text });
  await marker.focus();
  await page.keyboard.press("Enter");
  const chosen = await page.evaluate(() => window.__skyquilt.chosenThings());
  expect(chosen.at(-1) === "above", `chosen is ${chosen}`);
  const frameWithout = await pictureWith([], () => settled(page));
  await page.evaluate(() => window.__skyquilt.setLayer("surface", true));
  const reference = rendered(pose, "things");
  figures.things_exact = boxAgainstDepth(inBox, reference.depth, frameWith, frameWithout);
  expectHalfHidden("mesh", figures.things_mesh, inBox, expect);
  expectHalfHidden("exact", figures.things_exact, inBox, expect);
}
