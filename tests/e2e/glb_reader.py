"""Reads binary glTF 2.0 files: the JSON, accessors, and the triangles of the scene. From the specification (Khronos glTF 2.0, sections 3 and 4);
needs only Python's standard library. Compressed geometry and sparse accessors are refused, as the surface has none.

  python3 glb_reader.py FILE.glb     prints what is in the file
  python3 glb_reader.py --self-test
"""
import json
import math
import struct
import sys

COMPONENTS = {5120: ("b", 1, 127.0), 5121: ("B", 1, 255.0), 5122: ("h", 2, 32767.0), 5123: ("H", 2, 65535.0), 5125: ("I", 4, 1.0),
              5126: ("f", 4, 1.0)}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
UNDERSTOOD = {"KHR_mesh_quantization", "KHR_materials_unlit", "KHR_texture_transform"}
JSON_CHUNK, BINARY_CHUNK = 0x4E4F534A, 0x004E4942
TRIANGLES = 4
IDENTITY = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]  # column by column, as glTF and 3D Tiles store matrices


class BadGlb(Exception):
    pass


def require(condition, text):
    if not condition:
        raise BadGlb(text)


def multiplied(a, b):
    """a * b of 4x4 matrices, column by column."""
    return [sum(a[4 * k + row] * b[4 * column + k] for k in range(4)) for column in range(4) for row in range(4)]


def moved(m, p):
    """A point under an affine matrix."""
    return (m[0] * p[0] + m[4] * p[1] + m[8] * p[2] + m[12], m[1] * p[0] + m[5] * p[1] + m[9] * p[2] + m[13],
            m[2] * p[0] + m[6] * p[1] + m[10] * p[2] + m[14])


def z_up(p):
    """From glTF's frame (y up) to that of a tile (z up)."""
    return (p[0], -p[2], p[1])


def matrix_of(node):
    if "matrix" in node:
        require(len(node["matrix"]) == 16, "a node's matrix has not 16 numbers")
        return [float(value) for value in node["matrix"]]
    x, y, z, w = node.get("rotation", (0.0, 0.0, 0.0, 1.0))
    require(abs(math.hypot(x, y, z, w) - 1.0) < 1e-5, "a node's rotation has not length 1")
    sx, sy, sz = node.get("scale", (1.0, 1.0, 1.0))
    tx, ty, tz = node.get("translation", (0.0, 0.0, 0.0))
    return [(1 - 2 * (y * y + z * z)) * sx, 2 * (x * y + z * w) * sx, 2 * (x * z - y * w) * sx, 0.0,
            2 * (x * y - z * w) * sy, (1 - 2 * (x * x + z * z)) * sy, 2 * (y * z + x * w) * sy, 0.0,
            2 * (x * z + y * w) * sz, 2 * (y * z - x * w) * sz, (1 - 2 * (x * x + y * y)) * sz, 0.0, tx, ty, tz, 1.0]


class Part:
    """The triangles of one primitive. positions: in the frame of the scene, y up."""

    def __init__(self, positions, triangles, uvs, normals, image):
        self.positions = positions
        self.triangles = triangles
        self.uvs = uvs
        self.normals = normals
        self.image = image  # bytes of the file of the base colour; empty: none


class Glb:
    """Throws BadGlb for a file that breaks the rules that it depends on."""

    def __init__(self, file):
        content = file if isinstance(file, bytes) else open(file, "rb").read()
        require(len(content) >= 20, f"only {len(content)} bytes")
        magic, version, length = struct.unpack_from("<4sII", content)
        require(magic == b"glTF", f"starts with {magic}, not with glTF")
        require(version == 2, f"version {version}, not 2")
        require(length == len(content), f"the head says {length} bytes, the file has {len(content)}")
        chunks = []
        at = 12
        while at < length:
            require(at + 8 <= length, "a chunk is cut off")
            size, kind = struct.unpack_from("<II", content, at)
            require(size % 4 == 0 and at + 8 + size <= length, f"a chunk of {size} bytes at {at}")
            chunks.append((kind, content[at + 8:at + 8 + size]))
            at += 8 + size
        require(chunks and chunks[0][0] == JSON_CHUNK, "the first chunk is not JSON")
        require(len(chunks) < 2 or chunks[1][0] == BINARY_CHUNK, "the second chunk is not binary")
        self.document = json.loads(chunks[0][1].decode("utf-8"))
        self.binary = chunks[1][1] if len(chunks) > 1 else b""
        require(self.document.get("asset", {}).get("version") == "2.0", "asset.version is not 2.0")
        required, used = set(self.document.get("extensionsRequired", [])), set(self.document.get("extensionsUsed", []))
        require(required <= used, "an extension is required but not used")
        require(required <= UNDERSTOOD, f"unknown extensions are required: {sorted(required - UNDERSTOOD)}")

    def view(self, index):
        view = self.document["bufferViews"][index]
        require(view["buffer"] == 0 and "uri" not in self.document["buffers"][0], "a buffer outside the file")
        start = view.get("byteOffset", 0)
        require(start + view["byteLength"] <= len(self.binary), f"buffer view {index} ends after the file")
        return view, self.binary[start:start + view["byteLength"]]

    def accessor(self, index):
        """The values: numbers for SCALAR, else tuples. Normalised integers become floats."""
        accessor = self.document["accessors"][index]
        require("sparse" not in accessor and "bufferView" in accessor, f"accessor {index} is sparse or without data")
        letter, size, largest = COMPONENTS[accessor["componentType"]]
        width = WIDTHS[accessor["type"]]
        view, data = self.view(accessor["bufferView"])
        packed = size * width
        stride = view.get("byteStride", packed)
        require(stride >= packed, f"accessor {index} has a stride of {stride} bytes")
        start, count = accessor.get("byteOffset", 0), accessor["count"]
        require(count > 0 and start + stride * (count - 1) + packed <= len(data), f"accessor {index} ends after its buffer view")
        data = data[start:start + stride * (count - 1) + packed] + bytes(stride - packed)
        values = list(struct.iter_unpack(f"<{width}{letter}{stride - packed}x", data))
        if accessor.get("normalized"):
            values = [tuple(max(v / largest, -1.0) for v in value) for value in values]
        if letter == "f":
            require(all(math.isfinite(v) for value in values for v in value), f"accessor {index} has a value that is not finite")
        self.check_range(index, accessor, values)
        return [value[0] for value in values] if width == 1 else values

    @staticmethod
    def check_range(index, accessor, values):
        if "min" not in accessor or "max" not in accessor or accessor.get("normalized"):
            return
        for axis, column in enumerate(zip(*values)):
            low, high = accessor["min"][axis], accessor["max"][axis]
            slack = 1e-6 * max(1.0, abs(low), abs(high))
            require(abs(min(column) - low) <= slack and abs(max(column) - high) <= slack,
                    f"accessor {index}: axis {axis} is {min(column)} to {max(column)}, but min and max say {low} to {high}")

    def nodes(self):
        """(node, its matrix in the scene) of all nodes of the default scene."""
        scenes = self.document.get("scenes", [])
        open_nodes = [(index, IDENTITY) for index in scenes[self.document.get("scene", 0)].get("nodes", [])] if scenes else []
        while open_nodes:
            index, parent = open_nodes.pop(0)
            node = self.document["nodes"][index]
            matrix = multiplied(parent, matrix_of(node))
            open_nodes += [(child, matrix) for child in node.get("children", [])]
            yield node, matrix

    def image_of(self, primitive):
        if "material" not in primitive:
            return b""
        colour = self.document["materials"][primitive["material"]].get("pbrMetallicRoughness", {}).get("baseColorTexture")
        if colour is None:
            return b""
        image = self.document["images"][self.document["textures"][colour["index"]]["source"]]
        require("bufferView" in image, "an image outside the file")
        data = self.view(image["bufferView"])[1]
        starts = {"image/jpeg": b"\xff\xd8\xff", "image/png": b"\x89PNG"}
        require(data.startswith(starts[image["mimeType"]]), f"an image is no {image['mimeType']}")
        return data

    def parts(self):
        found = []
        for node, matrix in self.nodes():
            if "mesh" not in node:
                continue
            for primitive in self.document["meshes"][node["mesh"]]["primitives"]:
                require(primitive.get("mode", TRIANGLES) == TRIANGLES, "a primitive is not made of triangles")
                attributes = primitive["attributes"]
                require("POSITION" in attributes, "a primitive without positions")
                position = self.document["accessors"][attributes["POSITION"]]
                require("min" in position and "max" in position, "positions without min and max")
                positions = [moved(matrix, p) for p in self.accessor(attributes["POSITION"])]
                corners = self.accessor(primitive["indices"]) if "indices" in primitive else list(range(len(positions)))
                require(len(corners) % 3 == 0 and max(corners) < len(positions), "indices of triangles that are not there")
                for name, accessor in attributes.items():
                    require(self.document["accessors"][accessor]["count"] == len(positions), f"{name} has another length than POSITION")
                uvs = self.accessor(attributes["TEXCOORD_0"]) if "TEXCOORD_0" in attributes else []
                normals = self.accessor(attributes["NORMAL"]) if "NORMAL" in attributes else []
                found.append(Part(positions, list(zip(corners[0::3], corners[1::3], corners[2::3])), uvs, normals, self.image_of(primitive)))
        return found

    def triangle_count(self):
        return sum(len(part.triangles) for part in self.parts())

    def positions(self):
        return [position for part in self.parts() for position in part.positions]


def made(positions, triangles, translation=(0.0, 0.0, 0.0)):
    """A small file with these triangles, for self-tests."""
    flat = [value for triangle in triangles for value in triangle]
    data = struct.pack(f"<{3 * len(positions)}f", *(v for p in positions for v in p)) + struct.pack(f"<{len(flat)}H", *flat)
    data += bytes(-len(data) % 4)
    single = [struct.unpack("<3f", struct.pack("<3f", *p)) for p in positions]
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "translation": list(translation)}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}], "buffers": [{"byteLength": len(data)}],
        "bufferViews": [{"buffer": 0, "byteLength": 12 * len(positions), "target": 34962},
                        {"buffer": 0, "byteOffset": 12 * len(positions), "byteLength": 2 * len(flat), "target": 34963}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(positions), "type": "VEC3", "min": [min(c) for c in zip(*single)],
                       "max": [max(c) for c in zip(*single)]},
                      {"bufferView": 1, "componentType": 5123, "count": len(flat), "type": "SCALAR"}]}
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    return (struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(data)) + struct.pack("<II", len(text), JSON_CHUNK) + text +
            struct.pack("<II", len(data), BINARY_CHUNK) + data)


def refused(content):
    try:
        Glb(content).parts()
    except (BadGlb, KeyError, IndexError, struct.error):
        return True
    return False


def self_test():
    file = made([(0, 0, 0), (1, 0, 0), (0, 2, 0), (0, 0, 3)], [(0, 1, 2), (0, 3, 1)], translation=(10, 20, 30))
    glb = Glb(file)
    assert glb.triangle_count() == 2
    assert glb.positions() == [(10, 20, 30), (11, 20, 30), (10, 22, 30), (10, 20, 33)], glb.positions()
    assert z_up((1, 2, 3)) == (1, -3, 2)
    assert refused(file[:-4]) and refused(b"glTF" + file[4:8] * 2 + file[12:]) and refused(b"x" + file[1:])
    assert refused(made([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 7)]))
    wrong = bytearray(file)
    wrong[-4 - 12 - 12:-12 - 12] = struct.pack("<f", 9.0)  # a vertex outside min and max
    assert refused(bytes(wrong))
    half_turn = matrix_of({"rotation": [0.0, 0.0, 1.0, 0.0], "translation": [5.0, 0.0, 0.0], "scale": [2.0, 2.0, 2.0]})
    assert all(abs(a - b) < 1e-12 for a, b in zip(moved(half_turn, (1.0, 1.0, 1.0)), (3.0, -2.0, 2.0)))
    print("glb_reader: passed")


if __name__ == "__main__":
    if sys.argv[1:] == ["--self-test"]:
        self_test()
    else:
        for name in sys.argv[1:]:
            of_file = Glb(name).parts()
            print(f"{name}: {len(of_file)} parts, {sum(len(part.triangles) for part in of_file)} triangles")
