import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import test from "node:test";
import { assetType, LARGEST_ASSET_BYTES, uploadAsset } from "../../../src/protocol/assets_client.js";
import { readRights } from "../../../src/protocol/rights_client.js";

const PNG = [0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a];

function file(bytes: readonly number[], name: string): Blob & { readonly name: string } {
  return Object.assign(new Blob([new Uint8Array(bytes)]), { name });
}

test("a file is uploaded under the digest of its bytes and the type of its content, whatever its name says", async () => {
  const sent: { readonly url: string; readonly bytes: number }[] = [];
  const bytes = [...PNG, 1, 2, 3];
  const asset = await uploadAsset(
    file(bytes, "view.jpeg"),
    "picture",
    () => {},
    async (url, body) => {
      sent.push({ url, bytes: body.byteLength });
    },
  );
  const name = `${createHash("sha256").update(new Uint8Array(bytes)).digest("hex")}.png`;
  assert.deepEqual(asset, { file: name, name: "view.jpeg", bytes: 11 });
  assert.deepEqual(sent, [{ url: `/data/tour/assets/${name}`, bytes: 11 }]);
});

test("what is too large, empty or of another type is not sent", async () => {
  const send = () => Promise.reject(new Error("it was sent"));
  const large = { size: LARGEST_ASSET_BYTES + 1, name: "x.glb", arrayBuffer: send } as unknown as ReturnType<
    typeof file
  >;
  await assert.rejects(
    uploadAsset(large, "model", () => {}, send),
    /50\.0 MiB, and at most 50 MiB/,
  );
  await assert.rejects(
    uploadAsset(file([], "x.glb"), "model", () => {}, send),
    /empty/,
  );
  await assert.rejects(
    uploadAsset(file(PNG, "x.glb"), "model", () => {}, send),
    /not a model as GLB/,
  );
  await assert.rejects(
    uploadAsset(file([0x67, 0x6c, 0x54, 0x46], "x.png"), "picture", () => {}, send),
    /not a PNG/,
  );
  await assert.rejects(
    uploadAsset(file([0x67, 0x6c, 0x54, 0x46], "x.glb"), "model", () => {}, send),
    /it was sent/,
  );
  assert.equal(assetType(new Uint8Array([0xff, 0xd8, 0xff, 0xe0]), "picture"), "jpg");
});

test("rights are read, and what is none is an error", () => {
  assert.deepEqual(readRights({ documents: true, tour: false }), { documents: true, tour: false });
  assert.throws(() => readRights({ documents: true, tour: "yes" }), /tour: true or false expected/);
});
