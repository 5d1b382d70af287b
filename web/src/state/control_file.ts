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
  parseJson,
} from "../base/check.js";
import type { ControlMark, ControlPoint } from "./app_state.js";
import { freePointName } from "./control_points.js";
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

/** What the server left out and assumed when it made the points from a gcp_list.txt; empty: nothing. */
export function listRemark(value: unknown): string {
  const { skipped, remarks } = asObject(value, "");
  const lines = skipped === 1 ? "1 line" : `${skipped} lines`;
  const left = typeof skipped === "number" ? [`${lines} had to be left out`] : [];
  return [...left, ...(Array.isArray(remarks) ? remarks : [])].join("; ");
}

/** gcp.json that the server made from a list to be added to points with the names `taken`. Throws an Error when it has no points. */
export function readLoadedPoints(
  text: string,
  project: MappedProject,
  taken: readonly string[],
): { readonly points: readonly ControlPoint[]; readonly remark: string } {
  const value = parseJson(text, "gcp.json");
  const points = readControlPoints(value, project, taken);
  const unknown = new Set(points.flatMap(({ marks }) => marks.flatMap((mark) => (mark.unknown ? [mark.photo] : []))));
  const remarks = [listRemark(value)];
  if (unknown.size > 0) {
    const examples = [...unknown].slice(0, 3).join(", ");
    remarks.push(`${unknown.size} photos are not in this project, their marks were left out: ${examples}`);
  }
  const remark = remarks.filter((text) => text !== "").join("; ");
  if (points.length === 0) throw new Error(remark || "the file has a coordinate system but no points");
  const known = points.map((point) => ({ ...point, marks: point.marks.filter((mark) => mark.unknown !== true) }));
  return { points: known, remark };
}

/** Points without a name get one that is none of `taken`. Throws CheckError. */
export function readControlPoints(
  value: unknown,
  project: MappedProject,
  taken: readonly string[] = [],
): readonly ControlPoint[] {
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
    if (name !== "" && names.has(name)) throw new CheckError(`points[${i}].name`, "another point has this name");
    names.add(name);
  });
  for (const name of taken) names.add(name);
  return points.map((point) => {
    const name = point.name === "" ? freePointName(names) : point.name;
    names.add(name);
    return { ...point, name };
  });
}

function readPoint(value: unknown, path: string): ControlPoint {
  const point = asObject(value, path);
  const name = asString(point.name, `${path}.name`, 1000);
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
