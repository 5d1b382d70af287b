// WGS84: geodetic coordinates (degrees, metres above the ellipsoid), ECEF (metres) and the survey's ENU (metres: x east, y north, z up at the
// project's origin). Matrices are homogeneous, 16 numbers row by row.
import type { Vec3 } from "../base/vec.js";
import { sub, transformPoint } from "../base/vec_math.js";

export interface Geodetic {
  readonly latitudeDeg: number;
  /** [-180, 180). */
  readonly longitudeDeg: number;
  /** Above the ellipsoid. */
  readonly heightM: number;
}
/** A project, of which only the place counts here. */
export interface HasOrigin {
  readonly origin: Geodetic;
}

export const WGS84_A_M = 6378137;
export const WGS84_F = 1 / 298.257223563;
const B_M = WGS84_A_M * (1 - WGS84_F);
export const WGS84_E2 = WGS84_F * (2 - WGS84_F);
const SECOND_E2 = WGS84_E2 / (1 - WGS84_E2);
const RAD_PER_DEG = Math.PI / 180;

/** To [-180, 180). */
export function wrapLongitudeDeg(longitudeDeg: number): number {
  const turned = longitudeDeg - 360 * Math.floor((longitudeDeg + 180) / 360);
  return turned >= 180 ? -180 : turned;
}

export function ecefFromGeodetic(latitudeDeg: number, longitudeDeg: number, heightM: number): Vec3 {
  const sinLat = Math.sin(latitudeDeg * RAD_PER_DEG);
  // Exactly 0 at the poles, so that they have one place whatever the longitude.
  const cosLat = Math.abs(latitudeDeg) === 90 ? 0 : Math.cos(latitudeDeg * RAD_PER_DEG);
  const n = WGS84_A_M / Math.sqrt(1 - WGS84_E2 * sinLat * sinLat);
  const across = (n + heightM) * cosLat;
  return [
    across * Math.cos(longitudeDeg * RAD_PER_DEG),
    across * Math.sin(longitudeDeg * RAD_PER_DEG),
    ((1 - WGS84_E2) * n + heightM) * sinLat,
  ];
}

/** Bowring's iteration; exact to rounding from 1,000 km below the ellipsoid outwards, also at the poles. */
export function geodeticFromEcef(ecef: Vec3): Geodetic {
  const [x, y, z] = ecef;
  const p = Math.hypot(x, y);
  let reduced = Math.atan2(WGS84_A_M * z, B_M * p);
  let lat = 0;
  for (let i = 0; i < 5; ++i) {
    const s = Math.sin(reduced);
    const c = Math.cos(reduced);
    lat = Math.atan2(z + SECOND_E2 * B_M * s * s * s, p - WGS84_E2 * WGS84_A_M * c * c * c);
    reduced = Math.atan2((1 - WGS84_F) * Math.sin(lat), Math.cos(lat));
  }
  const sinLat = Math.sin(lat);
  return {
    latitudeDeg: lat / RAD_PER_DEG,
    longitudeDeg: wrapLongitudeDeg(p === 0 ? 0 : Math.atan2(y, x) / RAD_PER_DEG),
    // Well conditioned everywhere, unlike p / cos(lat) - n.
    heightM: p * Math.cos(lat) + z * sinLat - WGS84_A_M * Math.sqrt(1 - WGS84_E2 * sinLat * sinLat),
  };
}

/** Unit vectors east, north, up of a place in ECEF. */
function axes(origin: Geodetic): readonly [Vec3, Vec3, Vec3] {
  const lat = origin.latitudeDeg * RAD_PER_DEG;
  const lon = origin.longitudeDeg * RAD_PER_DEG;
  const sinLat = Math.sin(lat);
  const cosLat = Math.abs(origin.latitudeDeg) === 90 ? 0 : Math.cos(lat);
  const sinLon = Math.sin(lon);
  const cosLon = Math.cos(lon);
  return [
    [-sinLon, cosLon, 0],
    [-sinLat * cosLon, -sinLat * sinLon, cosLat],
    [cosLat * cosLon, cosLat * sinLon, sinLat],
  ];
}

export function ecefFromEnuMatrix(origin: Geodetic): number[] {
  const [e, n, u] = axes(origin);
  const t = ecefFromGeodetic(origin.latitudeDeg, origin.longitudeDeg, origin.heightM);
  return [e[0], n[0], u[0], t[0], e[1], n[1], u[1], t[1], e[2], n[2], u[2], t[2], 0, 0, 0, 1];
}

export function enuFromEcefMatrix(origin: Geodetic): number[] {
  const t = ecefFromGeodetic(origin.latitudeDeg, origin.longitudeDeg, origin.heightM);
  const rows = axes(origin).map((a) => [a[0], a[1], a[2], -(a[0] * t[0] + a[1] * t[1] + a[2] * t[2])]);
  return [...rows.flat(), 0, 0, 0, 1];
}

export function geodeticFromEnu(project: HasOrigin, enu: Vec3): Geodetic {
  return geodeticFromEcef(transformPoint(ecefFromEnuMatrix(project.origin), enu));
}

export function enuFromGeodetic(project: HasOrigin, place: Geodetic): Vec3 {
  const { origin } = project;
  const ecef = ecefFromGeodetic(place.latitudeDeg, place.longitudeDeg, place.heightM);
  // Subtracted first: metres near the origin then keep all their digits.
  const d = sub(ecef, ecefFromGeodetic(origin.latitudeDeg, origin.longitudeDeg, origin.heightM));
  const [e, n, u] = axes(origin);
  return [
    e[0] * d[0] + e[1] * d[1] + e[2] * d[2],
    n[0] * d[0] + n[1] * d[1] + n[2] * d[2],
    u[0] * d[0] + u[1] * d[1] + u[2] * d[2],
  ];
}
