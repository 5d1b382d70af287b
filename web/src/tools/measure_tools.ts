// The five measuring tools.
import { levelAtOutlineM } from "../geo/heights.js";
import type { SurfacePoint, Survey } from "../state/app_state.js";
import { newArea, newDistance, newPoint, newProfile, newVolume } from "../state/measurements.js";
import type { Accuracy, Project } from "../state/project.js";
import { MOST_CORNERS, measureVolume, outlineProblem } from "../state/volumes.js";
import { type DraftKind, DraftTool } from "./draft_tool.js";
import type { SurfacePicker } from "./surface_picker.js";
import type { Tool } from "./tool.js";
import type { ToolContext } from "./tool_context.js";

const PROFILE_SAMPLES = 512;
const NEVER = Number.POSITIVE_INFINITY;

export function measureTools(context: ToolContext, picker: SurfacePicker): readonly Tool[] {
  const { project } = context;
  return [
    pointKind(),
    distanceKind(project),
    profileKind(context, picker),
    areaKind(project.accuracy),
    volumeKind(context, picker),
  ].map((kind) => new DraftTool(kind, context, picker));
}

/** Throws an Error for the user when there is no one answer. */
function surveyOf(picker: SurfacePicker, points: readonly SurfacePoint[]): Survey {
  const survey = picker.surveyOf(points);
  if (survey === null) throw new Error("the points lie on both sides of the line between the two surveys");
  return survey;
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

function distanceKind(project: Project): DraftKind {
  return {
    name: "distance",
    what: "distance",
    least: 2,
    full: NEVER,
    most: 1000,
    closed: false,
    problem: noProblem,
    how: { by: "itself", make: (documents, points) => newDistance(documents, points, project) },
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

function profileKind({ link, project }: ToolContext, picker: SurfacePicker): DraftKind {
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
        const survey = surveyOf(picker, points);
        const samples = await link.profile([a.enu[0], a.enu[1]], [b.enu[0], b.enu[1]], PROFILE_SAMPLES, survey);
        return (documents) => newProfile(documents, points, samples, project, survey);
      },
    },
  };
}

function volumeKind({ store, link, project }: ToolContext, picker: SurfacePicker): DraftKind {
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
        // Over the earlier survey it is always the present surface that is measured.
        const survey = volumeBase === "before" ? (picker.surveyOf(points) ?? "main") : surveyOf(picker, points);
        const height = volumeBase === "height" ? levelAtOutlineM(project, points, volumeBaseHeightM) : null;
        const result = await measureVolume(link, project, points, volumeBase, height ?? 0, survey);
        return (documents) => newVolume(documents, points, volumeBase, height, result, survey);
      },
    },
  };
}
