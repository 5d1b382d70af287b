// Writes tour.json. The order of members is always the same and assets are sorted, so that equal tours are equal files.
import { CheckError } from "../base/check.js";
import { MOST_FILE_BYTES, TOUR_VERSION } from "./limits.js";
import { readTour } from "./read.js";
import { utf8Bytes } from "./text_rules.js";
import { LAYER_NAMES, type LayerChoice, type Next, type Stop, type Thing, type Tour } from "./types.js";

/** Throws CheckError when it is no tour that could be read again, or longer than the server takes. */
export function writeTour(tour: Tour): string {
  const document = {
    version: TOUR_VERSION,
    title: tour.title,
    start: tour.start,
    stops: tour.stops.map(writeStop),
    things: tour.things.map(writeThing),
    assets: Object.fromEntries(
      [...tour.assets.keys()].sort().map((file) => {
        const { name, bytes } = tour.assets.get(file) ?? { name: "", bytes: 0 };
        return [file, { name, bytes }];
      }),
    ),
  };
  readTour(document);
  const text = `${JSON.stringify(document)}\n`;
  const bytes = utf8Bytes(text);
  if (bytes > MOST_FILE_BYTES) {
    throw new CheckError(
      "tour.json",
      `it would have ${bytes} bytes, and 1 MiB is allowed: shorten texts or remove stops`,
    );
  }
  return text;
}

function writeStop(stop: Stop) {
  return {
    id: stop.id,
    title: stop.title,
    text: stop.text,
    picture: stop.picture,
    link: stop.link === null ? null : { label: stop.link.label, url: stop.link.url },
    pose: { eye_enu: stop.pose.eyeEnu, rotation: stop.pose.rotation, fovy_deg: stop.pose.fovyDeg },
    exposure_stops: stop.exposureStops,
    layers: stop.layers === null ? null : writeLayers(stop.layers),
    measurements: stop.measurements,
    pause_s: stop.pauseS,
    next: stop.next === null ? null : { to: stop.next.to, path: writePath(stop.next.path) },
    branches: stop.branches.map(({ to, label, path }) => ({ to, label, path: writePath(path) })),
  };
}

function writeLayers(layers: LayerChoice) {
  return Object.fromEntries(
    LAYER_NAMES.filter((name) => layers[name] !== undefined).map((name) => [name, layers[name]]),
  );
}

function writePath(path: Next["path"]) {
  return path.kind === "orbit" ? { kind: path.kind, about: path.about } : { kind: path.kind };
}

function writeThing(thing: Thing) {
  const { id, kind, at, stops } = thing;
  switch (kind) {
    case "label":
      return { id, kind, at, text: thing.text, stops };
    case "marker":
      return { id, kind, at, text: thing.text, to: thing.to, stops };
    case "model":
      return {
        id,
        kind,
        at,
        yaw_deg: thing.yawDeg,
        scale: thing.scale,
        name: thing.name,
        asset: thing.asset,
        stops,
      };
    default:
      return kind satisfies never;
  }
}
