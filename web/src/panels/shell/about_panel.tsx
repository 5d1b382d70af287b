// What the project is and how far its numbers can be trusted.
import { Fragment, type ReactElement } from "react";
import { formatArea, formatLength, shortVertical } from "../../geo/format.js";
import type { Accuracy, Project } from "../../state/project.js";
import { useApp, useStore } from "../use_store.js";

declare const SKYQUILT_VERSION: string | undefined;

type Row = readonly [name: string, value: string];

export function AboutPanel(): ReactElement {
  const { project } = useApp();
  const engine = useStore((state) => state.engine);
  const version = typeof SKYQUILT_VERSION === "undefined" ? "" : ` ${SKYQUILT_VERSION}`;
  return (
    <>
      <section>
        <h3>{project.name}</h3>
        <Rows rows={projectRows(project)} />
      </section>
      <section>
        <h3>Accuracy (one standard deviation)</h3>
        <Rows rows={accuracyRows(project)} />
        {project.georeferenced || project.accuracy.scalePercent !== null ? null : (
          <p className="hint">
            Without geo-reference lengths have no known scale: give the photos positions, control points or a scale bar.
          </p>
        )}
      </section>
      {project.metrics === null ? null : (
        <section>
          <h3>Held-out photos</h3>
          <Rows rows={metricRows(project.metrics)} />
        </section>
      )}
      <section>
        <h3>Engine</h3>
        <Rows
          rows={[
            ["State", engine.connected ? (engine.ready ? "ready" : engine.reason || "not ready") : "not connected"],
            ["Exposure", engine.exposure === "" ? "–" : engine.exposure],
            ["Ranks", String(engine.ranks)],
            ["Open pages", String(engine.clients)],
          ]}
        />
      </section>
      <p className="hint">
        Skyquilt{version} viewer.{" "}
        <a href="/licences.txt" target="_blank" rel="noreferrer">
          Licences
        </a>{" "}
        of what it is made of.
      </p>
    </>
  );
}

function Rows({ rows }: { readonly rows: readonly Row[] }): ReactElement {
  return (
    <dl className="facts">
      {rows.map(([name, value]) => (
        <Fragment key={name}>
          <dt>{name}</dt>
          <dd>{value}</dd>
        </Fragment>
      ))}
    </dl>
  );
}

function projectRows(project: Project): readonly Row[] {
  const heldOut = project.photos.filter((photo) => photo.isTest).length;
  return [
    ["Photos", `${project.photos.length.toLocaleString("en")}, ${heldOut.toLocaleString("en")} held out`],
    ["Blocks", project.scene === null ? "no field yet" : project.scene.blocks.toLocaleString("en")],
    ["Parameters", project.scene === null ? "–" : project.scene.parameters.toLocaleString("en")],
    ["Ground sampling", `${(project.gsdM * 100).toFixed(1)} cm`],
    ["Extent", `${formatLength(project.max[0] - project.min[0])} × ${formatLength(project.max[1] - project.min[1])}`],
    [
      "Surface",
      project.surface === null
        ? "none"
        : `${project.surface.triangles.toLocaleString("en")} triangles, ${formatArea(project.surface.areaM2)}`,
    ],
    ["Coordinates", project.crs === null ? "local metres" : project.crs.name],
    ["Heights above", shortVertical(project.vertical)],
  ];
}

function accuracyRows({ accuracy }: { readonly accuracy: Accuracy }): readonly Row[] {
  const value = (number: number | null, unit: string, digits: number): string =>
    number === null ? "unknown" : `${number.toFixed(digits)} ${unit}`;
  return [
    ["Horizontal position", value(accuracy.horizontalM, "m", 3)],
    ["Height", value(accuracy.verticalM, "m", 3)],
    ["Scale", value(accuracy.scalePercent, "%", 3)],
    ["Tilt", value(accuracy.tiltDeg, "°", 3)],
    ["Heading", value(accuracy.yawDeg, "°", 3)],
  ];
}

const METRICS: readonly (readonly [key: string, name: string, unit: string, digits: number])[] = [
  ["psnr", "PSNR", " dB", 2],
  ["ssim", "SSIM", "", 4],
  ["flip", "FLIP", "", 4],
  ["lpips", "LPIPS", "", 4],
  ["coverage", "Coverage", "", 3],
];

function metricRows(metrics: Readonly<Record<string, number | null>>): readonly Row[] {
  const rows: Row[] = [];
  for (const [key, name, unit, digits] of METRICS) {
    const value = metrics[key];
    if (value !== null && value !== undefined) rows.push([name, `${value.toFixed(digits)}${unit}`]);
  }
  return rows;
}
