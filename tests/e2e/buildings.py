"""Stage buildings from a simulated survey to files that other programs read; refused commands, faults, and surveys without a scale.
Usage: buildings.py SKYQUILT [CACHE]. CACHE: folder for packages of Node.js; else $SKYQUILT_NODE_CACHE, else beside the program."""
import json
import math
import os
import pathlib
import random
import re
import shutil
import sys
import time

from building_faults import BuildingFaults, made, sha
from building_files import BuildingFiles, is_inside, page_text
from foreign_readers import NodeReaders, node_cache, output, transformed
from harness import expect, hamlet, main, metrics_of

WIDTH = "160"
SMALL = ["--blocks", "1x1", "--set", "partition.max_log2_table_size=15"]
TRAIN = ["--steps", "800", "--set", "train.batch_samples=8192", "--set", "context.batch_samples=8192"]
LENGTH = re.compile(r"\d\s*m[²³]?(?![\w²³])")  # a number with its unit


def shown_height(row):
    """As the report has it, rounded to two digits of its standard deviation."""
    digits = max(0, 1 - math.floor(math.log10(float(row["height_m_sigma"]))))
    return f"{float(row['height_m']):.{digits}f} ± {float(row['height_m_sigma']):.{digits}f} m"


class Buildings(BuildingFaults):
    """How buildings are made and used."""

    def check_run(self):
        survey = hamlet(self.skyquilt, WIDTH)
        words = ["run", survey, "-o", self.project, "--image-width", WIDTH, "--set", "products.video_seconds=0", *SMALL, *TRAIN]
        self.skyquilt.call(*words, "--set", "buildings.enabled=false")
        expect(not (self.project / "buildings").exists(), "buildings were made although they are turned off")
        expect("buildings" not in metrics_of(self.project) or metrics_of(self.project)["buildings"] is None, "there are scores of no buildings")
        expect('id="buildings"' not in (self.project / "report" / "index.html").read_text(), "the report has a section about no buildings")
        self.plain_cloud = self.folder / "plain.las"
        shutil.copy(self.project / "surface" / "cloud.las", self.plain_cloud)
        text = self.skyquilt.call(*words)
        order = [text.find(f"{stage} started") for stage in ("buildings", "evaluate")]
        expect("surface: nothing to do" in text and 0 <= text.find("surface: nothing") < order[0] < order[1], f"the order of stages is another:\n{text}")
        self.wanted = made(self.project)
        found = json.loads((self.project / "buildings" / "buildings.json").read_text())["buildings"]
        expect(len(found) >= 5, f"only {len(found)} buildings were found in the hamlet")
        text = self.skyquilt.call("buildings", self.project)
        expect("buildings: nothing to do" in text and made(self.project) == self.wanted, f"finished buildings were made again:\n{text}")
        print(f"{len(found)} buildings", flush=True)

    def check_files(self):
        files = BuildingFiles(self.project)
        files.check(self.node)
        cloud = files.check_cloud()
        for name in ("buildings.json", "buildings.city.json", "buildings.csv"):
            described = self.skyquilt.call("info", self.project / "buildings" / name)
            expect("height_m" in described, f"info says about {name}:\n{described[:300]}")
        scores = metrics_of(self.project)["buildings"]
        accepted = sum(row["accepted"] == "1" for row in files.rows)
        expect((scores["found"], scores["accepted"]) == (len(files.rows), accepted), f"metrics.json counts {scores['found']}, {scores['accepted']}")
        expect(abs(scores["volume_m3"] - sum(float(row["volume_m3"]) for row in files.rows)) < 0.1, f"volumes: {scores['volume_m3']}")
        expect(scores["solids_rejected"] == scores["blocks_rejected"] == 0, f"invalid solids: {scores}")
        expect(scores["outlines"] >= 1 and scores["matched"] + scores["missed"] == scores["outlines"], f"scores: {scores}")
        page = (self.project / "report" / "index.html").read_text()
        section = page_text(page[page.index('id="buildings"'):])
        expect(LENGTH.search(section), "the report has no lengths")
        shown = sum(shown_height(row) in section for row in files.rows)
        expect(shown > 0.8 * len(files.rows), f"the report shows {shown} of {len(files.rows)} heights, as {shown_height(files.rows[0])}")
        for name in re.findall(r'(?:href|src)="(\.\./buildings/[^"]+|images/building_[^"]+)"', page):
            expect((self.project / "report" / name).is_file(), f"the report leads to {name}, which is not there")
        return cloud

    def check_same(self):
        """However it is made, and again and again."""
        project = self.fresh()
        for words, ranks in ((["--threads", "1"], 0), (["--threads", "2", "--restart"], 0), (["--restart"], 2)):
            self.skyquilt.call("buildings", project, *words, ranks=ranks)
            found = made(project)
            differing = sorted(name for name in found.keys() | self.wanted.keys() if found.get(name) != self.wanted.get(name))
            expect(not differing, f"with {words} and {ranks} ranks other files are made: {differing}")

    def check_choice(self):
        """Files that are not wanted any more are removed; classes are written only when asked for."""
        project = self.fresh()
        self.skyquilt.call("buildings", project, "--set", "buildings.classify_cloud=false", "--set", "buildings.dxf=false")
        expect(sha(project / "surface" / "cloud.las") == sha(self.plain_cloud), "the cloud got classes although they are turned off")
        left = sorted(path.name for path in (project / "buildings").iterdir())
        expect(left == ["buildings.city.json", "buildings.csv", "buildings.glb", "buildings.gpkg", "buildings.json"], f"files: {left}")
        self.skyquilt.call("buildings", project, "--set", "buildings.dxf=true", status=2, says=("buildings.dxf", "--restart"))

    def outlines(self, cloud):
        """Rings around two found buildings in map coordinates, and one around bare ground."""
        files = BuildingFiles(self.project)
        files.check_geopackage()
        largest = sorted(range(len(files.rows)), key=lambda i: -float(files.rows[i]["area_m2"]))[:2]
        rings = [[point[:2] for point in files.footprints[i][0]] for i in largest]
        ground = [point for point in cloud.points if point[3] == 2]
        low, high = ([select(point[axis] for point in ground) for axis in range(2)] for select in (min, max))
        chance = random.Random(1)
        while True:
            x, y = (chance.uniform(0.8 * a + 0.2 * b, 0.2 * a + 0.8 * b) for a, b in zip(low, high))
            box = [(x - 6.0, y - 6.0), (x + 6.0, y - 6.0), (x + 6.0, y + 6.0), (x - 6.0, y + 6.0)]
            inside = [point[3] for point in cloud.points if is_inside(box, point)]
            if len(inside) > 20 and all(code == 2 for code in inside):
                return rings, box

    def check_footprints(self, cloud):
        project = self.fresh()
        rings, bare = self.outlines(cloud)
        named = {"house \"7\", back": rings[0], "straße 5": rings[1]}

        def write(name, outlines):
            points = [(*point, 0.0) for ring in outlines.values() for point in ring + ring[:1]]
            degrees = iter(transformed(points, "EPSG:32632", "EPSG:4326"))
            features = [{"type": "Feature", "properties": {"name": key},
                         "geometry": {"type": "Polygon", "coordinates": [[list(next(degrees)[:2]) for _ in range(len(ring) + 1)]]}}
                        for key, ring in outlines.items()]
            (self.folder / name).write_text(json.dumps({"type": "FeatureCollection", "features": features}))
            return self.folder / name

        given = write("given.geojson", named)
        package = self.folder / "given.gpkg"
        # Of the same datum: from EPSG:2056, outlines come back slightly moved, and in this coarse survey one house was then 0.39 m longer.
        output("ogr2ogr", "-f", "GPKG", "-t_srs", "EPSG:32631", package, given)
        found = []
        for file in (given, package):
            self.skyquilt.call("buildings", project, "--footprints", file, *(["--restart"] if found else []))
            files = BuildingFiles(project)
            files.check(self.node, given=True)
            expect({row["outline_id"] for row in files.rows} == set(named), f"{file.name} has {[row['outline_id'] for row in files.rows]}")
            found.append(files.rows)
            for row, rings_of, one in zip(files.rows, files.footprints, files.json["buildings"]):
                expect(one["given"] and one["given_id"] == row["outline_id"], f"building {row['id']} is not a given one")
                middle = [sum(point[axis] for point in rings_of[0]) / len(rings_of[0]) for axis in range(2)]
                expect(is_inside(named[row["outline_id"]], middle), f"building {row['id']} is not in its outline")
        for a, b in zip(*found):
            expect(math.isclose(float(a["length_m"]), float(b["length_m"]), abs_tol=0.3), f"GeoJSON and GeoPackage differ: {a['length_m']}, {b['length_m']}")
        before = made(project)
        text = self.skyquilt.call("buildings", project)
        expect("nothing to do" in text and made(project) == before, "outlines are not remembered")

        # One without a roof is left out and named; a hundred far away are one line of the log.
        text = self.skyquilt.call("buildings", project, "--footprints", write("some.geojson", dict(named, bare=bare)), "--restart")
        expect(len(BuildingFiles(project).rows) == 2 and "1 of 3 outlines" in text and "bare" in text, f"bare ground is not named:\n{text}")
        away = {f"far {i}": [(x + 9000.0 + 30.0 * i, y) for x, y in rings[0]] for i in range(100)}
        text = self.skyquilt.call("buildings", project, "--footprints", write("away.geojson", away), "--restart")
        expect("100 of 100 outlines" in text and "coordinate system" in text and text.count("far") < 10, f"outlines elsewhere:\n{text}")
        files = BuildingFiles(project)
        files.check(self.node)
        expect(not files.rows, "there are buildings outside the survey")
        self.skyquilt.call("evaluate", project)
        expect(metrics_of(project)["buildings"]["found"] == 0, "the scores are those of other buildings")

        # Outlines that fit nothing: across houses, trees and the ground between.
        chance, (x, y) = random.Random(3), rings[0][0]
        corners = [(x + chance.uniform(-60.0, 60.0), y + chance.uniform(-40.0, 40.0)) for _ in range(150)]
        across = {str(i): [(a, b), (a + 9.0, b), (a + 9.0, b + 7.0), (a, b + 7.0)] for i, (a, b) in enumerate(corners)}
        self.skyquilt.call("buildings", project, "--footprints", write("across.geojson", across), "--restart")
        files = BuildingFiles(project)
        files.check(self.node, given=True)
        expect(0 < len(files.rows) < len(across), f"{len(files.rows)} buildings in {len(across)} outlines that fit nothing")

        self.skyquilt.call("buildings", project, "--footprints", given, "--restart")
        before = made(project)
        self.refused(project, "--footprints", self.folder / "absent.geojson", "--restart", status=3, says=["absent.geojson", "no such file"])
        self.refused(project, "--footprints", self.folder, "--restart", status=3, says=[str(self.folder)])
        expect(made(project) == before, "a file that is not there removed the buildings")
        self.check_bad_footprints(project)

    def check_bad_footprints(self, project):
        point = {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [8.5417, 47.3769]}}
        bad = {"nothing.geojson": "", "text.geojson": "hello", "none.geojson": '{"type": "FeatureCollection", "features": []}',
               "cut.geojson": '{"type": "FeatureCollection", "features": [', "text.gpkg": "SQLite format 3\0 and no more",
               "point.geojson": json.dumps({"type": "FeatureCollection", "features": [point]})}
        for name, content in bad.items():
            (self.folder / name).write_text(content)
            self.refused(project, "--footprints", self.folder / name, status=3, says=[name, "Give a GeoJSON, GeoPackage or Shapefile"])
        self.skyquilt.call("buildings", project, "--footprints", "")
        expect(made(project) == self.wanted, "without the outlines other buildings are found than before")

    def check_facades(self):
        project = self.fresh()
        text = self.skyquilt.call("buildings", project, "--facades", "2,2")
        files = BuildingFiles(project)
        folder = project / "buildings" / "facades"
        told = json.loads((folder / "facade_2.json").read_text())
        pictures = sorted(path.name for path in folder.glob("*.png"))
        expect(pictures and pictures == sorted(wall["file"] for wall in told["facades"]), f"{pictures} and {told}")
        expect((told["building"], told["crs"]) == (2, "EPSG:32632") and f"{len(pictures)} facade picture" in text, f"{told}\n{text}")
        corners = [point for kind, rings in files.solid("2", "2.2") if kind == "WallSurface" for point in rings[0]]
        for wall in told["facades"]:
            size = json.loads(output("gdalinfo", "-json", folder / wall["file"]))["size"]
            expect(size == [wall["width_px"], wall["height_px"]], f"{wall['file']} has {size} pixels: {wall}")
            rounded = 0.0005  # lengths in the file have millimetres
            expect(wall["wall_width_m"] - rounded <= size[0] * wall["pixel_m"] < wall["wall_width_m"] + 2.0 * wall["pixel_m"], f"{wall}")
            near = min(math.dist(wall["top_left"][:2], corner[:2]) for corner in corners)
            expect(near < 0.01, f"{wall['file']} begins {near} m from any wall of the building")
            east, north = (wall["top_right"][axis] - wall["top_left"][axis] for axis in range(2))
            turned = math.degrees(math.atan2(north, -east)) - wall["azimuth_deg"]
            expect(abs(math.remainder(turned, 360.0)) < 0.5, f"{wall['file']} does not look to {wall['azimuth_deg']} degrees")
        before = made(project)
        self.skyquilt.call("buildings", project, "--facades", "2", ranks=2)
        expect(made(project) == before, "2 ranks make other facades")

        damaged = project / "buildings" / "buildings.json"
        whole = damaged.read_text()
        for content in (whole[:2000], "", whole.replace('"version":1', '"version":9', 1), whole.replace('"scale":1.0', '"scale":0', 1), "[]"):
            damaged.write_text(content)
            self.refused(project, "--facades", "2", status=3, says=["buildings.json", "'skyquilt buildings' with --restart"])
            if content == "":
                self.skyquilt.call("evaluate", project, status=3, says="'skyquilt buildings' with --restart")
        self.skyquilt.call("buildings", project, "--restart")
        expect(made(project) == self.wanted, "buildings that were damaged are not made again")

    def check_local(self):
        """No place on Earth, so no scale: no number gets a unit until a distance is given."""
        survey, project = self.folder / "unplaced", self.folder / "local"
        self.skyquilt.call("simulate", "hamlet", "-o", survey, "--image-width", WIDTH, "--set", "simulate.exact_frame=false", "--set",
                           "simulate.tags_equal=true")
        text = self.skyquilt.call("run", survey, "-o", project, "--image-width", WIDTH, "--set", "products.video_seconds=0", *SMALL, *TRAIN)
        expect(text.index("surface started") < text.index("buildings started"), f"the order of stages is another:\n{text}")
        log = text[text.index("buildings started"):text.index("evaluate started")]
        expect("no scale" in log and not re.search(r"\d m\b|\d m2|\bmetres\b", log), f"the log has lengths:\n{log}")
        local = BuildingFiles(project, metric=False)
        local.check(self.node)
        expect(len(local.rows) >= 3, f"only {len(local.rows)} buildings without a geo-reference")
        self.skyquilt.call("buildings", project, "--facades", "1")
        told = json.loads((project / "buildings" / "facades" / "facade_1.json").read_text())
        expect("unknown" in told["crs"] and not any(name.endswith("_m") for wall in told["facades"] for name in wall), f"facades have units: {told}")
        page = (project / "report" / "index.html").read_text()
        begin = page.index('id="buildings"')
        following = page.find("<section", begin)
        section = page_text(page[begin:following if following > 0 else len(page)])
        lengths = LENGTH.search(section)
        expect(not lengths and "Lengths have no unit" in section, f"the report has a length with a unit: {lengths}")
        scores = metrics_of(project)["buildings"]
        expect(scores["found"] == len(local.rows) and scores["metric"] is False and scores.get("outlines") is None, f"scores: {scores}")

        # Between two corners of a building that is known to be twice as far apart.
        ring = local.json["buildings"][0]["footprint"]["outer"]
        a, b = (",".join(map(repr, (*point, 0.5))) for point in ring[:2])
        length = 2.0 * math.dist(*ring[:2])
        self.skyquilt.call("buildings", project, "--scale-bar", a, b, repr(length), "--restart")
        scaled = BuildingFiles(project)
        scaled.check(self.node)
        expect(scaled.json["scale_source"] == "scale bar" and abs(scaled.json["scale"] - 2.0) < 1e-9, f"scale {scaled.json['scale']}")
        for row, other in zip(scaled.rows, local.rows, strict=True):
            for name, factor in (("height", 2.0), ("length", 2.0), ("area", 4.0), ("volume", 8.0), ("yaw_deg", 1.0)):
                expect(math.isclose(scaled.measure(row, name), factor * local.measure(other, name), rel_tol=1e-3), f"{name}: {row}, {other}")
        self.skyquilt.call("evaluate", project)
        expect(metrics_of(project)["buildings"]["metric"] is True, "with a scale bar scores are not in metres")

        # A geo-reference and a bar that contradicts it.
        self.skyquilt.call("buildings", self.fresh(), "--scale-bar", "0,0,0", "10,0,0", "10.2", says=("1.02", "scale bar"))


def test(skyquilt, folder):
    folder = pathlib.Path(folder)
    node = NodeReaders(sys.argv[2] if len(sys.argv) > 2 else node_cache(skyquilt.program))
    buildings = Buildings(skyquilt, folder, node)
    begun = time.monotonic()

    def step(name, *arguments):
        result = getattr(buildings, f"check_{name}")(*arguments)
        if os.environ.get("SKYQUILT_TEST_SECONDS"):
            print(f"{name}: {time.monotonic() - begun:.1f} s", flush=True)
        return result

    step("run")
    cloud = step("files")
    for name in ("bad_words", "same", "choice", "facades", "surface_needed", "kills", "full_disk", "local"):
        step(name)
    step("footprints", cloud)


if __name__ == "__main__":
    main(test)
