// The rooms of src/ and who may use whom, from what esbuild finds imported (types do not count: they are gone in the page).
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import path from "node:path";
import test from "node:test";
import { build } from "esbuild";

const root = process.cwd();
const MAY_USE: Readonly<Record<string, readonly string[]>> = {
  base: [],
  geo: ["base"],
  tour: ["base", "geo"],
  state: ["base", "geo", "tour"],
  protocol: ["base", "geo", "tour", "state"],
  scene: ["base", "geo", "tour", "state", "protocol"],
  tools: ["base", "geo", "tour", "state", "protocol"],
  panels: ["base", "geo", "tour", "state"],
  entry: ["base", "geo", "tour", "state", "protocol", "scene", "tools", "panels"],
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

function roomOf(file: string): string {
  return file.split("/")[1] ?? "";
}

test("rooms use only the rooms below them", () => {
  const wrong: string[] = [];
  for (const [file, input] of Object.entries(result.metafile.inputs)) {
    const room = roomOf(file);
    const allowed = MAY_USE[room];
    assert.ok(allowed, `${file}: src/${room} is not a known room`);
    for (const { path: target, external } of input.imports) {
      if (external === true || !target.startsWith("src/")) continue;
      if (roomOf(target) !== room && !allowed.includes(roomOf(target))) wrong.push(`${file} uses ${target}`);
    }
  }
  assert.deepEqual(wrong, []);
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
      if (PACKAGES[name]?.includes(roomOf(file)) !== true) wrong.push(`${file} uses ${target}`);
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
  for (const file of files) {
    const name = path.relative(root, file).replaceAll(path.sep, "/");
    const text = readFileSync(file, "utf8");
    if (/\bnew WebSocket\b/.test(text) && roomOf(name) !== "protocol") wrong.push(`${name}: WebSocket`);
    if (/\b(innerHTML|outerHTML|insertAdjacentHTML|document\.write|dangerouslySetInnerHTML)\b/.test(text))
      wrong.push(`${name}: HTML`);
    if (/\beval\(|\bnew Function\b/.test(text)) wrong.push(`${name}: runs text`);
    if (/["'`]https?:\/\//.test(text.replaceAll("http://www.w3.org/", "")))
      wrong.push(`${name}: address of another host`);
  }
  assert.deepEqual(wrong, []);
});
