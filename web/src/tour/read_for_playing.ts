// Reads tour.json for playing: what is not known or not there is left out and named, the rest plays. Damage of a file of the known version is an error.
import { asInteger, asObject, type CheckError } from "../base/check.js";
import { leaveOutAssets } from "./leave_out.js";
import { TOUR_VERSION } from "./limits.js";
import { type Leniency, readParts, shortened } from "./read_v1.js";
import type { Stop, Thing, Tour } from "./types.js";

export interface Playable {
  readonly tour: Tour;
  /** Sentences for the visitor: what is left out and why. */
  readonly missing: readonly string[];
}

const MOST_SENTENCES = 100;

/** Throws CheckError with the path of the field. `isThere` says whether the file of an asset can be had. */
export function readTourForPlaying(value: unknown, isThere: (asset: string) => boolean = () => true): Playable {
  const root = asObject(value, "");
  const version = asInteger(root.version, "version", 1);
  const missing: string[] = [];
  if (version !== TOUR_VERSION) {
    missing.push(
      `The tour is of version ${version}, and version ${TOUR_VERSION} is known here: what is understood is shown.`,
    );
  }
  const read = readParts(root, lenient(version, missing));
  const linked = leaveOutDangling(read, missing);
  const { tour, missing: files } = leaveOutAssets(linked, isThere);
  missing.push(...files);
  return { tour, missing: bounded(missing) };
}

function lenient(version: number, missing: string[]): Leniency {
  return {
    unknownMember: (path, key) => {
      missing.push(`"${path === "" ? "" : `${path}.`}${shortened(key)}" is not known here and is left out.`);
    },
    unknownChoice: (path, _error, name) => {
      missing.push(
        `${name === "" ? "An entry" : `"${name}"`} has something that is not known here and is left out: ${path}.`,
      );
    },
    badEntry: (error: CheckError, name) => {
      if (version === TOUR_VERSION) throw error;
      missing.push(
        `${name === "" ? "An entry" : `"${name}"`} is left out, because it is not understood: ${error.message}.`,
      );
    },
  };
}

function bounded(sentences: readonly string[]): readonly string[] {
  if (sentences.length <= MOST_SENTENCES) return sentences;
  return [...sentences.slice(0, MOST_SENTENCES - 1), `And ${sentences.length - MOST_SENTENCES + 1} more.`];
}

/** Without ways to stops that are not there. */
function leaveOutDangling(tour: Tour, missing: string[]): Tour {
  const ids = new Set(tour.stops.map(({ id }) => id));
  const stops = tour.stops.map((stop): Stop => {
    const name = shortened(stop.title);
    const branches = stop.branches.filter(({ to, label }) => {
      if (ids.has(to)) return true;
      missing.push(`The way "${shortened(label)}" from the stop "${name}" is left out: there is no stop "${to}".`);
      return false;
    });
    let { next } = stop;
    if (next !== null && next.to !== null && !ids.has(next.to)) {
      missing.push(`After the stop "${name}" comes the next one of the list: there is no stop "${next.to}".`);
      next = { to: null, path: { kind: "direct" } };
    }
    return { ...stop, branches, next };
  });
  const things = tour.things.flatMap((thing): Thing[] => {
    const name = shortened(thing.kind === "model" ? thing.name : thing.text);
    const at = thing.stops?.filter((id) => ids.has(id)) ?? null;
    if (at !== null && at.length === 0 && thing.stops?.length !== 0) {
      missing.push(`The ${thing.kind} "${name}" is left out: the stops where it is shown are not there.`);
      return [];
    }
    if (thing.kind === "marker" && thing.to !== null && !ids.has(thing.to)) {
      missing.push(`The marker "${name}" leads nowhere: there is no stop "${thing.to}".`);
      return [{ ...thing, stops: at, to: null }];
    }
    return [{ ...thing, stops: at }];
  });
  let { start } = tour;
  if (start !== null && !ids.has(start)) {
    missing.push(`The tour begins at its first stop: there is no stop "${start}".`);
    start = null;
  }
  return { ...tour, start, stops, things };
}
