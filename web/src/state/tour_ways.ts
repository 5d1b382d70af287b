// Ways of a tour as the panel and the tools change them: the one to the next stop and those of branches alike.
import type { Vec3 } from "../base/vec.js";
import { addBranch, changeBranch, setNext } from "../tour/edit_stops.js";
import { type Path, stopOf, type Tour } from "../tour/types.js";

/** Of the stop's next (branch null) or of one of its branches; null: there is none. */
export function wayOf(tour: Tour, stop: string, branch: number | null): Path | null {
  const found = stopOf(tour, stop);
  if (found === null) return null;
  return (branch === null ? found.next?.path : found.branches[branch]?.path) ?? null;
}

export function setWay(tour: Tour, stop: string, branch: number | null, path: Path): Tour {
  if (branch !== null) return changeBranch(tour, stop, branch, { path });
  const next = stopOf(tour, stop)?.next ?? null;
  return next === null ? tour : setNext(tour, stop, { ...next, path });
}

/** The way leads around this point from now on. */
export function setCentre(tour: Tour, stop: string, branch: number | null, about: Vec3): Tour {
  return wayOf(tour, stop, branch) === null ? tour : setWay(tour, stop, branch, { kind: "orbit", about });
}

/** A branch that leads straight to this stop and is called as it is. */
export function addBranchTo(tour: Tour, stop: string, to: string): Tour {
  const label = stopOf(tour, to)?.title ?? "";
  return addBranch(tour, stop, { to, label, path: { kind: "direct" } });
}

/** A branch that was called as the stop where it led gets the name of the new one. */
export function retargetBranch(tour: Tour, stop: string, branch: number, to: string): Tour {
  const now = stopOf(tour, stop)?.branches[branch];
  const target = stopOf(tour, to);
  if (now === undefined || target === null) return tour;
  const named = now.label === stopOf(tour, now.to)?.title;
  return changeBranch(tour, stop, branch, named ? { to, label: target.title } : { to });
}
