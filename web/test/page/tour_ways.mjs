// The way that a page really takes from stop to stop, and how near it comes to the surface.

/** The rule of tours: this is kept from everything solid. */
const CLEARANCE_M = 1;
/** The way goes by the surface model, the check by the mesh: they are made of one field, but not of the same samples of it. */
const TOLERANCE_M = 0.15;
const LEAST_PLACES = 8;

/** Places of the eye while `act` leads to the stop of this number. */
export async function walk(page, act, index) {
  await page.emulateMedia({ reducedMotion: "no-preference" });
  await page.evaluate(() => {
    const places = [];
    window.walked = places;
    const note = () => {
      if (window.walked !== places) return;
      if (window.__skyquilt.state().play?.phase === "moving") places.push(window.__skyquilt.pose().eyeEnu);
      requestAnimationFrame(note);
    };
    note();
  });
  await act();
  await page.waitForFunction(() => window.__skyquilt.state().play.phase === "moving");
  await page.waitForFunction(
    (wanted) => {
      const { play } = window.__skyquilt.state();
      return play.progress.index === wanted && play.phase === "stop";
    },
    index,
    { timeout: 60_000 },
  );
  await page.emulateMedia({ reducedMotion: "reduce" });
  return page.evaluate(() => {
    const places = window.walked;
    window.walked = null;
    return places;
  });
}

/** Returns the distance at the nearest place. */
export function checkWay(surface, places, what, expect) {
  const nearest = Math.min(...places.map((place) => surface.distance(place)));
  expect(places.length >= LEAST_PLACES, `${what}: ${places.length} places were seen`);
  expect(nearest >= CLEARANCE_M - TOLERANCE_M, `${what}: the way comes within ${nearest} m of the surface`);
  return nearest;
}

/** Two eyes before and behind a house, free themselves, between which a straight way would go through it; null: there are none. */
export function acrossHouse(surface, place, halfWidthM) {
  for (const up of [2.5, 3.5, 5]) {
    const free = (side) => {
      for (let metres = halfWidthM + 5; metres < halfWidthM + 25; metres += 1) {
        const eye = place(side * metres, up);
        if (surface.distance(eye) > 1.5 * CLEARANCE_M) return eye;
      }
      return null;
    };
    const [before, behind] = [free(1), free(-1)];
    if (before !== null && behind !== null && surface.alongLine(before, behind) < 0.3) return [before, behind];
  }
  return null;
}
