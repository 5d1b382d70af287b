// Remembers the newest view that was asked for and the newest frame that came, for the test hook.
import type { Link, ViewParameters } from "../protocol/link_api.js";
import type { CameraPose } from "../state/app_state.js";

export interface SettledFrame {
  readonly seq: number;
  readonly pass: number;
  readonly w: number;
  readonly h: number;
}

export class ViewLog {
  /** One of `parameters` and `photo` is null. */
  view: { readonly seq: number; readonly parameters: ViewParameters | null; readonly photo: number | null } | null =
    null;
  frame: (SettledFrame & { readonly passes: number }) | null = null;
  views = 0;
  frames = 0;

  /** The same link, listened to. */
  watch(link: Link): Link {
    link.onFrame((frame) => {
      this.frames += 1;
      this.frame = { seq: frame.seq, pass: frame.pass, passes: frame.passes, w: frame.width, h: frame.height };
    });
    return {
      ...link,
      view: (parameters) => {
        const seq = link.view(parameters);
        this.view = { seq, parameters, photo: null };
        this.views += 1;
        return seq;
      },
      viewPhoto: (photo, w) => {
        const seq = link.viewPhoto(photo, w);
        this.view = { seq, parameters: null, photo };
        this.views += 1;
        return seq;
      },
    };
  }
}

export function samePose(view: ViewParameters, pose: CameraPose): boolean {
  const apart = Math.hypot(...view.eyeEnu.map((value, i) => value - (pose.eyeEnu[i] ?? Number.NaN)));
  // q and -q are the same rotation.
  const turned = 1 - Math.abs(view.rotation.reduce((sum, value, i) => sum + value * (pose.rotation[i] ?? 0), 0));
  const [asked, now] = [view.orthoHeightM ?? 0, pose.orthoHeightM ?? 0];
  return apart < 1e-6 && turned < 1e-9 && Math.abs(asked - now) <= 1e-9 * Math.abs(now);
}
