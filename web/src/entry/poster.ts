// The poster of a tour lies over the view until that shows the first stop itself, or something else is wanted.
import type { Link } from "../protocol/link_api.js";
import type { Store } from "../state/store.js";

/** Longer than its style lets it fade. */
const LEAVING_MS = 400;
/** Where the picture of the stop does not come, the surface is better than the poster. */
const MOST_WAIT_MS = 4000;

/** `idle`: the surface is drawn. */
export function dropPoster(store: Store, link: Pick<Link, "onFrame">, idle: Promise<void>): void {
  const poster = document.getElementById("poster");
  if (poster === null) return;
  const ends: (() => void)[] = [];
  let left = false;
  const leave = (): void => {
    if (left) return;
    left = true;
    for (const end of ends) end();
    poster.classList.add("leaving");
    setTimeout(() => poster.remove(), LEAVING_MS);
  };
  // The frame is drawn one picture of the screen later.
  ends.push(link.onFrame(() => requestAnimationFrame(() => requestAnimationFrame(leave))));
  ends.push(store.subscribe(({ play }) => play?.phase === "stop", leave));
  void idle.then(() => setTimeout(leave, MOST_WAIT_MS));
}
