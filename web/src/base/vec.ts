// Plain vectors and quaternions in double precision. The frame is in the name of the type or variable, never implied.

export type Vec2 = readonly [number, number];
export type Vec3 = readonly [number, number, number];
/** w, x, y, z; length 1. */
export type Quat = readonly [number, number, number, number];
