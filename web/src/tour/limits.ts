// What tour.json may contain, as the server checks it too.

export const TOUR_VERSION = 1;
export const MOST_FILE_BYTES = 1 << 20;
export const MOST_STOPS = 200;
export const MOST_THINGS = 500;
export const MOST_BRANCHES = 20;
export const MOST_MEASUREMENTS = 100;
export const LONGEST_LINE = 200;
export const LONGEST_TEXT = 10_000;
export const LONGEST_URL = 2000;
export const LONGEST_PAUSE_S = 600;
export const LARGEST_COORDINATE = 1e9;
export const EXPOSURE_STOPS = { least: -10, most: 10 } as const;
export const FOVY_DEG = { least: 10, most: 120 } as const;
export const SCALE = { least: 1e-4, most: 1e4 } as const;

export const ID_PATTERN = /^[A-Za-z0-9_-]{1,40}$/;
export const PICTURE_PATTERN = /^[0-9a-f]{64}\.(?:png|jpg)$/;
export const MODEL_PATTERN = /^[0-9a-f]{64}\.glb$/;
