// biome-ignore-all lint/suspicious/noApproximativeNumericConstant: figures as other programs print them
// Figures of other programs to compare with.
// PLACES, LOCAL: GeographicLib 2.1.2 (Geocentric, TransverseMercator::UTM, PolarStereographic::UPS with the false origins of NGA.SIG.0012,
// LocalCartesian), which the engine uses; gdaltransform (PROJ 9.1) gives the same eastings and northings to 1e-6 m.
// ANGLES, LOOKING_AT: PoseFromAngles and PoseLookingAt of products/camera_path.cpp.
import type { Quat, Vec2, Vec3 } from "../../../src/base/vec.js";

export interface Place {
  readonly name: string;
  /** Latitude, longitude in degrees, ellipsoidal height in metres. */
  readonly place: Vec3;
  readonly zone: number;
  readonly north: boolean;
  readonly ecef: Vec3;
  readonly map: Vec2;
}
export const PLACES: readonly Place[] = [
  {
    name: "Zurich",
    place: [47.3769, 8.5417, 408],
    zone: 32,
    north: true,
    ecef: [4279227.806486, 642719.222147, 4670540.878541],
    map: [465403.284466, 5247150.839425],
  },
  {
    name: "Zurich in the next zone",
    place: [47.3769, 8.5417, 408],
    zone: 31,
    north: true,
    ecef: [4279227.806486, 642719.222147, 4670540.878541],
    map: [918284.949861, 5261956.000176],
  },
  {
    name: "Sydney",
    place: [-33.8568, 151.2153, 25.5],
    zone: 56,
    north: false,
    ecef: [-4646987.196783, 2553087.116854, -3533281.334028],
    map: [334900.569652, 6252288.752888],
  },
  {
    name: "Sydney north frame",
    place: [-33.8568, 151.2153, 25.5],
    zone: 56,
    north: true,
    ecef: [-4646987.196783, 2553087.116854, -3533281.334028],
    map: [334900.569652, -3747711.247112],
  },
  {
    name: "Fiji east of date line",
    place: [-16.8, -179.995, 120],
    zone: 1,
    north: false,
    ecef: [-6107737.828778, -533.000676, -1831690.340183],
    map: [180744.371885, 8140156.438722],
  },
  {
    name: "Fiji, zone of the other side",
    place: [-16.8, -179.995, 120],
    zone: 60,
    north: false,
    ecef: [-6107737.828778, -533.000676, -1831690.340183],
    map: [820322.408852, 8140140.279393],
  },
  {
    name: "Quito, on the equator",
    place: [0, -78.4558, 2850],
    zone: 17,
    north: true,
    ecef: [1276987.517754, -6251903.548014, 0.0],
    map: [783199.471422, 0.0],
  },
  {
    name: "Svalbard",
    place: [78.2232, 15.6267, 10],
    zone: 33,
    north: true,
    ecef: [1257701.197283, 351788.347649, 6222079.835125],
    map: [514278.715113, 8683355.469471],
  },
  {
    name: "far from the meridian",
    place: [55, 30, -50],
    zone: 32,
    north: true,
    ecef: [3175338.299139, 1833282.421776, 5201342.5656],
    map: [1832463.084653, 6298602.096512],
  },
  {
    name: "near 84 N",
    place: [83.9, 9.3, 0],
    zone: 32,
    north: true,
    ecef: [671082.609476, 109893.99176, 6320519.527617],
    map: [503559.141493, 9316939.419141],
  },
  {
    name: "Alert, UPS",
    place: [84.5, -62.3, 30],
    zone: 0,
    north: true,
    ecef: [285114.473878, -543063.047123, 6327321.085584],
    map: [1458952.462506, 1715943.692334],
  },
  {
    name: "north pole",
    place: [90, 0, 5],
    zone: 0,
    north: true,
    ecef: [0.0, 0.0, 6356757.314245],
    map: [2000000.0, 2000000.0],
  },
  {
    name: "near the north pole",
    place: [89.99999, 133, 5],
    zone: 0,
    north: true,
    ecef: [-0.761752, 0.816879, 6356757.314245],
    map: [2000000.811977, 2000000.757181],
  },
  {
    name: "McMurdo, UPS",
    place: [-77.8419, 166.6863, 24],
    zone: 0,
    north: false,
    ecef: [-1311402.912769, 310333.623009, -6213266.296135],
    map: [2311968.642715, 681687.846831],
  },
  {
    name: "near the south pole",
    place: [-89.9999, -45, 2835],
    zone: 0,
    north: false,
    ecef: [7.901456, -7.901456, -6359587.314235],
    map: [1999992.149431, 2000007.850569],
  },
  {
    name: "south pole",
    place: [-90, 0, 2835],
    zone: 0,
    north: false,
    ecef: [0.0, 0.0, -6359587.314245],
    map: [2000000.0, 2000000.0],
  },
  {
    name: "in orbit",
    place: [20, 100, 400000],
    zone: 47,
    north: true,
    ecef: [-1106436.426119, 6274912.788013, 2304504.845159],
    map: [604609.323832, 2211793.556165],
  },
];

export const LOCAL: readonly {
  readonly name: string;
  readonly origin: Vec3;
  readonly place: Vec3;
  readonly enu: Vec3;
}[] = [
  {
    name: "Zurich, a kilometre away",
    origin: [47.3769, 8.5417, 408],
    place: [47.3859, 8.5301, 500],
    enu: [-875.945733, 1000.748283, 91.861361],
  },
  {
    name: "across the date line",
    origin: [-16.8, 179.999, 10],
    place: [-16.801, -179.998, 60],
    enu: [319.795724, -110.67057, 49.991019],
  },
  {
    name: "from the south pole",
    origin: [-90, 0, 2835],
    place: [-89.995, 30, 2840],
    enu: [279.358867, 483.863751, 4.975621],
  },
  {
    name: "near the north pole",
    origin: [89.9999, 45, 0],
    place: [89.9999, -135, 0],
    enu: [0.0, 22.338796, -0.000039],
  },
  {
    name: "Sydney",
    origin: [-33.8568, 151.2153, 25.5],
    place: [-33.9, 151.2, 0],
    enu: [-1415.141394, -4791.857087, -27.463357],
  },
];

/** Yaw, pitch, roll in degrees and cam_from_enu. */
export const ANGLES: readonly { readonly angles: Vec3; readonly rotation: Quat }[] = [
  { angles: [0, 0, 0], rotation: [0.707106781186548, 0.707106781186547, 0, 0] },
  { angles: [90, 0, 0], rotation: [0.5, 0.5, -0.5, 0.5] },
  { angles: [30, -45, 0], rotation: [0.369643810614386, 0.892399100832523, -0.239117618394335, 0.0990457605412876] },
  {
    angles: [200, -90, 0],
    rotation: [5.31644212393943e-18, 0.17364817766693, 0.984807753012208, -3.01510415625475e-17],
  },
  { angles: [0, -90, 0], rotation: [3.06161699786838e-17, 1, 0, 0] },
  { angles: [310, -60, 10], rotation: [0.224143868042013, 0.907673371190369, 0.330366089549352, -0.12940952255126] },
  {
    angles: [123.4, 35, -170],
    rotation: [0.74137018398376, -0.424091342915906, -0.182642587279804, -0.486989187226378],
  },
  { angles: [0, 90, 0], rotation: [1, 3.06161699786838e-17, 0, 0] },
  {
    angles: [359, -89, 5],
    rotation: [0.00871457608476048, 0.999352773278708, -0.0348981678366046, -0.000456711579995397],
  },
];

export const LOOKING_AT: readonly { readonly eye: Vec3; readonly target: Vec3; readonly rotation: Quat }[] = [
  { eye: [0, 0, 10], target: [0, 0, 0], rotation: [3.06161699786838e-17, 1, 0, 0] },
  { eye: [0, 0, 0], target: [0, 0, 10], rotation: [1, 3.06161699786838e-17, 0, 0] },
  {
    eye: [0, 0, 10],
    target: [10, 0, 0],
    rotation: [0.270598050073099, 0.653281482438188, -0.653281482438188, 0.270598050073099],
  },
  {
    eye: [5, 6, 7],
    target: [-3, 2, 1],
    rotation: [0.247404946156148, 0.463879289112474, 0.750572456461122, -0.400309611865485],
  },
];
