"""Checks a 3D Tiles 1.1 tileset with glTF tiles against the specification (OGC 22-025r4), and its place on Earth against the known formula of WGS84.
Needs only Python's standard library.

  python3 tileset_checker.py TILESET.json [GEOREFERENCE.json]
  python3 tileset_checker.py --self-test
"""
import json
import math
import pathlib
import shutil
import sys
import tempfile
import urllib.parse

import glb_reader
from glb_reader import IDENTITY, moved, multiplied

WGS84_A = 6378137.0
WGS84_F = 1.0 / 298.257223563
TILESET_KEYS = {"asset", "properties", "schema", "schemaUri", "statistics", "groups", "metadata", "geometricError", "root", "extensionsUsed",
                "extensionsRequired", "extensions", "extras"}
TILE_KEYS = {"boundingVolume", "viewerRequestVolume", "geometricError", "refine", "transform", "content", "contents", "metadata", "children",
             "extensions", "extras"}
CONTENT_KEYS = {"boundingVolume", "uri", "metadata", "group", "extensions", "extras"}
PLACE_M = 0.01  # largest difference of a place to the formula


class BadTileset(Exception):
    pass


def require(condition, text):
    if not condition:
        raise BadTileset(text)


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def ecef_from_geodetic(latitude_deg, longitude_deg, height_m):
    sin_lat, cos_lat = math.sin(math.radians(latitude_deg)), math.cos(math.radians(latitude_deg))
    sin_lon, cos_lon = math.sin(math.radians(longitude_deg)), math.cos(math.radians(longitude_deg))
    e2 = WGS84_F * (2.0 - WGS84_F)
    n = WGS84_A / math.sqrt(1.0 - e2 * sin_lat * sin_lat)
    return ((n + height_m) * cos_lat * cos_lon, (n + height_m) * cos_lat * sin_lon, (n * (1.0 - e2) + height_m) * sin_lat)


def ecef_from_enu(latitude_deg, longitude_deg, height_m):
    """The matrix from east, north, up at this origin to Earth-centred coordinates, column by column."""
    sin_lat, cos_lat = math.sin(math.radians(latitude_deg)), math.cos(math.radians(latitude_deg))
    sin_lon, cos_lon = math.sin(math.radians(longitude_deg)), math.cos(math.radians(longitude_deg))
    x, y, z = ecef_from_geodetic(latitude_deg, longitude_deg, height_m)
    return [-sin_lon, cos_lon, 0.0, 0.0, -sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat, 0.0, cos_lat * cos_lon, cos_lat * sin_lon, sin_lat, 0.0,
            x, y, z, 1.0]


def corners(box):
    return [tuple(box[axis] + i * box[3 + axis] + j * box[6 + axis] + k * box[9 + axis] for axis in range(3))
            for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]


def outside_by(box, point):
    """How far the point is outside the box along one of its axes, in metres; 0 or less: inside."""
    offset = [point[axis] - box[axis] for axis in range(3)]
    most = -math.inf
    for half in (box[3:6], box[6:9], box[9:12]):
        length = math.sqrt(dot(half, half))
        most = max(most, abs(dot(offset, half)) / length - length)
    return most


class Checker:
    """After Check: tiles (dictionaries with name, depth, leaf, triangles, error and, of the finest tiles, positions in the frame of the root)."""

    def __init__(self, file, tolerance_m=0.001):
        self.file = pathlib.Path(file)
        self.tolerance_m = tolerance_m
        self.tiles = []
        self.uris = set()
        self.root_transform = IDENTITY

    def check(self):
        tileset = json.loads(self.file.read_text(encoding="utf-8"))
        require(isinstance(tileset, dict), "the tileset is no object")
        require(set(tileset) <= TILESET_KEYS, f"unknown keys {sorted(set(tileset) - TILESET_KEYS)}")
        asset = tileset.get("asset")
        require(isinstance(asset, dict) and asset.get("version") == "1.1", f"asset.version must be \"1.1\": {asset}")
        # Not part of the specification any more, but readers still look at it.
        require(str(asset.get("gltfUpAxis", "Y")).upper() == "Y", "glTF has y up, gltfUpAxis says something else")
        for key in ("extensionsUsed", "extensionsRequired"):
            require(key not in tileset or (isinstance(tileset[key], list) and tileset[key]), f"{key} must be a list that is not empty")
        require(not tileset.get("extensionsRequired"), f"extensions are required: {tileset.get('extensionsRequired')}")
        error = tileset.get("geometricError")
        require(is_number(error) and error >= 0.0, f"geometricError is {error}")
        root = tileset.get("root")
        require(isinstance(root, dict), "root is missing")
        require("refine" in root, "the root must have refine")
        require(is_number(root.get("geometricError")) and root["geometricError"] <= error, "the root's geometricError is larger than the tileset's")
        self.root_transform = self.transform_of(root, "root")
        self.tile(root, "root", IDENTITY, None, root["geometricError"], 0, root["refine"])
        folder = self.file.parent
        strangers = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()} - self.uris - {self.file.name}
        require(not strangers, f"files that no tile uses: {sorted(strangers)[:5]}")
        require(any(tile["triangles"] for tile in self.tiles), "no tile has content")
        return self

    def transform_of(self, tile, name):
        if "transform" not in tile:
            return IDENTITY
        m = tile["transform"]
        require(isinstance(m, list) and len(m) == 16 and all(map(is_number, m)), f"{name}: transform must have 16 numbers")
        require(m[3] == m[7] == m[11] == 0 and m[15] == 1, f"{name}: the last row of the transform is not 0 0 0 1")
        x, y, z = m[0:3], m[4:7], m[8:11]
        for a, b, wanted in ((x, x, 1), (y, y, 1), (z, z, 1), (x, y, 0), (x, z, 0), (y, z, 0)):
            require(abs(dot(a, b) - wanted) < 1e-9, f"{name}: the transform is no rotation and translation")
        cross = (x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0])
        require(abs(dot(cross, z) - 1.0) < 1e-9, f"{name}: the transform mirrors")
        return [float(value) for value in m]

    @staticmethod
    def box_of(owner, name):
        volume = owner.get("boundingVolume")
        require(isinstance(volume, dict) and len(set(volume) & {"box", "region", "sphere"}) == 1, f"{name}: boundingVolume must have one volume")
        require("box" in volume, f"{name}: the volume is no box")
        box = volume["box"]
        require(isinstance(box, list) and len(box) == 12 and all(map(is_number, box)), f"{name}: box must have 12 numbers")
        halves = (box[3:6], box[6:9], box[9:12])
        lengths = [math.sqrt(dot(half, half)) for half in halves]
        require(min(lengths) > 0.0, f"{name}: half axes of {lengths} m")
        for a, b in ((0, 1), (0, 2), (1, 2)):
            require(abs(dot(halves[a], halves[b])) < 1e-6 * lengths[a] * lengths[b], f"{name}: the box's axes are not at right angles")
        return box

    def tile(self, tile, name, from_parent, parent_box, parent_error, depth, refine):
        """from_parent: the transforms from the parent tile's frame to that of the root."""
        require(isinstance(tile, dict) and set(tile) <= TILE_KEYS, f"{name}: unknown keys {sorted(set(tile) - TILE_KEYS)}")
        error = tile.get("geometricError")
        require(is_number(error) and 0.0 <= error <= parent_error, f"{name}: geometricError {error}, that of its parent is {parent_error}")
        refine = tile.get("refine", refine)
        require(refine in ("ADD", "REPLACE"), f"{name}: refine is {refine}")
        transform = self.transform_of(tile, name)
        box = self.box_of(tile, name)
        # The parent's box is in the parent's frame; the root's own transform leads out of the tileset and is compared with the place instead.
        if parent_box is not None:
            worst = max(outside_by(parent_box, moved(transform, corner)) for corner in corners(box))
            require(worst <= self.tolerance_m, f"{name}: its box reaches {worst:.4f} m out of its parent's")
        to_root = IDENTITY if parent_box is None else multiplied(from_parent, transform)
        children = tile.get("children", [])
        require("children" not in tile or (isinstance(children, list) and children), f"{name}: children must be a list that is not empty")
        require(not ("content" in tile and "contents" in tile), f"{name}: both content and contents")
        self.content(tile, name, box, to_root, depth, not children, refine)
        for number, child in enumerate(children):
            self.tile(child, f"{name}/{number}", to_root, box, error, depth + 1, refine)

    def content(self, tile, name, box, to_root, depth, leaf, refine):
        contents = tile.get("contents", [tile["content"]] if "content" in tile else [])
        require(contents or not leaf, f"{name}: a leaf without content")
        triangles, positions = 0, []
        for content in contents:
            require(isinstance(content, dict) and set(content) <= CONTENT_KEYS, f"{name}: unknown keys of the content")
            part = self.read(content, name)
            own = self.box_of(content, f"{name} content") if "boundingVolume" in content else box
            require(max(outside_by(box, corner) for corner in corners(own)) <= self.tolerance_m, f"{name}: the content's box leaves the tile's")
            local = [glb_reader.z_up(p) for p in part.positions()]
            worst = max(outside_by(own, p) for p in local)
            require(worst <= self.tolerance_m, f"{name}: {content['uri']} reaches {worst:.4f} m out of its box")
            triangles += part.triangle_count()
            positions += [moved(to_root, p) for p in local] if leaf else []
        self.tiles.append({"name": name, "depth": depth, "leaf": leaf, "triangles": triangles, "error": tile["geometricError"], "refine": refine,
                           "positions": positions})

    def read(self, content, name):
        uri = content.get("uri")
        require(isinstance(uri, str) and uri, f"{name}: content without uri")
        parts = urllib.parse.urlsplit(uri)
        absolute = parts.scheme or parts.netloc or parts.query or parts.fragment or uri.startswith("/") or "\\" in uri
        require(not absolute, f"{name}: uri {uri} is not relative")
        path = urllib.parse.unquote(parts.path)
        require(".." not in path.split("/"), f"{name}: uri {uri} leaves the folder")
        require((self.file.parent / path).is_file(), f"{name}: {uri} does not exist")
        require(path not in self.uris, f"{name}: {uri} is used twice")
        self.uris.add(path)
        try:
            return glb_reader.Glb(self.file.parent / path)
        except glb_reader.BadGlb as error:
            raise BadTileset(f"{name}: {uri}: {error}") from error

    def leaves(self):
        return [tile for tile in self.tiles if tile["leaf"]]

    def triangles(self):
        """Of the finest tiles, or of all where tiles add to their parents."""
        return sum(tile["triangles"] for tile in self.tiles if tile["leaf"] or tile["refine"] == "ADD")

    def ecef_positions(self):
        return [moved(self.root_transform, p) for tile in self.leaves() for p in tile["positions"]]


def check_place(checker, latitude_deg, longitude_deg, height_m, reach_m=500.0):
    """Compares the root's transform with the formula, at the origin and at places around it. Returns the largest difference in metres."""
    wanted = ecef_from_enu(latitude_deg, longitude_deg, height_m)
    places = [(0.0, 0.0, 0.0)] + corners([0.0] * 3 + [reach_m, 0.0, 0.0, 0.0, reach_m, 0.0, 0.0, 0.0, 100.0])
    worst = max(math.dist(moved(wanted, place), moved(checker.root_transform, place)) for place in places)
    require(worst <= PLACE_M, f"the root's transform is {worst:.3f} m from the place of the survey's origin")
    up = checker.root_transform[8:11]
    outwards = checker.root_transform[12:15]
    require(dot(up, outwards) / math.sqrt(dot(outwards, outwards)) > 0.999, "up does not point away from the Earth")
    return worst


def origin_of(georeference):
    """(latitude, longitude, height) from georeference.json or survey.json."""
    origin = georeference["origin"]
    return origin["latitude_deg"], origin["longitude_deg"], origin["height_m"] or 0.0


def self_test():
    # GPS reference points: equator and date line, a pole, and a place with published coordinates (Greenwich meridian at 45 degrees).
    for place, wanted in (((0, 0, 0), (6378137.0, 0.0, 0.0)), ((90, 0, 0), (0.0, 0.0, 6356752.3142)), ((0, 180, 10), (-6378147.0, 0.0, 0.0)),
                          ((45, 0, 0), (4517590.8788, 0.0, 4487348.4088))):
        assert math.dist(ecef_from_geodetic(*place), wanted) < 1e-3, (place, ecef_from_geodetic(*place))
    folder = pathlib.Path(tempfile.mkdtemp(prefix="skyquilt_tileset_"))
    try:
        write_example(folder)
        file = folder / "tileset.json"
        checker = Checker(file).check()
        assert checker.triangles() == 3 and len(checker.leaves()) == 2
        assert check_place(checker, *EXAMPLE_ORIGIN) < 1e-6
        whole = json.loads(file.read_text())
        root, child = whole["root"], whole["root"]["children"][0]
        broken = [("asset", {"version": "1.0"}), ("geometricError", 0.5), ("root", dict(root, refine="SWAP")), ("geometricError", None),
                  ("root", dict(root, transform=root["transform"][:15])), ("root", dict(root, transform=[-v for v in root["transform"][:15]] + [1])),
                  ("root", dict(root, children=[])), ("root", dict(root, children=[dict(child, geometricError=3.0), root["children"][1]])),
                  ("root", dict(root, children=[dict(child, content={"uri": "/" + child["content"]["uri"]}), root["children"][1]])),
                  ("root", dict(root, children=[dict(child, content={"uri": "absent.glb"}), root["children"][1]])),
                  ("root", dict(root, children=[dict(child, boundingVolume={"box": [5, 5, 5, 9, 0, 0, 0, 9, 0, 0, 0, 9]}), root["children"][1]])),
                  ("root", dict(root, children=[dict(child, boundingVolume={"box": [5, 5, 5, 1, 0, 0, 0, 1, 0, 0, 0, 1]}), root["children"][1]])),
                  ("root", dict(root, children=[dict(child, boundingVolume={"box": [5, 5, 5, 5, 0, 0, 0, 5, 0, 0, 0, 0]}), root["children"][1]])),
                  ("root", dict(root, children=[child]))]
        for key, value in broken:
            file.write_text(json.dumps({**whole, key: value}))
            try:
                Checker(file).check()
            except BadTileset:
                continue
            raise AssertionError(f"not found: {key} = {value}")
        lat, lon, height = EXAMPLE_ORIGIN
        for wrong in ((lat + 1e-6, lon, height), (lat, lon, height + 0.05), (lon, lat, height)):
            try:
                check_place(checker, *wrong)
            except BadTileset:
                continue
            raise AssertionError(f"not found: origin {wrong}")
    finally:
        shutil.rmtree(folder)
    print("tileset_checker: passed")


EXAMPLE_ORIGIN = (47.3769, 8.5417, 408.0)


def write_example(folder):
    """Two tiles below a coarse one; east 0 to 20 m, north 0 to 10 m, up 0 to 10 m."""
    def tile(name, positions, triangles, box, error, **more):
        y_up = [(x, z, -y) for x, y, z in positions]
        (folder / name).write_bytes(glb_reader.made(y_up, triangles))
        return {"boundingVolume": {"box": box}, "geometricError": error, "content": {"uri": name}, **more}

    west = tile("0_0_0.glb", [(0, 0, 0), (10, 0, 0), (10, 10, 0), (0, 10, 10)], [(0, 1, 2), (0, 2, 3)], [5, 5, 5, 5, 0, 0, 0, 5, 0, 0, 0, 5], 0.0)
    east = tile("0_1_0.glb", [(10, 0, 0), (20, 0, 0), (20, 10, 1)], [(0, 1, 2)], [15, 5, 5, 5, 0, 0, 0, 5, 0, 0, 0, 5], 0.0)
    root = tile("1_0_0.glb", [(0, 0, 0), (20, 0, 0), (20, 10, 1)], [(0, 1, 2)], [10, 5, 5, 10, 0, 0, 0, 5, 0, 0, 0, 5], 2.0, refine="REPLACE",
                transform=ecef_from_enu(*EXAMPLE_ORIGIN), children=[west, east])
    (folder / "tileset.json").write_text(json.dumps({"asset": {"version": "1.1"}, "geometricError": 4.0, "root": root}))


if __name__ == "__main__":
    if sys.argv[1:] == ["--self-test"]:
        self_test()
    else:
        of_file = Checker(sys.argv[1]).check()
        print(f"{sys.argv[1]}: {len(of_file.tiles)} tiles, {of_file.triangles()} triangles in the finest")
        if len(sys.argv) > 2:
            shift = check_place(of_file, *origin_of(json.loads(pathlib.Path(sys.argv[2]).read_text())))
            print(f"place within {shift:.6f} m")
