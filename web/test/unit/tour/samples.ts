// A small tour with something of everything.
import type { Vec3 } from "../../../src/base/vec.js";
import { rotationFromAngles } from "../../../src/geo/camera.js";
import { readTour } from "../../../src/tour/read.js";
import type { Tour, TourPose } from "../../../src/tour/types.js";

export const PICTURE = `${"0123456789abcdef".repeat(4)}.jpg`;
export const MODEL = `${"ab".repeat(32)}.glb`;

export function pose(eyeEnu: Vec3, yawDeg = 0, pitchDeg = 0, fovyDeg = 50): TourPose {
  return { eyeEnu, rotation: rotationFromAngles({ yawDeg, pitchDeg, rollDeg: 0 }), fovyDeg };
}

function filePose(eye: Vec3, yawDeg = 0) {
  const { eyeEnu, rotation, fovyDeg } = pose(eye, yawDeg);
  return { eye_enu: [...eyeEnu], rotation: [...rotation], fovy_deg: fovyDeg };
}

/** tour.json as JSON.parse gives it; a new one each time, so that tests may damage it. */
export function sampleFile() {
  return {
    version: 1,
    title: "Dorf — деревня — 村",
    start: "b",
    stops: [
      {
        id: "a",
        title: "The gate",
        text: "First line\nsecond line <script>alert(1)</script>",
        picture: PICTURE as string | null,
        link: { label: "More", url: "https://example.org/?a=1" } as { label: string; url: string } | null,
        pose: filePose([0, 0, 10]),
        exposure_stops: 0.5 as number | null,
        layers: { points: false, surface: true } as Record<string, unknown> | null,
        measurements: ["m1", "gone"],
        pause_s: 3,
        next: { to: null, path: { kind: "direct" } } as unknown,
        branches: [{ to: "c", label: "Up the tower", path: { kind: "orbit", about: [1, 2, 3] } }],
      },
      {
        id: "b",
        title: "The square",
        text: "",
        picture: null,
        link: null,
        pose: filePose([20, 0, 10], 90),
        exposure_stops: null,
        layers: null,
        measurements: [],
        pause_s: 0,
        next: { to: "c", path: { kind: "over" } } as unknown,
        branches: [] as unknown[],
      },
      {
        id: "c",
        title: "The tower",
        text: "",
        picture: null,
        link: null,
        pose: filePose([20, 30, 40], 180),
        exposure_stops: null,
        layers: null,
        measurements: [],
        pause_s: 5,
        next: null as unknown,
        branches: [{ to: "a", label: "Back", path: { kind: "jump" } }],
      },
    ],
    things: [
      { id: "l", kind: "label", at: [1, 1, 1], text: "Oak", stops: null },
      { id: "m", kind: "marker", at: [2, 2, 2], text: "Door", to: "c", stops: ["a", "b"] },
      { id: "h", kind: "model", at: [3, 3, 3], yaw_deg: 30, scale: 2, name: "New house", asset: MODEL, stops: ["c"] },
    ] as Record<string, unknown>[],
    assets: {
      [PICTURE]: { name: "gate.jpg", bytes: 1000 },
      [MODEL]: { name: "house.glb", bytes: 2000 },
    } as Record<string, unknown>,
  };
}

export function sampleTour(): Tour {
  return readTour(sampleFile());
}
