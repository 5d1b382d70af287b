// An exported tour as it lies in its folder: what is needed before anything can be shown, and the other files when they are wanted.
import { AbortError, errorText } from "../base/abort.js";
import { parseJson } from "../base/check.js";
import { readBuildings } from "../protocol/buildings_reader.js";
import { type Bytes, packedName } from "../protocol/packed_files.js";
import { readProject } from "../protocol/project_reader.js";
import { readTourManifest, type TourManifest } from "../protocol/tour_manifest.js";
import type { LoadBytes } from "../scene/load_bytes.js";
import type { Measurement } from "../state/app_state.js";
import type { BuildingSet } from "../state/buildings.js";
import { readMeasurements } from "../state/measurements_reader.js";
import type { Project } from "../state/project.js";
import { readTourForPlaying } from "../tour/read_for_playing.js";
import type { Tour } from "../tour/types.js";

export interface Files {
  load(name: string): Promise<Bytes>;
  release(name: string): void;
}

export interface ExportedTour {
  readonly project: Project;
  readonly tour: Tour;
  readonly measurements: readonly Measurement[];
  readonly pictures: TourManifest["stops"];
  /** What is not there, as sentences. */
  readonly missing: readonly string[];
}

/** Rejects with an Error for the user. */
export async function readExportedTour(files: Files): Promise<ExportedTour> {
  const [project, manifest, playable] = await Promise.all([
    readJson(files, "project.json", readProject),
    readJson(files, "manifest.json", readTourManifest),
    // Asked for together, though the manifest says which pictures and models there are.
    readJson(files, "tour.json", (value) => value),
  ]);
  const { files: names, stops } = manifest;
  const there = (name: string): boolean => names === null || names.has(name);
  const { tour, missing } = within("tour.json", () =>
    readTourForPlaying(playable, (asset) => there(`assets/${asset}`)),
  );
  // An export that names its files has said what is missing, too.
  const sentences = names === null ? [...manifest.missing, ...missing] : [...manifest.missing];
  let measurements: readonly Measurement[] = [];
  const name = "measurements.geojson";
  if (showsMeasurements(tour) && there(name)) {
    try {
      measurements = await readJson(files, name, (value) => readMeasurements(value, project));
    } catch (error) {
      sentences.push(`The measurements are not shown: ${errorText(error)}.`);
    }
  }
  // There is no scene to render from, but its pictures.
  const scene = stops.size > 0 ? { blocks: 0, parameters: 0, trust: false } : null;
  return { project: { ...project, scene }, tour, measurements, pictures: stops, missing: sentences };
}

function showsMeasurements({ stops }: Tour): boolean {
  return stops.some(({ measurements, layers }) => measurements.length > 0 || layers?.measurements === true);
}

async function readJson<T>(files: Files, name: string, read: (value: unknown) => T): Promise<T> {
  const bytes = await files.load(name);
  files.release(name);
  return within(name, () => read(parseJson(new TextDecoder().decode(bytes), "the file")));
}

function within<T>(name: string, read: () => T): T {
  try {
    return read();
  } catch (error) {
    throw new Error(`data/${name}.js is damaged, ${errorText(error)}: export the tour again`);
  }
}

/** For the scene, which knows its files by the addresses of the viewer's server. */
export function bytesOf(files: Files): LoadBytes {
  return async (url, signal) => {
    const name = packedName(url);
    if (name === null) throw new Error(`${url} is not in the folder of the tour`);
    const bytes = await files.load(name);
    // Whoever asked has them now.
    files.release(name);
    if (signal.aborted) throw new AbortError();
    return bytes.buffer;
  };
}

export function buildingsOf(files: Files): (url: string) => Promise<BuildingSet> {
  return (url) => readJson(files, packedName(url) ?? "buildings/buildings.json", readBuildings);
}
