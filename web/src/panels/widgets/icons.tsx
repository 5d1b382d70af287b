// The icons: outlines on a grid of 24, drawn in the colour of the text around them.
import type { ReactElement } from "react";

const PATHS = {
  navigate: "M4 3l7 17 2.2-7.3L20.5 10.5z",
  point: "M12 21s-6.5-6-6.5-11a6.5 6.5 0 0 1 13 0c0 5-6.5 11-6.5 11zM12 12.3a2.3 2.3 0 1 0 0-4.6 2.3 2.3 0 0 0 0 4.6z",
  distance: "M3.5 15.5l12-12 5 5-12 12zM7 12l2 2M10 9l2.5 2.5M13 6l2 2",
  profile: "M3 4v16h18M6 16l4-6 3 3 3-6 4 5",
  area: "M5 7l8-3 7 7-4 9-11-2zM5 7h.01M13 4h.01M20 11h.01M16 20h.01M5 18h.01",
  volume: "M12 3l8 4.5v9L12 21l-8-4.5v-9zM4 7.5l8 4.5 8-4.5M12 12v9",
  buildings: "M3 20.5V10l6-4.5 6 4.5v10.5zM15 12h6v8.5h-6M7 20.5v-5h4v5M18 15.5v1.5",
  photos: "M4 7h4l1.5-2.5h5L16 7h4v12H4zM12 16.5a3.700 3.700 0 1 0 0-7.4 3.700 3.700 0 0 0 0 7.4z",
  control: "M12 3v5M12 16v5M3 12h5M16 12h5M12 16a4 4 0 1 0 0-8 4 4 0 0 0 0 8zM12 12h.01",
  layers: "M12 3.5l9 5-9 5-9-5zM3 12.5l9 5 9-5M3 16.5l9 5 9-5",
  measure: "M3.5 15.5l12-12 5 5-12 12zM7 12l2 2M10 9l2.5 2.5M13 6l2 2",
  path: "M5 19c5 0 2-9 7-9s2-5 7-5M5 21.2a2.2 2.2 0 1 0 0-4.4 2.2 2.2 0 0 0 0 4.4zM19 7.2a2.2 2.2 0 1 0 0-4.4 2.2 2.2 0 0 0 0 4.4z",
  tour: "M6 21V4M6 4.5h11l-2.500 4 2.500 4H6M3.5 21h5",
  thing: "M4 7.500h9l6 4.500-6 4.500H4zM8 12h.01",
  label: "M4 7.500h9l6 4.500-6 4.500H4zM8 12h.01",
  play: "M8 5l11 7-11 7z",
  pause: "M9 5v14M15 5v14",
  list: "M8.5 6H20M8.5 12H20M8.5 18H20M4 6h.01M4 12h.01M4 18h.01",
  map: "M9 4L3.5 6.500v13L9 17l6 3 5.500-2.500v-13L15 7zM9 4v13M15 7v13",
  about: "M12 21a9 9 0 1 0 0-18 9 9 0 0 0 0 18zM12 11v5.5M12 7.5h.01",
  help: "M12 21a9 9 0 1 0 0-18 9 9 0 0 0 0 18zM9.3 9.2a2.800 2.800 0 1 1 4 2.6c-.9.4-1.3 1-1.3 2M12 17h.01",
  undo: "M9 14L4 9l5-5M4 9h9.5a6 6 0 0 1 0 12H8",
  redo: "M15 14l5-5-5-5M20 9h-9.5a6 6 0 0 0 0 12H16",
  close: "M6 6l12 12M18 6L6 18",
  previous: "M15 5l-7 7 7 7",
  next: "M9 5l7 7-7 7",
  home: "M4 9V4h5M20 9V4h-5M4 15v5h5M20 15v5h-5M9 9h6v6H9z",
  picture: "M4 5h16v14H4zM4 16l5-5 4 4 2.5-2.5L20 17M15.5 9.5h.01",
  screen: "M8 4H4v4M16 4h4v4M8 20H4v-4M16 20h4v-4",
  add: "M12 5v14M5 12h14",
  remove: "M5 7h14M10 7V4h4v3M7 7l1 13h8l1-13M10.5 11v5M13.5 11v5",
  open: "M3 6h6l2 2.5h10V19H3z",
  copy: "M9 9h11v11H9zM15 9V4H4v11h5",
  check: "M5 12.5l4.5 4.5L19 7.5",
  warning: "M12 4l9.5 16h-19zM12 10v4.5M12 17.5h.01",
  lost: "M3 3l18 18M5 12.5a10 10 0 0 1 4-2.4M14 9.700a10 10 0 0 1 5 2.800M8.5 16a5 5 0 0 1 6 -.6M12 19.5h.01",
  focus: "M12 3v3M12 18v3M3 12h3M18 12h3M12 17a5 5 0 1 0 0-10 5 5 0 0 0 0 10z",
  search: "M10.5 17a6.5 6.5 0 1 0 0-13 6.5 6.5 0 0 0 0 13zM15.5 15.5L21 21",
  split: "M12 3v18M8 8l-4 4 4 4M16 8l4 4-4 4",
} as const;

export type IconName = keyof typeof PATHS;

export function Icon({ name, size = 20 }: { readonly name: IconName; readonly size?: number }): ReactElement {
  return (
    <svg
      className="icon"
      width={size}
      height={size}
      viewBox="0 0 24 24"
      fill="none"
      stroke="currentColor"
      strokeWidth={1.7}
      strokeLinecap="round"
      strokeLinejoin="round"
      aria-hidden="true"
      focusable="false"
    >
      <path d={PATHS[name]} />
    </svg>
  );
}
