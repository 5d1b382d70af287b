// The survey's map coordinates: UTM (transverse Mercator, Krueger's series of order 6 as in Karney 2011, "Transverse Mercator with an accuracy of a
// few nanometers") and UPS (polar stereographic), both on WGS84 with the false origins of NGA.SIG.0012. A zone is used beyond its borders too, so
// that a survey across a border has one continuous map; to about 3,900 km from the central meridian it is exact to nanometres.
import type { Vec2, Vec3 } from "../base/vec.js";
import {
  enuFromGeodetic,
  geodeticFromEnu,
  type HasOrigin,
  WGS84_A_M,
  WGS84_E2,
  WGS84_F,
  wrapLongitudeDeg,
} from "./earth.js";

/** UTM zone 1 to 60, or 0 for UPS. */
export interface MapZone {
  readonly zone: number;
  readonly north: boolean;
}
/** A project with its place and, unless it lacks a geo-reference, its map. */
export interface HasMap extends HasOrigin {
  readonly crs: MapZone | null;
}

const RAD_PER_DEG = Math.PI / 180;
const E = Math.sqrt(WGS84_E2);
const N = WGS84_F / (2 - WGS84_F);
const UTM_SCALE = 0.9996;
const UTM_EASTING_M = 500e3;
const UTM_NORTHING_SOUTH_M = 10000e3;
const UPS_SCALE = 0.994;
const UPS_ORIGIN_M = 2000e3;

/** c[0] n^power + c[1] n^(power + 1) + ... */
function powers(power: number, c: readonly number[]): number {
  return c.reduceRight((sum, value) => sum * N + value, 0) * N ** power;
}

// Karney 2011, equations 35 and 36.
const ALPHA = [
  powers(1, [1 / 2, -2 / 3, 5 / 16, 41 / 180, -127 / 288, 7891 / 37800]),
  powers(2, [13 / 48, -3 / 5, 557 / 1440, 281 / 630, -1983433 / 1935360]),
  powers(3, [61 / 240, -103 / 140, 15061 / 26880, 167603 / 181440]),
  powers(4, [49561 / 161280, -179 / 168, 6601661 / 7257600]),
  powers(5, [34729 / 80640, -3418889 / 1995840]),
  powers(6, [212378941 / 319334400]),
];
const BETA = [
  powers(1, [1 / 2, -2 / 3, 37 / 96, -1 / 360, -81 / 512, 96199 / 604800]),
  powers(2, [1 / 48, 1 / 15, -437 / 1440, 46 / 105, -1118711 / 3870720]),
  powers(3, [17 / 480, -37 / 840, -209 / 4480, 5569 / 90720]),
  powers(4, [4397 / 161280, -11 / 504, -830251 / 7257600]),
  powers(5, [4583 / 161280, -108847 / 3991680]),
  powers(6, [20648693 / 638668800]),
];
/** Radius of the rectifying sphere. */
const RECTIFYING_M = (WGS84_A_M / (1 + N)) * (1 + N ** 2 / 4 + N ** 4 / 64 + N ** 6 / 256);
const UPS_RADIUS_M = (2 * UPS_SCALE * WGS84_A_M) / ((1 - WGS84_F) * Math.exp(E * Math.atanh(E)));

/** Tangent of the conformal latitude from that of the geodetic latitude (Karney 2011, equations 7 to 9). */
function conformalTan(tau: number): number {
  const secant = Math.hypot(1, tau);
  const sigma = Math.sinh(E * Math.atanh((E * tau) / secant));
  return Math.hypot(1, sigma) * tau - sigma * secant;
}

/** The inverse by Newton's method. */
function geodeticTan(conformal: number): number {
  let tau = conformal / (1 - WGS84_E2);
  // At the poles both are so large that their difference would drown.
  if (!(Math.abs(conformal) < 1e8)) return conformal * Math.exp(E * Math.atanh(E));
  for (let i = 0; i < 5; ++i) {
    const found = conformalTan(tau);
    const step =
      ((conformal - found) / Math.hypot(1, found)) *
      ((1 + (1 - WGS84_E2) * tau * tau) / ((1 - WGS84_E2) * Math.hypot(1, tau)));
    tau += step;
    if (!(Math.abs(step) > 1e-15 * Math.max(1, Math.abs(tau)))) break;
  }
  return tau;
}

/** zeta + sum of c[j] sin(2 (j + 1) zeta), of the complex number zeta = xi + i eta. */
function addSeries(xi: number, eta: number, c: readonly number[], sign: number): Vec2 {
  let a = xi;
  let b = eta;
  c.forEach((value, j) => {
    const k = 2 * (j + 1);
    a += sign * value * Math.sin(k * xi) * Math.cosh(k * eta);
    b += sign * value * Math.cos(k * xi) * Math.sinh(k * eta);
  });
  return [a, b];
}

function centralMeridianDeg(zone: MapZone): number {
  return 6 * zone.zone - 183;
}

function tanOfDeg(latitudeDeg: number): number {
  return Math.tan(latitudeDeg * RAD_PER_DEG);
}

/** Easting, northing in metres. */
export function mapFromGeodetic(crs: MapZone, latitudeDeg: number, longitudeDeg: number): Vec2 {
  if (crs.zone === 0) {
    const sign = crs.north ? 1 : -1;
    const conformal = conformalTan(tanOfDeg(sign * latitudeDeg));
    const large = Math.hypot(1, conformal) + Math.abs(conformal);
    const rho = UPS_RADIUS_M * (conformal >= 0 ? 1 / large : large);
    const lambda = longitudeDeg * RAD_PER_DEG;
    return [UPS_ORIGIN_M + rho * Math.sin(lambda), UPS_ORIGIN_M - sign * rho * Math.cos(lambda)];
  }
  const lambda = wrapLongitudeDeg(longitudeDeg - centralMeridianDeg(crs)) * RAD_PER_DEG;
  const conformal = conformalTan(tanOfDeg(latitudeDeg));
  const xiSphere = Math.atan2(conformal, Math.cos(lambda));
  const etaSphere = Math.asinh(Math.sin(lambda) / Math.hypot(conformal, Math.cos(lambda)));
  const [xi, eta] = addSeries(xiSphere, etaSphere, ALPHA, 1);
  const factor = UTM_SCALE * RECTIFYING_M;
  return [UTM_EASTING_M + factor * eta, (crs.north ? 0 : UTM_NORTHING_SOUTH_M) + factor * xi];
}

export function geodeticFromMap(
  crs: MapZone,
  en: Vec2,
): { readonly latitudeDeg: number; readonly longitudeDeg: number } {
  if (crs.zone === 0) {
    const sign = crs.north ? 1 : -1;
    const x = en[0] - UPS_ORIGIN_M;
    const y = en[1] - UPS_ORIGIN_M;
    const t = Math.hypot(x, y) / UPS_RADIUS_M;
    if (t === 0) return { latitudeDeg: sign * 90, longitudeDeg: 0 };
    const lat = Math.atan(geodeticTan((1 / t - t) / 2)) / RAD_PER_DEG;
    return { latitudeDeg: sign * lat, longitudeDeg: wrapLongitudeDeg(Math.atan2(x, -sign * y) / RAD_PER_DEG) };
  }
  const factor = UTM_SCALE * RECTIFYING_M;
  const xi = (en[1] - (crs.north ? 0 : UTM_NORTHING_SOUTH_M)) / factor;
  const eta = (en[0] - UTM_EASTING_M) / factor;
  const [xiSphere, etaSphere] = addSeries(xi, eta, BETA, -1);
  const sinhEta = Math.sinh(etaSphere);
  const conformal = Math.sin(xiSphere) / Math.hypot(sinhEta, Math.cos(xiSphere));
  const lambda = Math.atan2(sinhEta, Math.cos(xiSphere)) / RAD_PER_DEG;
  return {
    latitudeDeg: Math.atan(geodeticTan(conformal)) / RAD_PER_DEG,
    longitudeDeg: wrapLongitudeDeg(lambda + centralMeridianDeg(crs)),
  };
}

/** Easting, northing, ellipsoidal height in the project's CRS; null when it has none. */
export function mapFromEnu(project: HasMap, enu: Vec3): Vec3 | null {
  if (project.crs === null) return null;
  const place = geodeticFromEnu(project, enu);
  const [e, n] = mapFromGeodetic(project.crs, place.latitudeDeg, place.longitudeDeg);
  return [e, n, place.heightM];
}

/** The inverse of mapFromEnu. */
export function enuFromMap(project: HasMap, xyz: Vec3): Vec3 | null {
  if (project.crs === null) return null;
  const place = geodeticFromMap(project.crs, [xyz[0], xyz[1]]);
  return enuFromGeodetic(project, { ...place, heightM: xyz[2] });
}
