// Words for parts of a tour.
import {
  LAYER_NAMES,
  type LayerChoice,
  type LayerName,
  type Path,
  type Stop,
  type Thing,
  type Tour,
} from "../../tour/types.js";

export const WAY_NAMES: readonly (readonly [Path["kind"], string])[] = [
  ["direct", "Straight"],
  ["orbit", "Around a point"],
  ["over", "High over all between"],
  ["jump", "Cut, without way"],
];

const LAYERS: Readonly<Record<LayerName, string>> = {
  surface: "surface",
  exact: "exact frames",
  buildings: "buildings",
  blocks: "blocks",
  cameras: "cameras",
  points: "sparse points",
  contours: "contours",
  errorMap: "held-out error",
  measurements: "measurements",
  controlPoints: "control points",
};

/** "Shows surface, exact frames." */
export function layersText(layers: LayerChoice): string {
  const on = LAYER_NAMES.filter((name) => layers[name] === true).map((name) => LAYERS[name]);
  const off = LAYER_NAMES.filter((name) => layers[name] === false).map((name) => LAYERS[name]);
  const shows = on.length === 0 ? "Shows no layer" : `Shows ${on.join(", ")}`;
  return off.length === 0 ? `${shows}.` : `${shows}; hides ${off.join(", ")}.`;
}

/** The stops to choose from, with their places in the list. */
export function stopOptions(tour: Tour, without: string | null = null): readonly (readonly [string, string])[] {
  return tour.stops.flatMap(({ id, title }, i) => (id === without ? [] : [[id, `${i + 1}. ${title}`] as const]));
}

export function thingText(thing: Thing): string {
  return thing.kind === "model" ? thing.name : thing.text;
}

/** Before the first stop of the list another one may begin. */
export function isStart(tour: Tour, stop: Stop): boolean {
  return tour.start === null ? tour.stops[0]?.id === stop.id : tour.start === stop.id;
}
