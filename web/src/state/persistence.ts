// The saved documents of a project: which file holds which part, how it is written and read. Pure; protocol/documents_client.ts moves the texts.
import { parseJson } from "../base/check.js";
import { readTour } from "../tour/read.js";
import { writeTour } from "../tour/write.js";
import type { Documents } from "./app_state.js";
import { readCameraPath, writeCameraPath } from "./camera_path_file.js";
import { listRemark, readControlPoints, writeControlPoints } from "./control_file.js";
import { type MeasuredProject, writeMeasurements } from "./measurements_file.js";
import { readMeasurements } from "./measurements_reader.js";

export const DOCUMENT_FILES = ["measurements.geojson", "gcp.json", "camera_path.json", "tour.json"] as const;
export type DocumentFile = (typeof DOCUMENT_FILES)[number];

const PARTS = {
  "measurements.geojson": "measurements",
  "gcp.json": "controlPoints",
  "camera_path.json": "cameraPath",
  "tour.json": "tour",
} as const;

/** The part of the documents that the file holds; another object when it has changed. */
export function documentPart(documents: Documents, file: DocumentFile): object {
  return documents[PARTS[file]];
}

/** The documents with the part of this file that others have. */
export function withDocumentPart(documents: Documents, file: DocumentFile, from: Documents): Documents {
  switch (file) {
    case "measurements.geojson":
      return { ...documents, measurements: from.measurements };
    case "gcp.json":
      return { ...documents, controlPoints: from.controlPoints };
    case "camera_path.json":
      return { ...documents, cameraPath: from.cameraPath };
    case "tour.json":
      return { ...documents, tour: from.tour };
    default:
      return file satisfies never;
  }
}

/** What the person should know about a file that could be read; empty: nothing. */
export function documentRemark(file: DocumentFile, text: string): string {
  const remark = file === "gcp.json" ? listRemark(parseJson(text, file)) : "";
  return remark === "" ? "" : `gcp_list.txt: ${remark}.`;
}

/** Throws CheckError when something in it cannot be written. */
export function writeDocument(documents: Documents, file: DocumentFile, project: MeasuredProject): string {
  switch (file) {
    case "measurements.geojson":
      return writeMeasurements(documents.measurements, project);
    case "gcp.json":
      return writeControlPoints(documents.controlPoints, project);
    case "camera_path.json":
      return writeCameraPath(documents.cameraPath);
    case "tour.json":
      return writeTour(documents.tour);
    default:
      return file satisfies never;
  }
}

/** The documents with what the file's text says. Throws CheckError that names the place in the file. */
export function readDocument(
  documents: Documents,
  file: DocumentFile,
  text: string,
  project: MeasuredProject,
): Documents {
  const value = parseJson(text, file);
  switch (file) {
    case "measurements.geojson":
      return { ...documents, measurements: readMeasurements(value, project) };
    case "gcp.json":
      return { ...documents, controlPoints: readControlPoints(value, project) };
    case "camera_path.json":
      return { ...documents, cameraPath: readCameraPath(value, project) };
    case "tour.json":
      return { ...documents, tour: readTour(value) };
    default:
      return file satisfies never;
  }
}
