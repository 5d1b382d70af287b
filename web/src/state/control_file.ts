// gcp.json: control points with their marks, in the survey's CRS or in local metres. The server writes gcp_list.txt from it.
import {
  asList,
  asNumber,
  asObject,
  asString,
  asVec2,
  CheckError,
  optionalBoolean,
  optionalString,
} from "../base/check.js";
import type { ControlMark, ControlPoint } from "./app_state.js";
import type { ProjectBase } from "./project.js";

type MappedProject = Pick<ProjectBase, "crs">;

const MOST_POINTS = 10_000;
const MOST_MARKS = 100_000;

export function writeControlPoints(points: readonly ControlPoint[], project: MappedProject): string {
  const document = {
    crs: project.crs?.name ?? null,
    points: points.map(({ name, xyz, marks }, i) => {
      if (![...xyz, ...marks.flatMap(({ pixel }) => pixel)].every(Number.isFinite)) {
        throw new CheckError(`points[${i}]`, "it has a number that is not finite");
      }
      return { name, x: xyz[0], y: xyz[1], z: xyz[2], marks: marks.map(writeMark) };
    }),
  };
  return `${JSON.stringify(document)}\n`;
}

/** The server takes marks in photos that it does not know only when they say so. */
function writeMark({ photo, pixel, unknown }: ControlMark): ControlMark {
  return unknown === true ? { photo, pixel, unknown } : { photo, pixel };
}

/** Lines of a gcp_list.txt that the server could not read, when it made the points from one. */
export function skippedLines(value: unknown): number {
  const { skipped } = asObject(value, "");
  return typeof skipped === "number" && skipped > 0 ? skipped : 0;
}

/** Throws CheckError. */
export function readControlPoints(value: unknown, project: MappedProject): readonly ControlPoint[] {
  const root = asObject(value, "");
  const crs = optionalString(root.crs, "crs");
  const own = project.crs?.name ?? null;
  if (crs !== own) {
    const named = (name: string | null) => (name === null ? "local metres" : name.slice(0, 40));
    throw new CheckError("crs", `the points are in ${named(crs)}, but the project has ${named(own)}`);
  }
  const points = asList(root.points, "points", readPoint, MOST_POINTS);
  const names = new Set<string>();
  points.forEach(({ name }, i) => {
    if (names.has(name)) throw new CheckError(`points[${i}].name`, "another point has this name");
    names.add(name);
  });
  return points;
}

function readPoint(value: unknown, path: string): ControlPoint {
  const point = asObject(value, path);
  const name = asString(point.name, `${path}.name`, 1000);
  if (name === "") throw new CheckError(`${path}.name`, "it is empty");
  return {
    name,
    xyz: [asNumber(point.x, `${path}.x`), asNumber(point.y, `${path}.y`), asNumber(point.z, `${path}.z`)],
    marks: asList(
      point.marks,
      `${path}.marks`,
      (entry, at) => {
        const mark = asObject(entry, at);
        const photo = asString(mark.photo, `${at}.photo`);
        const pixel = asVec2(mark.pixel, `${at}.pixel`);
        const unknown = optionalBoolean(mark.unknown, `${at}.unknown`) === true;
        return unknown ? { photo, pixel, unknown } : { photo, pixel };
      },
      MOST_MARKS,
    ),
  };
}
