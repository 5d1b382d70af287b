"""Reads a point cloud in Entwine Point Tiles with the data type "binary" and checks it against the specification
(entwine.io/entwine-point-tile.html). Needs only Python's standard library.

  python3 ept_checker.py FOLDER        prints what is there
"""
import collections
import json
import math
import pathlib
import struct
import sys

CODES = {("signed", 1): "b", ("signed", 2): "h", ("signed", 4): "i", ("signed", 8): "q", ("unsigned", 1): "B", ("unsigned", 2): "H",
         ("unsigned", 4): "I", ("unsigned", 8): "Q", ("float", 4): "f", ("float", 8): "d"}


class BadEpt(Exception):
    pass


def require(condition, text):
    if not condition:
        raise BadEpt(text)


class Ept:
    """points: dictionaries by the schema's names, X, Y and Z in the units of the CRS. Throws BadEpt for what breaks a rule."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.ept = json.loads((self.folder / "ept.json").read_text())
        for key in ("bounds", "boundsConforming", "dataType", "hierarchyType", "points", "schema", "span", "srs", "version"):
            require(key in self.ept, f"ept.json has no {key}")
        require(self.ept["dataType"] == "binary", f"data type {self.ept['dataType']}, not binary")
        require(self.ept["hierarchyType"] == "json", f"hierarchy type {self.ept['hierarchyType']}")
        self.low, high = self.ept["bounds"][:3], self.ept["bounds"][3:]
        self.size = high[0] - self.low[0]
        require(self.size > 0 and all(math.isclose(b - a, self.size, rel_tol=1e-9) for a, b in zip(self.low, high)), "the bounds are no cube")
        self.check_schema()
        self.nodes = self.read_hierarchy("0-0-0-0")
        self.check_hierarchy()
        self.points = []
        for key in self.nodes:
            self.points += self.read_node(key)
        self.check_points()

    def check_schema(self):
        self.schema = self.ept["schema"]
        names = [one["name"] for one in self.schema]
        require(len(set(names)) == len(names), f"dimensions named twice: {names}")
        require(all(name in names for name in "XYZ"), f"no coordinates in {names}")
        for one in self.schema:
            require((one["type"], one["size"]) in CODES, f"dimension {one}")
            if one["name"] in "XYZ":
                require(one["type"] == "float" or one.get("scale", 0) > 0, f"{one['name']} has no scale")
        self.record = struct.Struct("<" + "".join(CODES[one["type"], one["size"]] for one in self.schema))

    def read_hierarchy(self, name):
        """Points by node; a node with -1 has a file of its own."""
        found = {}
        for node, count in json.loads((self.folder / "ept-hierarchy" / f"{name}.json").read_text()).items():
            if count == -1:
                require(node != name, f"the hierarchy {name} refers to itself")
                found.update(self.read_hierarchy(node))
            else:
                require(count > 0, f"node {node} has {count} points")
                found[tuple(int(part) for part in node.split("-"))] = count
        return found

    def check_hierarchy(self):
        require((0, 0, 0, 0) in self.nodes, "no root")
        for depth, x, y, z in self.nodes:
            require(all(0 <= place < 2 ** depth for place in (x, y, z)), f"node {depth}-{x}-{y}-{z} is outside the cube")
            require(depth == 0 or (depth - 1, x // 2, y // 2, z // 2) in self.nodes, f"node {depth}-{x}-{y}-{z} has no parent")
        total = sum(self.nodes.values())
        require(total == self.ept["points"], f"{total} points in the hierarchy, {self.ept['points']} in ept.json")
        files = {path.name for path in (self.folder / "ept-data").iterdir()}
        wanted = {"-".join(map(str, key)) + ".bin" for key in self.nodes}
        require(files == wanted, f"files that are none of the nodes', or missing: {sorted(files ^ wanted)[:5]}")

    def read_node(self, key):
        name = "-".join(map(str, key))
        data = (self.folder / "ept-data" / f"{name}.bin").read_bytes()
        require(len(data) == self.nodes[key] * self.record.size, f"node {name} has {len(data)} bytes for {self.nodes[key]} points")
        depth, *place = key
        side = self.size / 2 ** depth
        points = []
        for values in self.record.iter_unpack(data):
            point = {one["name"]: value * one["scale"] + one["offset"] if "scale" in one else value for one, value in zip(self.schema, values)}
            for axis, low, cell in zip("XYZ", self.low, place):
                begin, step = low + cell * side, max(one.get("scale", 0) for one in self.schema)
                require(begin - step <= point[axis] <= begin + side + step, f"node {name} has a point at {axis} = {point[axis]}")
            points.append(point)
        return points

    def check_points(self):
        for i, axis in enumerate("XYZ"):
            low, high = min(point[axis] for point in self.points), max(point[axis] for point in self.points)
            conforming = self.ept["boundsConforming"]
            require(math.isclose(low, conforming[i], abs_tol=0.0011) and math.isclose(high, conforming[i + 3], abs_tol=0.0011),
                    f"{axis} is from {low} to {high}, boundsConforming says {conforming}")

    def counted(self):
        """How often each place, colour and class is there, in millimetres, to compare clouds."""
        return collections.Counter((round(1000 * p["X"]), round(1000 * p["Y"]), round(1000 * p["Z"]), p["Red"], p["Green"], p["Blue"],
                                    p["Classification"]) for p in self.points)


if __name__ == "__main__":
    ept = Ept(sys.argv[1])
    print(f"{len(ept.points)} points in {len(ept.nodes)} nodes down to depth {max(key[0] for key in ept.nodes)}, CRS {ept.ept['srs'].get('horizontal')}")
