// The rooms of src/ and who may use whom, the folders of panels/ among them. Imports of types count too: they are read in the source, as esbuild drops
// them. Packages are those that esbuild finds.
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import path from "node:path";
import test from "node:test";
import { build } from "esbuild";

const root = process.cwd();
const BELOW_PANELS = ["base", "geo", "tour", "state", "panels"];
const MAY_USE: Readonly<Record<string, readonly string[]>> = {
  base: [],
  geo: ["base"],
  tour: ["base", "geo"],
  state: ["base", "geo", "tour"],
  protocol: ["base", "geo", "tour", "state"],
  scene: ["base", "geo", "tour", "state", "protocol"],
  tools: ["base", "geo", "tour", "state", "protocol"],
  panels: ["base", "geo", "tour", "state"],
  "panels/widgets": BELOW_PANELS,
  "panels/layers": [...BELOW_PANELS, "panels/widgets"],
  "panels/buildings": [...BELOW_PANELS, "panels/widgets"],
  "panels/photos": [...BELOW_PANELS, "panels/widgets"],
  "panels/control": [...BELOW_PANELS, "panels/widgets", "panels/photos"],
  "panels/measure": [...BELOW_PANELS, "panels/widgets"],
  "panels/path": [...BELOW_PANELS, "panels/widgets"],
  "panels/tour": [...BELOW_PANELS, "panels/widgets"],
  "panels/play": [...BELOW_PANELS, "panels/widgets"],
  "panels/shell": [...BELOW_PANELS, "panels/*"],
  entry: ["base", "geo", "tour", "state", "protocol", "scene", "tools", "panels", "panels/*"],
};
/** What a room may know of another without using it: the types of these files. */
const MAY_NAME: Readonly<Record<string, readonly string[]>> = {
  tools: ["src/scene/scene_api.ts", "src/scene/thing.ts"],
  panels: ["src/scene/scene_api.ts", "src/protocol/link_api.ts"],
};
/** Packages and the rooms that may use them. */
const PACKAGES: Readonly<Record<string, readonly string[]>> = {
  three: ["scene"],
  "3d-tiles-renderer": ["scene"],
  react: ["panels", "entry"],
  "react-dom": ["panels", "entry"],
};

function sources(folder: string): string[] {
  return readdirSync(folder, { withFileTypes: true }).flatMap((entry) => {
    const file = path.join(folder, entry.name);
    if (entry.isDirectory()) return sources(file);
    return /\.tsx?$/.test(entry.name) && !entry.name.endsWith(".d.ts") ? [file] : [];
  });
}

const files = sources(path.join(root, "src"));
const result = await build({
  absWorkingDir: root,
  entryPoints: files,
  outdir: "unused",
  bundle: true,
  packages: "external",
  format: "esm",
  jsx: "automatic",
  metafile: true,
  write: false,
  logLevel: "silent",
});

interface Import {
  readonly from: string;
  readonly to: string;
  readonly onlyTypes: boolean;
}

/** Of one source, among `names`: all files of src/ with "/" between folders. */
function importsOf(from: string, text: string, names: ReadonlySet<string>): readonly Import[] {
  const found = text.matchAll(/^(?:import|export)\s+(type\s)?(?:[^;"]*?\sfrom\s+)?"(\.[^"]+)\.js";/gm);
  return [...found].map(([line, type, target = ""]) => {
    const to = path.posix.join(path.posix.dirname(from), target);
    const file = [`${to}.ts`, `${to}.tsx`].find((name) => names.has(name));
    assert.ok(file, `${from}: ${line}`);
    return { from, to: file, onlyTypes: type !== undefined };
  });
}

/** "panels/tour" of src/panels/tour/tour_panel.tsx; other rooms have no folders. */
function roomOf(file: string): string {
  return path.posix.dirname(file).slice("src/".length);
}

function mayUse(room: string, other: string): boolean {
  const allowed = MAY_USE[room] ?? [];
  return room === other || allowed.includes(other) || allowed.includes(`${other.split("/")[0]}/*`);
}

function mayImport({ from, to, onlyTypes }: Import): boolean {
  return mayUse(roomOf(from), roomOf(to)) || (onlyTypes && MAY_NAME[roomOf(from)]?.includes(to) === true);
}

/** What is left of a graph when nodes without arrows from or to them go, again and again: nothing, or circles and what is between them. */
function circles(arrows: readonly (readonly [from: string, to: string])[]): readonly string[] {
  let left = arrows.filter(([from, to]) => from !== to);
  for (;;) {
    const starts = new Set(left.map(([from]) => from));
    const ends = new Set(left.map(([, to]) => to));
    const fewer = left.filter(([from, to]) => starts.has(to) && ends.has(from));
    if (fewer.length === left.length) return [...new Set(left.map(([from, to]) => `${from} -> ${to}`))];
    left = fewer;
  }
}

const texts = new Map(
  files.map((file) => [path.relative(root, file).replaceAll(path.sep, "/"), readFileSync(file, "utf8")]),
);
const names = new Set(texts.keys());
const imports = [...texts].flatMap(([name, text]) => importsOf(name, text, names));

test("every folder is a room, and rooms use only the rooms below them", () => {
  assert.ok(imports.length > 500, `${imports.length} imports`);
  assert.deepEqual([...new Set([...names].map(roomOf))].sort(), Object.keys(MAY_USE).sort());
  assert.deepEqual(
    imports.filter((line) => !mayImport(line)),
    [],
  );
});

test("neither rooms nor files lead round in a circle", () => {
  assert.deepEqual(circles(imports.map(({ from, to }) => [roomOf(from), roomOf(to)])), []);
  assert.deepEqual(circles(imports.map(({ from, to }) => [from, to])), []);
});

test("what esbuild bundles was found in the sources", () => {
  const known = new Set(imports.map(({ from, to }) => `${from} -> ${to}`));
  const missed = Object.entries(result.metafile.inputs).flatMap(([file, input]) =>
    input.imports
      .filter(({ path: target, external }) => external !== true && target.startsWith("src/"))
      .map(({ path: target }) => `${file} -> ${target}`)
      .filter((arrow) => !known.has(arrow)),
  );
  assert.deepEqual(missed, []);
});

test("a planted circle and planted arrows are found", () => {
  const planted = (from: string, text: string): readonly Import[] => importsOf(from, text, names);
  const back = planted("src/state/buildings.ts", 'import type { Enu } from "./app_state.js";\n');
  assert.equal(back.length, 1);
  assert.ok(
    circles([...imports, ...back].map(({ from, to }) => [from, to])).includes(
      "src/state/buildings.ts -> src/state/app_state.ts",
    ),
  );
  const up = planted("src/panels/widgets/icons.tsx", 'import {\n  Toolbar,\n} from "../shell/toolbar.js";\n');
  assert.deepEqual(up.map(mayImport), [false]);
  const rooms = circles([...imports, ...up].map(({ from, to }) => [roomOf(from), roomOf(to)]));
  assert.ok(rooms.includes("panels/widgets -> panels/shell"));
  const forbidden = [
    ["src/geo/camera.ts", 'import type { AppState } from "../state/app_state.js";'],
    ["src/panels/context.ts", 'import { type SceneApi } from "../scene/scene_api.js";'],
    ["src/panels/context.ts", 'export * from "../scene/thing.js";'],
    ["src/panels/photos/cross.tsx", 'import { Psnr } from "../layers/block_list.js";'],
    ["src/tools/tool.ts", 'import "../panels/use_store.js";'],
  ] as const;
  for (const [from, line] of forbidden) assert.deepEqual(planted(from, `${line}\n`).map(mayImport), [false], line);
});

test("packages are used only in their rooms", () => {
  const wrong: string[] = [];
  for (const [file, input] of Object.entries(result.metafile.inputs)) {
    for (const { path: target, external } of input.imports) {
      if (external !== true) continue;
      const name = target
        .split("/")
        .slice(0, target.startsWith("@") ? 2 : 1)
        .join("/");
      if (PACKAGES[name]?.includes(file.split("/")[1] ?? "") !== true) wrong.push(`${file} uses ${target}`);
      // Its plugins bring packages that the page does not need.
      if (name === "3d-tiles-renderer" && !/^3d-tiles-renderer\/(three|core)$/.test(target)) {
        wrong.push(`${file} uses ${target}`);
      }
    }
  }
  assert.deepEqual(wrong, []);
});

test("only protocol opens connections, nothing writes HTML or runs text", () => {
  const wrong: string[] = [];
  for (const [name, text] of texts) {
    if (/\bnew WebSocket\b/.test(text) && roomOf(name) !== "protocol") wrong.push(`${name}: WebSocket`);
    if (/\b(innerHTML|outerHTML|insertAdjacentHTML|document\.write|dangerouslySetInnerHTML)\b/.test(text))
      wrong.push(`${name}: HTML`);
    if (/\beval\(|\bnew Function\b/.test(text)) wrong.push(`${name}: runs text`);
    if (/["'`]https?:\/\//.test(text.replaceAll("http://www.w3.org/", "")))
      wrong.push(`${name}: address of another host`);
  }
  assert.deepEqual(wrong, []);
});
