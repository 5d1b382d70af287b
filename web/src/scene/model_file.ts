// From the bytes of a GLB to a model. Nothing is fetched, not even from blob URLs, so that it also works in a page that was opened as a file.
import {
  ClampToEdgeWrapping,
  LinearFilter,
  LinearMipmapLinearFilter,
  MirroredRepeatWrapping,
  NearestFilter,
  RepeatWrapping,
  Texture,
} from "three";
import { GLTFLoader, type GLTFLoaderPlugin } from "three/addons/loaders/GLTFLoader.js";
import { asArray, asObject } from "../base/check.js";
import type { Vec2 } from "../base/vec.js";
import { type GlbDocument, readGlb } from "./glb_document.js";
import { imageSize } from "./image_size.js";
import type { Model, PlannedModel } from "./model.js";
import { dressModel } from "./model_look.js";

const LONGEST_TEXTURE_PX = 4096;
const LONGEST_PICTURE_PX = 16_384;
const MOST_PICTURE_PIXELS = 8192 * 8192;
/** Decoded once for the processor, from which a lost graphics card gets it again, and once with its smaller levels for the graphics card. */
const BYTES_PER_PIXEL = 4 + (4 * 4) / 3;
const NEAREST = 9728;
const WRAPPINGS: Readonly<Record<number, Texture["wrapS"]>> = {
  33071: ClampToEdgeWrapping,
  33648: MirroredRepeatWrapping,
  10497: RepeatWrapping,
};

/** `software`: the processor draws, so textures have no smaller levels. Throws an Error for the user. */
export function readModel(bytes: ArrayBuffer, software: boolean): PlannedModel {
  const document = readGlb(bytes);
  const sizes = document.pictures.map((picture, i) => {
    const size = imageSize(picture);
    if (size === null) throw new Error(`its picture ${i + 1} is neither PNG, JPEG nor WebP`);
    if (
      size[0] < 1 ||
      size[1] < 1 ||
      Math.max(...size) > LONGEST_PICTURE_PX ||
      size[0] * size[1] > MOST_PICTURE_PIXELS
    ) {
      throw new Error(`its picture ${i + 1} has ${size[0]} x ${size[1]} pixels`);
    }
    return shrunk(size);
  });
  const pixels = sizes.reduce((sum, [w, h]) => sum + w * h, 0);
  return {
    // Geometry too is held twice.
    bytes: 2 * document.geometryBytes + Math.ceil(BYTES_PER_PIXEL * pixels),
    make: () => makeModel(document, sizes, software),
  };
}

function shrunk(size: Vec2): Vec2 {
  const factor = Math.min(1, LONGEST_TEXTURE_PX / Math.max(...size));
  return [Math.max(1, Math.round(size[0] * factor)), Math.max(1, Math.round(size[1] * factor))];
}

async function makeModel(document: GlbDocument, sizes: readonly Vec2[], software: boolean): Promise<Model> {
  const bitmaps: ImageBitmap[] = [];
  const close = () => {
    for (const bitmap of bitmaps) bitmap.close();
  };
  try {
    const loader = new GLTFLoader();
    loader.register(() => partsOf(document, sizes, software, bitmaps));
    const { scene } = await loader.parseAsync(JSON.stringify(document.json), "");
    const model = dressModel(scene);
    return {
      ...model,
      dispose: () => {
        model.dispose();
        close();
      },
    };
  } catch (error) {
    close();
    throw error;
  }
}

/** Gives the loader what it would otherwise fetch. */
function partsOf(
  { json, binary, pictures }: GlbDocument,
  sizes: readonly Vec2[],
  software: boolean,
  bitmaps: ImageBitmap[],
): GLTFLoaderPlugin {
  const views = asArray(json.bufferViews ?? [], "bufferViews").map((view) => asObject(view, "bufferViews"));
  const textures = asArray(json.textures ?? [], "textures").map((texture) => asObject(texture, "textures"));
  const samplers = asArray(json.samplers ?? [], "samplers").map((sampler) => asObject(sampler, "samplers"));
  const load = async (index: number): Promise<Texture> => {
    const [picture, size] = [pictures[index], sizes[index]];
    if (picture === undefined || size === undefined) throw new Error(`it has no texture ${index}`);
    const bitmap = await decode(picture, size, index);
    bitmaps.push(bitmap);
    const sampler = samplers[Number(textures[index]?.sampler ?? -1)] ?? {};
    const texture = new Texture(bitmap);
    texture.flipY = false;
    texture.wrapS = WRAPPINGS[Number(sampler.wrapS)] ?? RepeatWrapping;
    texture.wrapT = WRAPPINGS[Number(sampler.wrapT)] ?? RepeatWrapping;
    texture.magFilter = sampler.magFilter === NEAREST ? NearestFilter : LinearFilter;
    texture.generateMipmaps = !software;
    texture.minFilter = software ? LinearFilter : LinearMipmapLinearFilter;
    texture.anisotropy = software ? 1 : 4;
    texture.needsUpdate = true;
    return texture;
  };
  const loaded = new Map<number, Promise<Texture>>();
  return {
    name: "skyquilt_parts",
    loadBufferView: (index) => {
      const view = views[index];
      if (view === undefined) return Promise.reject(new Error(`it has no part ${index}`));
      const at = Number(view.byteOffset);
      return Promise.resolve(binary.slice(at, at + Number(view.byteLength)).buffer);
    },
    loadTexture: (index) => {
      const known = loaded.get(index) ?? load(index);
      loaded.set(index, known);
      return known;
    },
  };
}

async function decode(picture: Uint8Array<ArrayBuffer>, [w, h]: Vec2, index: number): Promise<ImageBitmap> {
  const options: ImageBitmapOptions = { colorSpaceConversion: "none", premultiplyAlpha: "none" };
  try {
    const size = imageSize(picture);
    const smaller = size !== null && (size[0] !== w || size[1] !== h);
    return await createImageBitmap(
      new Blob([picture]),
      smaller ? { ...options, resizeWidth: w, resizeHeight: h, resizeQuality: "medium" } : options,
    );
  } catch {
    throw new Error(`its picture ${index + 1} cannot be decoded`);
  }
}
