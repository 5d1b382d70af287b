// Puts together what the files hold and what was made here without knowing of it: before they had been read, or while another window saved.
import type { Documents, Measurement } from "../state/app_state.js";
import { uniqueName } from "../state/names.js";

/** `made` minus `before` behind `loaded`; ids and names that both have get a new number. */
export function joinDocuments(loaded: Documents, before: Documents, made: Documents): Documents {
  const measurements: Measurement[] = [...loaded.measurements];
  for (const measurement of newOf(before.measurements, made.measurements)) {
    const ids = new Set(measurements.map(({ id }) => id));
    let number = measurements.length + 1;
    while (ids.has(`m${number}`)) number += 1;
    measurements.push(ids.has(measurement.id) ? { ...measurement, id: `m${number}` } : measurement);
  }
  const controlPoints = [...loaded.controlPoints];
  for (const point of newOf(before.controlPoints, made.controlPoints)) {
    controlPoints.push({
      ...point,
      name: uniqueName(
        point.name,
        controlPoints.map(({ name }) => name),
      ),
    });
  }
  const keys = newOf(before.cameraPath.keys, made.cameraPath.keys);
  const changed = made.cameraPath.speedMps !== before.cameraPath.speedMps;
  const { speedMps } = changed ? made.cameraPath : loaded.cameraPath;
  return {
    measurements: measurements.length === loaded.measurements.length ? loaded.measurements : measurements,
    controlPoints: controlPoints.length === loaded.controlPoints.length ? loaded.controlPoints : controlPoints,
    cameraPath:
      keys.length === 0 && speedMps === loaded.cameraPath.speedMps
        ? loaded.cameraPath
        : { keys: [...loaded.cameraPath.keys, ...keys], speedMps },
    // A tour is one whole: two of them are never joined (tools/tour_conflict.ts).
    tour: loaded.tour,
  };
}

function newOf<T>(before: readonly T[], made: readonly T[]): readonly T[] {
  const old = new Set(before);
  return made.filter((one) => !old.has(one));
}
