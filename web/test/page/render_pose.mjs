// `skyquilt render` from a pose of the page, to compare with.
import { execFileSync } from "node:child_process";
import { writeFileSync } from "node:fs";
import path from "node:path";

/** The files of picture and depth that `skyquilt render` makes of this pose. */
export function renderPose(context, pose, name) {
  return renderPoses(context, [{ pose, name }], name).get(name);
}

/** The same of several poses at once, by their names, in this folder below `out`. */
export function renderPoses({ program, project, out, width, height }, views, folder, exposure = "normal") {
  const file = path.join(out, `${folder}.json`);
  writeFileSync(file, JSON.stringify(views.map(({ pose, name }) => ({ ...viewOf(pose, width, height), name }))));
  const size = ["--set", `products.video_width=${width}`, "--set", `products.video_height=${height}`];
  const how = ["--width", String(width), "--exposure", exposure, "-o", out, ...size];
  execFileSync(program, ["render", path.join(project, "scene.h5"), "--path", file, ...how], { stdio: "pipe" });
  const made = (name) => path.join(out, folder, name);
  return new Map(views.map(({ name }) => [name, { png: made(`${name}.png`), depth: made(`${name}_depth.tiff`) }]));
}

function viewOf(pose, width, height) {
  const forward = rotateBack(pose.rotation, [0, 0, 1]);
  const yaw = (Math.atan2(forward[0], forward[1]) * 180) / Math.PI;
  const pitch = (Math.asin(Math.max(-1, Math.min(1, forward[2]))) * 180) / Math.PI;
  const half = Math.tan((pose.fovyDeg * Math.PI) / 360);
  const fov = (2 * Math.atan((half * width) / height) * 180) / Math.PI;
  return { position_enu: pose.eyeEnu, yaw, pitch, roll: 0, fov };
}

/** v turned by the inverse of q. */
export function rotateBack([w, x, y, z], v) {
  const q = [w, -x, -y, -z];
  const t = [2 * (q[2] * v[2] - q[3] * v[1]), 2 * (q[3] * v[0] - q[1] * v[2]), 2 * (q[1] * v[1] - q[2] * v[0])];
  return [
    v[0] + q[0] * t[0] + (q[2] * t[2] - q[3] * t[1]),
    v[1] + q[0] * t[1] + (q[3] * t[0] - q[1] * t[2]),
    v[2] + q[0] * t[2] + (q[1] * t[1] - q[2] * t[0]),
  ];
}
