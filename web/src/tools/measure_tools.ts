// The five measuring tools.

import { newArea, newDistance, newPoint, newProfile, newVolume } from "../state/measurements.js";
import type { Accuracy } from "../state/project.js";
import { MOST_CORNERS, measureVolume, outlineProblem } from "../state/volumes.js";
import { type DraftKind, DraftTool } from "./draft_tool.js";
import type { SurfacePicker } from "./surface_picker.js";
import type { Tool } from "./tool.js";
import type { ToolContext } from "./tool_context.js";

const PROFILE_SAMPLES = 512;
const NEVER = Number.POSITIVE_INFINITY;

export function measureTools(context: ToolContext, picker: SurfacePicker): readonly Tool[] {
  const { accuracy } = context.project;
  return [pointKind(), distanceKind(accuracy), profileKind(context), areaKind(accuracy), volumeKind(context)].map(
    (kind) => new DraftTool(kind, context, picker),
  );
}

const noProblem = () => null;

function pointKind(): DraftKind {
  return {
    name: "point",
    what: "point",
    least: 1,
    full: 1,
    most: null,
    closed: false,
    problem: noProblem,
    how: { by: "itself", make: newPoint },
  };
}

function distanceKind(accuracy: Accuracy): DraftKind {
  return {
    name: "distance",
    what: "distance",
    least: 2,
    full: NEVER,
    most: 1000,
    closed: false,
    problem: noProblem,
    how: { by: "itself", make: (documents, points) => newDistance(documents, points, accuracy) },
  };
}

function areaKind(accuracy: Accuracy): DraftKind {
  return {
    name: "area",
    what: "area",
    least: 3,
    full: NEVER,
    most: 1000,
    closed: true,
    problem: (points) => outlineProblem(points),
    how: { by: "itself", make: (documents, points) => newArea(documents, points, accuracy) },
  };
}

function profileKind({ link }: ToolContext): DraftKind {
  return {
    name: "profile",
    what: "profile",
    least: 2,
    full: 2,
    most: 2,
    closed: false,
    problem: ([a, b]) =>
      a !== undefined && b !== undefined && a.enu[0] === b.enu[0] && a.enu[1] === b.enu[1]
        ? "The two points of a profile must be apart in plan: take one away with Backspace."
        : null,
    how: {
      by: "engine",
      measure: async (points) => {
        const [a, b] = points;
        if (a === undefined || b === undefined) throw new Error("a profile needs two points");
        const samples = await link.profile([a.enu[0], a.enu[1]], [b.enu[0], b.enu[1]], PROFILE_SAMPLES);
        return (documents) => newProfile(documents, points, samples);
      },
    },
  };
}

function volumeKind({ store, link, project }: ToolContext): DraftKind {
  return {
    name: "volume",
    what: "volume",
    least: 3,
    full: NEVER,
    most: MOST_CORNERS,
    closed: true,
    problem: (points) => {
      const outline = outlineProblem(points, MOST_CORNERS);
      if (outline !== null) return outline;
      const noBefore = store.get().volumeBase === "before" && project.before === null;
      return noBefore
        ? "There is no earlier survey to compare with: choose another base, or open the viewer with --compare."
        : null;
    },
    how: {
      by: "engine",
      measure: async (points) => {
        const { volumeBase, volumeBaseHeightM } = store.get();
        const result = await measureVolume(link, project.accuracy, points, volumeBase, volumeBaseHeightM);
        const height = volumeBase === "height" ? volumeBaseHeightM : null;
        return (documents) => newVolume(documents, points, volumeBase, height, result);
      },
    },
  };
}
