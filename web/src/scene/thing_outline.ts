// The edges of a model's box: how the selected model and the one under the pointer are marked. Where something hides them they are fainter, so that a model
// behind a house is found.
import { BufferAttribute, BufferGeometry, GreaterDepth, Group, LineBasicMaterial, LineSegments } from "three";
import { boxEdges } from "./line_shapes.js";
import type { Box } from "./world.js";

const COLOURS = { selected: 0x4ad8ff, hovered: 0xffffff } as const;
const HIDDEN_OPACITY = 0.35;

export interface Outline {
  readonly object: Group;
  dispose(): void;
}

/** In the axes of the box. */
export function outlineOf(box: Box, colour: keyof typeof COLOURS): Outline {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(Float32Array.from(boxEdges(box, [0, 0, 0])), 3));
  const common = { color: COLOURS[colour], toneMapped: false, depthWrite: false } as const;
  const seen = new LineBasicMaterial(common);
  const hidden = new LineBasicMaterial({
    ...common,
    transparent: true,
    opacity: HIDDEN_OPACITY,
    depthFunc: GreaterDepth,
  });
  const object = new Group();
  object.add(new LineSegments(geometry, seen), new LineSegments(geometry, hidden));
  return {
    object,
    dispose: () => {
      object.removeFromParent();
      geometry.dispose();
      seen.dispose();
      hidden.dispose();
    },
  };
}
