"""The files of a project's folder `buildings`, read by several programs and compared with each other."""
import csv
import io
import json
import math
import re

import glb_reader
import las_reader
from foreign_readers import Nearest, output, transformed
from harness import expect

MEASURES = ("ground", "eave", "ridge", "height", "length", "width", "yaw_deg", "area", "volume", "roof_area", "pitch_deg")
UNITS = {"area": "_m2", "roof_area": "_m2", "volume": "_m3", "yaw_deg": "", "pitch_deg": ""}
IN_JSON = {"area": "footprint_m2", "roof_area": "roof_m2", "volume": "volume_m3", "yaw_deg": "yaw_deg", "pitch_deg": "pitch_deg"}
FILES = ("buildings.csv", "buildings.city.json", "buildings.gpkg", "buildings.glb", "buildings.dxf", "buildings.json")
SURFACE_OF = {"ground": "GroundSurface", "wall": "WallSurface", "roof": "RoofSurface"}
ROOF, WALL, EDGE, CORNER = 6, 64, 65, 66  # classes of cloud.las
ON_MAP = 0.002  # relative difference of areas: scale of UTM, and heights above the ellipsoid
SAME_M = 0.002
IN_GLB_M = 0.01  # numbers of single precision
AROUND_M = 1.5  # from a footprint to points of its roof, which has an overhang, and of walls


def columns(metric):
    names = ["id", "longitude", "latitude", "easting", "northing"]
    for measure in MEASURES:
        name = measure + (UNITS.get(measure, "_m") if metric else "" if not measure.endswith("_deg") else "")
        names += [name, name + "_sigma"]
    return names + ["wall_seen", "roof", "accepted", "note"]


def ring_area(ring):
    (x0, y0), total = ring[0][:2], 0.0
    for a, b in zip(ring, ring[1:] + ring[:1]):
        total += 0.5 * ((a[0] - x0) * (b[1] - y0) - (b[0] - x0) * (a[1] - y0))
    return total


def polygon_area(rings):
    return abs(ring_area(rings[0])) - sum(abs(ring_area(ring)) for ring in rings[1:])


def area_vector(rings):
    """Newell's normals of all rings of a face, holes turning the other way; as long as its area."""
    total = [0.0, 0.0, 0.0]
    for ring in rings:
        origin = ring[0]
        edges = [tuple(value - start for value, start in zip(point, origin)) for point in ring]
        for a, b in zip(edges, edges[1:] + edges[:1]):
            total[0] += 0.5 * (a[1] * b[2] - a[2] * b[1])
            total[1] += 0.5 * (a[2] * b[0] - a[0] * b[2])
            total[2] += 0.5 * (a[0] * b[1] - a[1] * b[0])
    return total


def volume(faces):
    """Of a closed shell of plane faces that turn to the outside, by Gauss's theorem."""
    apex = faces[0][0][0]
    return sum(sum(n * (p - a) for n, p, a in zip(area_vector(face), face[0][0], apex)) for face in faces) / 3.0


def distance_to_ring(ring, point):
    best = math.inf
    for (ax, ay), (bx, by) in zip([p[:2] for p in ring], [p[:2] for p in ring[1:] + ring[:1]]):
        dx, dy = bx - ax, by - ay
        along = max(0.0, min(1.0, ((point[0] - ax) * dx + (point[1] - ay) * dy) / (dx * dx + dy * dy)))
        best = min(best, math.dist(point[:2], (ax + along * dx, ay + along * dy)))
    return best


def is_inside(ring, point):
    x, y = point[:2]
    inside = False
    for (ax, ay), (bx, by) in zip([p[:2] for p in ring], [p[:2] for p in ring[1:] + ring[:1]]):
        if (ay > y) != (by > y) and x < ax + (y - ay) / (by - ay) * (bx - ax):
            inside = not inside
    return inside


def features(file, layer):
    """Of one layer as GDAL reads it: (fields, coordinates)."""
    read = json.loads(output("ogr2ogr", "-f", "GeoJSON", "/vsistdout/", file, layer))
    return [(one["properties"], one["geometry"]["coordinates"] if one["geometry"] else []) for one in read["features"]]


def open_ring(ring):
    """GIS repeat the first point at the end."""
    expect(ring[0] == ring[-1], f"a ring is not closed: {ring}")
    return [tuple(point) for point in ring[:-1]]


class BuildingFiles:
    def __init__(self, project, metric=True):
        self.folder = project / "buildings"
        self.project = project
        self.metric = metric
        for name in FILES:
            expect((self.folder / name).is_file(), f"{name} is missing")
        text = (self.folder / "buildings.csv").read_bytes().decode("utf-8")
        expect(text.endswith("\r\n"), "lines of buildings.csv do not end with CR LF")
        lines = list(csv.reader(io.StringIO(text, newline="")))
        self.names = lines[0]
        self.rows = [dict(zip(self.names, line)) for line in lines[1:]]
        self.json = json.loads((self.folder / "buildings.json").read_text())
        self.city = json.loads((self.folder / "buildings.city.json").read_text())
        self.table = json.loads((project / "surface" / "surface.json").read_text())
        self.georeference = json.loads((project / "surface" / "georeference.json").read_text())
        self.scale, self.translate = self.city["transform"]["scale"], self.city["transform"]["translate"]

    def measure(self, row, name):
        text = row[name + (UNITS.get(name, "_m") if self.metric else "")]
        return float(text) if text else math.nan

    def solid(self, building, lod):
        """[(kind, rings of points in map coordinates)] from CityJSON."""
        geometry = next(g for g in self.city["CityObjects"][f"building_{building}"]["geometry"] if g["lod"] == lod)
        kinds = [geometry["semantics"]["surfaces"][i]["type"] for i in geometry["semantics"]["values"][0]]
        faces = [[[self.vertex(index) for index in ring] for ring in rings] for rings in geometry["boundaries"][0]]
        return list(zip(kinds, faces))

    def vertex(self, index):
        return tuple(step * scale + move for step, scale, move in zip(self.city["vertices"][index], self.scale, self.translate))

    def check(self, node, given=False):
        self.check_table(given)
        self.check_json()
        self.check_cityjson(node)
        self.check_geopackage()
        self.check_glb()
        self.check_dxf()
        strange = [path.name for path in self.folder.rglob("*") if "partial" in path.name or ".tmp" in path.name or "journal" in path.name]
        expect(not strange, f"left over: {strange}")

    def check_table(self, given):
        wanted = columns(self.metric) + (["outline_id"] if given else [])
        expect(self.names == wanted, f"buildings.csv has the columns {self.names}")
        expect([row["id"] for row in self.rows] == [str(i + 1) for i in range(len(self.rows))], "buildings are not numbered from 1")
        for row in self.rows:
            # A straight line between text and number, whatever the value.
            for name, text in row.items():
                expect(text == "" or name in ("roof", "note", "outline_id") or math.isfinite(float(text)), f"{name} is {text}")
                expect(not name.endswith("_sigma") or text == "" or float(text) >= 0.0, f"{name} is {text}")
            height, ridge, ground = (self.measure(row, name) for name in ("height", "ridge", "ground"))
            expect(abs(height - (ridge - ground)) < 0.001, f"building {row['id']} is {height} high, from {ground} to {ridge}")
            expect(self.measure(row, "length") >= self.measure(row, "width") > 0.0 and self.measure(row, "eave") <= ridge + 1e-6, f"{row}")
            expect(row["accepted"] in ("0", "1") and row["roof"] in ("flat", "gable", "hip", "other"), f"{row}")
            expect(0.0 <= float(row["wall_seen"]) <= 1.0, f"{row['wall_seen']} of the walls of building {row['id']} were seen")
        if not self.georeference["crs"]:
            expect(all(row["longitude"] == row["latitude"] == "" for row in self.rows), "there are longitudes without a geo-reference")
            return
        # By longitude: the map's north is the survey's only along the middle meridian of its zone. 1e-7 degrees are a centimetre.
        longitudes = [float(row["longitude"]) for row in self.rows]
        expect(all(b > a - 1e-7 for a, b in zip(longitudes, longitudes[1:])), f"buildings are not numbered from west to east: {longitudes}")
        places = [(float(row["longitude"]), float(row["latitude"]), 0.0) for row in self.rows]
        for row, place in zip(self.rows, transformed(places, "EPSG:4326", self.georeference["crs"]) if places else []):
            apart = math.dist(place[:2], (float(row["easting"]), float(row["northing"])))
            expect(apart < 0.01, f"longitude and easting of building {row['id']} are {apart} m apart")

    def check_json(self):
        known = self.json["buildings"]
        expect((self.json["metric"], len(known)) == (self.metric, len(self.rows)), f"{len(known)} buildings, metric: {self.json['metric']}")
        for row, one in zip(self.rows, known):
            for name in MEASURES:
                value, sigma = one["measures"][IN_JSON.get(name, name + "_m")]
                written = self.measure(row, name)
                if name in ("ground", "eave", "ridge") and self.georeference["crs"]:
                    # The survey is small and flat, so that map heights differ from ENU's by the origin's alone.
                    value += self.georeference["origin"]["height_m"]
                    expect(abs(written - value) < 0.01, f"{name} of building {row['id']} is {written}, in buildings.json {value}")
                else:
                    expect(abs(written - value) < 0.0002, f"{name} of building {row['id']} is {written}, in buildings.json {value}")
                text = row[name + (UNITS.get(name, "_m") if self.metric else "" if not name.endswith("_deg") else "") + "_sigma"]
                expect((sigma is None and text == "") or abs(float(text) - sigma) < 0.0002, f"sigma of {name} is {text} and {sigma}")
            expect((one["roof"], one["note"]) == (row["roof"], row["note"]), f"{row} and {one['roof']}, {one['note']}")

    def check_cityjson(self, node):
        crs = self.georeference["crs"]
        system = self.city["metadata"].get("referenceSystem", "")
        expect(system == (f"https://www.opengis.net/def/crs/EPSG/0/{crs[5:]}" if crs else ""), f"referenceSystem is '{system}'")
        expect(self.metric == ("unknown scale" not in self.city["metadata"]["title"]), self.city["metadata"]["title"])
        expect(list(self.city["CityObjects"]) == [f"building_{row['id']}" for row in self.rows], "buildings.city.json has other buildings")
        for row in self.rows:
            attributes = self.city["CityObjects"][f"building_{row['id']}"]["attributes"]
            for name, text in row.items():
                if name in attributes and name not in ("roof", "note", "accepted", "outline_id"):
                    expect(abs(float(text) - attributes[name]) < 1e-9, f"{name} of building {row['id']}: {text} and {attributes[name]}")
            missing = {name for name, text in row.items() if text != ""} - set(attributes) - set(columns(self.metric)[1:5]) - {"note"}
            expect(not missing, f"building {row['id']} has no attributes {missing}")
            expect(attributes.get("outline_id", "") == row.get("outline_id", ""), f"another outline: {attributes}")
            self.check_solid(row)
        if not node.folder:
            return
        read = node.check("check_cityjson.mjs", self.folder / "buildings.city.json")
        expect((read["buildings"], read["crs"]) == (len(self.rows), system), f"cityjson-threejs-loader reads {read['buildings']} buildings, {read['crs']}")
        ours = {(f"building_{row['id']}", lod): volume([face for _, face in self.solid(row["id"], lod)]) for row in self.rows for lod in ("1.2", "2.2")}
        theirs = {(solid["building"], solid["lod"]): solid["volume"] for solid in read["solids"]}
        expect(ours.keys() == theirs.keys(), f"solids {sorted(ours)} and {sorted(theirs)}")
        for key, value in ours.items():
            expect(abs(value - theirs[key]) < 0.01 + 1e-4 * value, f"volume of {key} is {value}, in cityjson-threejs-loader {theirs[key]}")

    def check_solid(self, row):
        """Area, volume and heights of the table are those of the solids."""
        area, ground, ridge = (self.measure(row, name) for name in ("area", "ground", "ridge"))
        for lod in ("1.2", "2.2"):
            faces = self.solid(row["id"], lod)
            kinds = {kind for kind, _ in faces}
            expect(kinds == set(SURFACE_OF.values()), f"building {row['id']}, lod {lod} has {kinds}")
            floor = sum(polygon_area(rings) for kind, rings in faces if kind == "GroundSurface")
            expect(abs(floor - area) < 0.01 + ON_MAP * area, f"the ground of building {row['id']}, lod {lod} has {floor} m2, in the table {area} m2")
            heights = [point[2] for _, rings in faces for ring in rings for point in ring]
            expect(abs(min(heights) - ground) < 0.01, f"building {row['id']}, lod {lod} begins at {min(heights)}, in the table at {ground}")
            expect(max(heights) < ridge + 0.02, f"building {row['id']}, lod {lod} ends at {max(heights)}, in the table at {ridge}")
        one = self.json["buildings"][int(row["id"]) - 1]
        if one["lod22_valid"]:
            expect(abs(max(heights) - ridge) < 0.02, f"the roof of building {row['id']} ends at {max(heights)}, in the table at {ridge}")
            found, wanted = volume([rings for _, rings in faces]), self.measure(row, "volume")
            expect(abs(found - wanted) < 0.05 + 2 * ON_MAP * wanted, f"the solid of building {row['id']} has {found} m3, the table {wanted} m3")

    def check_geopackage(self):
        file = self.folder / "buildings.gpkg"
        self.footprints = []
        for layer in ("footprints", "solids"):
            read = features(file, layer)
            expect(len(read) == len(self.rows), f"layer {layer} has {len(read)} buildings, the table {len(self.rows)}")
            text = output("ogrinfo", "-so", file, layer)
            crs = self.georeference["crs"]
            if crs and layer == "solids":
                # Simulated surveys have ellipsoidal heights: the zone's CRS with a third axis, which has no code.
                right = f'PROJCRS["WGS 84 / UTM zone {int(crs[-2:])}N"' in text and "CS[Cartesian,3]" in text
            else:
                right = f'ID["EPSG",{crs[5:]}]' in text if crs else "EPSG" not in text
            expect(right, f"layer {layer} has another CRS:\n{text}")
            for row, (fields, shape) in zip(self.rows, read):
                expect(list(fields) == self.names, f"layer {layer} has the fields {list(fields)}")
                for name, text in row.items():
                    value = fields[name]
                    same = (value or "") == text if name in ("roof", "note", "outline_id") else value is None if text == "" else float(text) == value
                    expect(same, f"{name} of building {row['id']} is {value} in layer {layer}, {text} in buildings.csv")
                if layer == "footprints":
                    self.footprints.append([open_ring(ring) for ring in shape])
                    found, wanted = polygon_area(self.footprints[-1]), self.measure(row, "area")
                    expect(abs(found - wanted) < 0.01 + ON_MAP * wanted, f"the footprint of building {row['id']} has {found} m2, not {wanted}")
                else:
                    faces = [[open_ring(ring) for ring in rings] for rings in shape]
                    ours = [rings for _, rings in self.solid(row["id"], "2.2")]
                    apart = max(math.dist(p, q) for a, b in zip(faces, ours) for c, d in zip(a, b) for p, q in zip(c, d))
                    expect(len(faces) == len(ours) and apart < SAME_M, f"building {row['id']} is {apart} m away in buildings.city.json")

    def check_glb(self):
        read = glb_reader.Glb(self.folder / "buildings.glb")
        place = read.document["asset"]["extras"]
        offset = place["offset"]
        # buildings.glb keeps the coordinates of mesh.glb.
        per_unit = 1.0 if self.georeference["crs"] else place["metresPerUnit"] or 1.0
        expect((place["metresPerUnit"] is not None) == self.metric, f"buildings.glb says {place}")
        expect(offset == self.georeference["offset"], f"buildings.glb has the offset {offset}, mesh.glb {self.georeference['offset']}")
        nodes = read.document.get("nodes", [])
        expect([node["extras"]["id"] for node in nodes] == [int(row["id"]) for row in self.rows], "buildings.glb has other buildings")
        for node, row in zip(nodes, self.rows):
            name = "height_m" if self.metric else "height"
            expect(node["extras"][name] == float(row[name]), f"extras of building {row['id']} in buildings.glb: {node['extras']}")
        parts = read.parts() if nodes else []
        glb = [tuple(per_unit * (value + move) for value, move in zip(glb_reader.z_up(p), offset)) for part in parts for p in part.positions]
        city = [point for row in self.rows for _, rings in self.solid(row["id"], "2.2") for ring in rings for point in ring]
        for points, others, what in ((glb, city, "buildings.glb"), (city, glb, "buildings.city.json")):
            near = Nearest(others, 1.0)
            worst = max((near.distance(point) for point in points), default=0.0)
            expect(worst < IN_GLB_M, f"a corner of {what} is {worst} m from any of the other file")

    def check_dxf(self):
        read = features(self.folder / "buildings.dxf", "entities")
        edges, rings = 0, 0
        for one in self.json["buildings"]:
            distinct = set()
            for face in one["lod22"]["face"]:
                for ring in [face["outer"], *face["holes"]]:
                    distinct |= {frozenset(edge) for edge in zip(ring, ring[1:] + ring[:1])}
            edges += len(distinct)
            rings += 1 + len(one["footprint"]["holes"])
        layers = [fields["Layer"] for fields, _ in read]
        expect(set(layers) <= {"GROUND", "WALLS", "ROOFS", "FOOTPRINTS"}, f"layers of buildings.dxf are {set(layers)}")
        outlines = layers.count("FOOTPRINTS")
        expect((len(layers) - outlines, outlines) == (edges, rings), f"buildings.dxf has {len(layers) - outlines} edges and {outlines} outlines, "
               f"the solids {edges} and {rings}")

    def check_cloud(self):
        """Points of buildings are where buildings are."""
        cloud = las_reader.Las(self.project / "surface" / "cloud.las")
        expect(cloud.count == self.table["points"], f"cloud.las has {cloud.count} points, the surface {self.table['points']}")
        expect(set(cloud.classes()) <= {1, 2, 5, ROOF, WALL, EDGE, CORNER}, f"cloud.las has the classes {cloud.classes()}")
        expect(cloud.classes().get(2, 0) > 0.1 * cloud.count, f"only {cloud.classes().get(2, 0)} of {cloud.count} points are ground")
        roofs = 0
        for point in cloud.points:
            if point[3] not in (ROOF, WALL, EDGE, CORNER):
                continue
            near = [rings for rings in self.footprints if is_inside(rings[0], point) or distance_to_ring(rings[0], point) < AROUND_M]
            expect(near, f"a point of class {point[3]} at {point[:3]} is at no building")
            roofs += point[3] == ROOF
        expect(roofs > 0, "no point is a roof")
        return cloud


def page_text(page):
    """What a reader sees of an HTML page."""
    text = re.sub(r"<(script|style)\b.*?</\1>", " ", page, flags=re.DOTALL)
    return re.sub(r"\s+", " ", re.sub(r"<[^>]+>", " ", text))
