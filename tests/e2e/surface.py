"""Stage surface from a simulated survey to files that other programs read: the same places in all of them, the same files in any way of making them.
Usage: surface.py SKYQUILT [CACHE]. CACHE: folder for packages of Node.js; else $SKYQUILT_NODE_CACHE, else beside the program."""
import hashlib
import json
import math
import pathlib
import random
import shutil
import statistics
import subprocess
import sys

import glb_reader
import las_reader
import tileset_checker
from foreign_readers import NodeReaders, Nearest, Obj, Ply, Raster, assimp_faces, node_cache, output, plane_distance, projected_area, transformed
from harness import Failure, Skyquilt, digest, expect, hamlet, main

WIDTH = "160"
TRAIN = ["--steps", "400", "--set", "train.batch_samples=8192", "--set", "context.batch_samples=8192", "--set", "partition.max_log2_table_size=15"]
ORIGIN = (47.3769, 8.5417, 408.0)  # of simulated places, known exactly
CRS = "EPSG:32632"
GSD_M = 0.4  # of these photos
SAME_M = 0.02  # the same vertex in two files
RASTERS = ("dtm.tif", "height_above_ground.tif", "hillshade.tif")
FILES = ("mesh.glb", "mesh.obj", "mesh.mtl", "mesh.ply", "cloud.las", "cloud.ply", "tiles/tileset.json", "georeference.json", "surface.json",
         "contours.gpkg") + RASTERS
ONLY_PLY = [word for name in ("glb", "obj", "cloud", "tiles", "maps") for word in ("--set", f"surface.{name}=false")]


def copied(project, folder):
    """Without its surface."""
    shutil.copytree(project, folder, symlinks=True)
    for path in ("surface", "cache/surface", "report"):
        shutil.rmtree(folder / path, ignore_errors=True)
    for stage in ("surface", "evaluate"):
        (folder / ".state" / f"{stage}.json").unlink(missing_ok=True)
    return folder


def finished(skyquilt, *words):
    """Like Skyquilt.call, with any exit status."""
    return subprocess.run(skyquilt.command(words, 0), env=skyquilt.environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          errors="replace", timeout=900)


def sha(file):
    return hashlib.sha256(file.read_bytes()).hexdigest()


class Surface:
    """The products in a folder, read by several programs and compared with each other."""

    def __init__(self, folder):
        self.folder = folder
        self.table = json.loads((folder / "surface.json").read_text())
        self.georeference = json.loads((folder / "georeference.json").read_text())
        self.offset = self.georeference["offset"]
        self.parts = glb_reader.Glb(folder / "mesh.glb").parts()
        self.glb, self.triangles = [], []
        for part in self.parts:
            first = len(self.glb)
            self.glb += [self.in_map(glb_reader.z_up(p)) for p in part.positions]
            self.triangles += [tuple(first + corner for corner in triangle) for triangle in part.triangles]
        self.obj = Obj(folder / "mesh.obj")
        self.ply = Ply(folder / "mesh.ply")
        self.las = las_reader.Las(folder / "cloud.las")
        self.cloud = Ply(folder / "cloud.ply")
        self.tiles = tileset_checker.Checker(folder / "tiles" / "tileset.json").check()

    def in_map(self, position):
        return tuple(value + offset for value, offset in zip(position, self.offset))

    def check_counts(self):
        wanted = self.table["triangles"]
        expect(wanted > 1000, f"the surface has only {wanted} triangles")
        counts = {"mesh.glb": len(self.triangles), "mesh.obj": len(self.obj.triangles), "mesh.ply": len(self.ply.triangles),
                  "tiles": self.tiles.triangles(), "mesh.glb in Assimp": assimp_faces(self.folder / "mesh.glb"),
                  "mesh.obj in Assimp": assimp_faces(self.folder / "mesh.obj")}
        expect(all(count in (wanted, None) for count in counts.values()), f"triangles differ: {counts}, the table says {wanted}")
        points = {"cloud.las": self.las.count, "cloud.ply": len(self.cloud.vertices), "surface.json": self.table["points"]}
        expect(len(set(points.values())) == 1 and self.las.count > 1000, f"points differ: {points}")
        listed = {row["file"] for row in self.table["files"]}
        for row in self.table["files"]:
            expect((self.folder / row["file"]).is_file() and row["bytes"] > 0 and row["format"] and row["content"], f"the table has {row}")
        expect(set(FILES) - {"mesh.mtl", "surface.json"} <= listed, f"not in the table: {sorted(set(FILES) - listed)}")
        strange = [path.name for path in self.folder.rglob("*") if "partial" in path.name or ".tmp" in path.name]
        expect(not strange, f"left over: {strange}")

    def check_directions(self):
        """Triangles and normals look up on the whole, texture coordinates are inside the texture."""
        area = projected_area(self.glb, self.triangles)
        for name, file in (("mesh.obj", (self.obj.positions, self.obj.triangles)), ("mesh.ply", (self.ply.positions(), self.ply.triangles))):
            other = projected_area(*file)
            expect(abs(other - area) < 0.001 * area, f"{name} covers {other} m2 seen from above, mesh.glb {area} m2")
        expect(0.3 * self.table["area_m2"] < area < 1.001 * self.table["area_m2"], f"{area} m2 from above of {self.table['area_m2']} m2")
        up = [normal[1] for part in self.parts for normal in part.normals]
        expect(up and statistics.fmean(up) > 0.3, f"normals of mesh.glb look up by {statistics.fmean(up) if up else None}")
        for name, file in (("mesh.ply", self.ply), ("cloud.ply", self.cloud)):
            expect(statistics.fmean(file.column("nz")) > 0.3, f"normals of {name} do not look up")
        for part in self.parts:
            expect(part.image and part.uvs and all(-1e-6 <= value <= 1.0 + 1e-6 for uv in part.uvs for value in uv), "a part without texture")

    def check_places(self):
        """The same vertices are at the same places in all files."""
        chosen = [select(self.glb, key=lambda p: p[axis]) for axis in range(3) for select in (min, max)]
        chosen += self.glb[::max(1, len(self.glb) // 30)]
        in_tiles = transformed(self.tiles.ecef_positions(), "EPSG:4978", CRS) if self.georeference["crs"] else self.tiles.ecef_positions()
        others = {"mesh.obj": map(self.in_map, self.obj.positions), "mesh.ply": map(self.in_map, self.ply.positions()), "tiles": in_tiles}
        for name, points in others.items():
            near = Nearest(points, 1.0)
            worst = max(near.distance(vertex) for vertex in chosen)
            expect(worst < SAME_M, f"vertices of mesh.glb are up to {worst:.3f} m from those of {name}")
        for point, other in zip(self.las.points, self.cloud.vertices):
            apart = math.dist(point[:3], self.in_map(other[:3]))
            expect(apart < SAME_M, f"a point is at {point[:3]} in cloud.las and {apart:.3f} m from there in cloud.ply")
        self.check_cloud_on_mesh()

    def check_cloud_on_mesh(self):
        picked = random.Random(1).sample(self.las.points, 60)
        corners = [tuple(self.glb[v] for v in triangle) for triangle in self.triangles]
        boxes = [(min(c[0] for c in t), max(c[0] for c in t), min(c[1] for c in t), max(c[1] for c in t), t) for t in corners]
        apart = []
        for point in picked:
            x, y = point[:2]
            over = [box[4] for box in boxes if box[0] - 0.1 <= x <= box[1] + 0.1 and box[2] - 0.1 <= y <= box[3] + 0.1]
            apart.append(min((plane_distance(point[:3], three) for three in over), default=math.inf))
        share = sum(value < 0.05 for value in apart) / len(apart)
        expect(share > 0.95, f"only {100 * share:.0f} % of the points are on the mesh; distances {sorted(apart)[-5:]}")

    def check_maps(self, dsm, orthophoto):
        """Heights of roofs and colours agree with the maps that are rendered without the mesh."""
        heights = sorted(p[2] for p in self.glb)
        roof = 0.5 * (heights[len(heights) // 2] + heights[-len(heights) // 100])
        roofs = [p for p in self.glb if p[2] > roof]
        # The cloud is even, while vertices of a simplified mesh crowd at trees and edges.
        for name, points, limit in (("all", self.las.points, 0.5 * GSD_M), ("roof", roofs, 1.0)):
            differences = [abs(p[2] - dsm.at(*p[:2])) for p in points if not math.isnan(dsm.at(*p[:2]))]
            expect(len(differences) > 20, f"only {len(differences)} {name} places are in the surface model")
            median = statistics.median(differences)
            expect(median < limit, f"{name} places are {median:.2f} m from the surface model in the median")
        middle = 0.5 * (min(p[1] for p in self.glb) + max(p[1] for p in self.glb))

        def difference(mirror):
            found = []
            for x, y, _, _, _, rgb in self.las.points[::37]:
                shown = [band.at(x, 2.0 * middle - y if mirror else y) for band in orthophoto]
                found += [abs(value - wanted / 257.0) for value, wanted in zip(shown, rgb) if not math.isnan(value)]
            return statistics.median(found)

        expect(difference(False) < 20.0, f"colours of the cloud differ by {difference(False):.0f} of 255 from the orthophoto")
        expect(difference(False) < 0.8 * difference(True), f"colours fit as well when the map is mirrored: {difference(False)}, {difference(True)}")

    def check_terrain(self, dsm):
        terrain, above, shade = (Raster(self.folder / name) for name in RASTERS)
        for raster in (terrain, above, shade):
            expect(raster.is_cog(), f"{raster.file.name} is not laid out for the cloud: {raster.info['metadata'].get('IMAGE_STRUCTURE')}")
            expect(raster.crs() == (CRS if self.georeference["crs"] else ""), f"{raster.file.name} has CRS {raster.crs()}")
            expect(raster.nodata is not None, f"{raster.file.name} has no value for cells without data")
            shifts = ((raster.left - dsm.left) / dsm.cell, (raster.top - dsm.top) / dsm.cell)
            fits = raster.cell == dsm.cell and all(abs(shift - round(shift)) < 1e-6 for shift in shifts)
            expect(fits, f"cells of {raster.file.name} are not those of dsm.tif")
        ground = [p for p in self.las.points if p[3] == 2]
        expect(0.1 < len(ground) / self.las.count < 1.0, f"{len(ground)} of {self.las.count} points are ground")
        off = statistics.median(abs(p[2] - terrain.at(*p[:2])) for p in ground if not math.isnan(terrain.at(*p[:2])))
        expect(off < 0.3, f"ground points are {off:.2f} m from the terrain model in the median")
        wrong = [(x, y, value) for x, y, value in above.cells() if value < -0.5 or value > 40.0]
        expect(len(wrong) < 0.01 * above.width * above.height, f"heights above ground: {wrong[:3]}")
        expect(max(value for _, _, value in above.cells()) > 3.0, "nothing stands on the ground")
        apart = [abs(terrain.at(x, y) + value - dsm.at(x, y)) for x, y, value in above.cells() if not math.isnan(dsm.at(x, y) + terrain.at(x, y))]
        expect(statistics.median(apart) < 0.5 * GSD_M, f"terrain and height above it are {statistics.median(apart):.2f} m from dsm.tif in the median")

    def check_contours(self):
        text = output("ogrinfo", "-so", "-al", self.folder / "contours.gpkg")
        counts = [int(line.split(":")[1]) for line in text.splitlines() if line.startswith("Feature Count")]
        expect(counts and sum(counts) > 0, f"there are no contours:\n{text}")
        expect(not self.georeference["crs"] or f'ID["EPSG",{CRS[5:]}]' in text, f"the contours have another CRS:\n{text}")

    def check_georeference(self):
        expect(self.georeference["crs"] == CRS == self.table["crs"], f"CRS {self.georeference['crs']}, in the table {self.table['crs']}")
        expect(math.dist(tileset_checker.origin_of(self.georeference), ORIGIN) < 1e-9, f"the origin is {self.georeference['origin']}")
        lines = (self.folder / "offset.txt").read_text().split("\n")
        numbers = [float(word) for word in lines[1].split()]
        expect(lines[0] == "WGS84 UTM 32N" and numbers == self.offset[:2], f"offset.txt is {lines}")
        expect(CRS[5:] in self.las.wkt and "UTM zone 32N" in self.las.wkt, f"WKT of cloud.las: {self.las.wkt}")
        shift = tileset_checker.check_place(self.tiles, *ORIGIN)
        place = transformed([tileset_checker.ecef_from_geodetic(*ORIGIN)], "EPSG:4978", CRS)[0]
        middle = [0.5 * (low + high) for low, high in zip(self.las.min, self.las.max)]
        near = math.dist(place[:2], middle[:2]) < 60.0 and abs(place[2] - middle[2]) < 20.0
        expect(near, f"the cloud is around {middle}, the survey around {place}")
        print(f"tiles are within {1000 * shift:.2f} mm of their place", flush=True)

    def check_with_node(self, node):
        """Packages of Node.js see the same as our own readers."""
        if not node.folder:
            return
        models = [self.folder / "mesh.glb", *sorted((self.folder / "tiles").glob("*.glb"))]
        report = node.check("check_gltf.mjs", *models)
        counts = ", ".join(f"{report[key]} {key}" for key in ("files", "errors", "warnings"))
        print(f"glTF validator: {counts}", *report["messages"][:3], flush=True)
        shown = node.check("check_tiles.mjs", self.folder / "tiles" / "tileset.json")
        with_content = [tile for tile in self.tiles.tiles if tile["triangles"]]
        expect((shown["tiles"], shown["visible"], shown["triangles"]) == (len(with_content), len(self.tiles.leaves()), self.tiles.triangles()),
               f"3d-tiles-renderer shows {shown['tiles']} tiles, {shown['visible']} fine ones, {shown['triangles']} triangles")
        expect(len(shown["images"]) >= len(with_content), f"only {len(shown['images'])} textures in {len(with_content)} tiles")
        ours = [select(column) for select in (min, max) for column in zip(*self.tiles.ecef_positions())]
        expect(math.dist(ours, shown["ecef_min"] + shown["ecef_max"]) < 0.001, f"3d-tiles-renderer shows the tiles elsewhere: {shown}, not {ours}")
        read = node.check("check_las.mjs", self.folder / "cloud.las")
        classes = {int(number): count for number, count in read["classes"].items()}
        expect((read["count"], classes, read["wkt"]) == (self.las.count, self.las.classes(), self.las.wkt), f"copc reads other points: {read}")
        expect(math.dist(read["min"] + read["max"], [*self.las.min, *self.las.max]) < 0.01, f"copc reads points elsewhere: {read}")


def maps_of(folder):
    dsm, orthophoto = Raster(folder / "dsm.tif"), [Raster(folder / "orthophoto.tif", band) for band in (1, 2, 3)]
    for raster in (dsm, orthophoto[0]):
        layout = raster.info["metadata"].get("IMAGE_STRUCTURE")
        expect(raster.is_cog() and raster.crs() == CRS, f"{raster.file.name} has CRS {raster.crs()}, {layout}")
    return dsm, orthophoto


def outlines(dsm):
    """A triangle over the south-west of the map, and one far away: corners in map coordinates, counter-clockwise."""
    width, height = dsm.width * dsm.cell, dsm.height * dsm.cell
    left, bottom = dsm.left + 0.1 * width, dsm.top - 0.9 * height
    inside = [(left, bottom), (left + 0.7 * width, bottom), (left, bottom + 0.7 * height)]
    return inside, [(x + 50000.0, y + 3000.0) for x, y in inside]


def write_outline(file, corners):
    ring = [list(p[:2]) for p in transformed([(*corner, 0.0) for corner in corners + corners[:1]], CRS, "EPSG:4326")]
    file.write_text(json.dumps({"type": "FeatureCollection", "features": [
        {"type": "Feature", "properties": {"name": "site"}, "geometry": {"type": "Polygon", "coordinates": [ring]}}]}))
    return file


def outside_by(corners, point):
    """Distance out of a convex polygon beyond its farthest edge; negative inside."""
    return max(((bx - ax) * (ay - point[1]) - (by - ay) * (ax - point[0])) / math.dist((ax, ay), (bx, by))
               for (ax, ay), (bx, by) in zip(corners, corners[1:] + corners[:1]))


def check_boundary(skyquilt, project, folder, dsm):
    inside, away = outlines(dsm)
    site = write_outline(folder / "site.geojson", inside)
    skyquilt.call("surface", project, "--boundary", site, "--restart")
    made = Surface(project / "surface")
    made.check_counts()
    skyquilt.call("render", project, "--ortho", "--dsm", "--boundary", site, "-o", folder / "site_maps")
    area = abs(sum(ax * by - bx * ay for (ax, ay), (bx, by) in zip(inside, inside[1:] + inside[:1]))) / 2.0
    rasters = {name: Raster(made.folder / name) for name in RASTERS}
    rasters["dsm.tif"] = Raster(folder / "site_maps" / "dsm.tif")
    rasters["orthophoto.tif"] = Raster(folder / "site_maps" / "orthophoto.tif", 4)
    for name, raster in rasters.items():
        shown = [cell for cell in raster.cells() if name != "orthophoto.tif" or cell[2] > 0.0]
        worst = max(outside_by(inside, cell) for cell in shown)
        expect(worst <= 0.01, f"{name} has a cell {worst:.2f} m outside the boundary")
        share = len(shown) * raster.cell ** 2 / area
        expect(share > 0.8, f"{name} fills only {100 * share:.0f} % of the boundary")
    reach = 2.0 * made.table["voxel_m"]
    for name, points in (("mesh.glb", made.glb), ("cloud.las", made.las.points), ("mesh.ply", map(made.in_map, made.ply.positions()))):
        worst = max(outside_by(inside, point) for point in points)
        expect(worst <= reach, f"{name} reaches {worst:.2f} m out of the boundary, more than two voxels")

    (folder / "broken.geojson").write_text('{"type": "FeatureCollection", "features": [')
    write_outline(folder / "away.geojson", away)
    for name, what in (("away.geojson", "boundary"), ("broken.geojson", "broken.geojson"), ("absent.geojson", "absent.geojson")):
        file = folder / name
        done = finished(skyquilt, "surface", project, "--boundary", file, "--restart")
        expect(done.returncode in (2, 3) and what in done.stdout, f"a boundary in {file.name} ends with {done.returncode}:\n{done.stdout}")
        left = [path.name for path in (project / "surface").rglob("*") if path.is_file()]
        expect(not left, f"after the refused boundary {file.name} there are {left}")


def check_pieces(skyquilt, project, wanted):
    """With little memory the surface is fused piece by piece; the mesh is the same."""
    for memory in ("40MB", "80MB", "160MB", "320MB", "640MB"):
        done = finished(skyquilt, "surface", project, "--memory", memory, "--restart", *ONLY_PLY)
        explained = done.returncode == 0 or (done.returncode == 2 and "--memory" in done.stdout)
        expect(explained, f"--memory {memory} ends with {done.returncode}:\n{done.stdout}")
        table = project / "surface" / "surface.json"
        if done.returncode == 0 and json.loads(table.read_text())["voxel_m"] == wanted.table["voxel_m"]:
            expect(sha(project / "surface" / "mesh.ply") == sha(wanted.folder / "mesh.ply"), f"--memory {memory} gives another mesh")
            print(f"the least memory for these voxels: {memory}", flush=True)
            return
        expect(done.returncode == 2 or "voxels" in done.stdout, f"larger voxels are not reported:\n{done.stdout}")
    raise Failure("the surface cannot be made with 640 MB in the voxels of more memory")


def check_local(skyquilt, folder):
    """A survey whose tags give no place: local metres, no CRS in any file."""
    survey, project = folder / "unplaced", folder / "local"
    skyquilt.call("simulate", "hamlet", "-o", survey, "--image-width", WIDTH, "--set", "simulate.exact_frame=false", "--set",
                  "simulate.tags_equal=true")
    skyquilt.call("prepare", survey, "-o", project)
    skyquilt.call("partition", project, "--blocks", "1x1", "--set", "partition.max_log2_table_size=15")
    skyquilt.call("train", project, *TRAIN[:6])
    skyquilt.call("merge", project)
    skyquilt.call("surface", project, "--set", "surface.min_island_m2=0")
    made = Surface(project / "surface")
    expect(made.georeference["crs"] is None and made.georeference["origin"] is None and made.offset == [0, 0, 0], f"{made.georeference}")
    expect(made.table["crs"] == "local frame, metres" and "EPSG" not in made.las.wkt, f"CRS {made.table['crs']}, {made.las.wkt}")
    expect(not (made.folder / "offset.txt").exists(), "an offset without geo-reference")
    expect(made.tiles.root_transform == glb_reader.IDENTITY, "local tiles are moved")
    made.check_counts()
    made.check_places()
    made.check_contours()
    for name in RASTERS:
        expect(Raster(made.folder / name).crs() == "", f"{name} has a CRS")


def test(skyquilt: Skyquilt, folder):
    for reader in (glb_reader, las_reader, tileset_checker):
        reader.self_test()
    node = NodeReaders(sys.argv[2] if len(sys.argv) > 2 else node_cache(skyquilt.program))
    survey, project = hamlet(skyquilt, WIDTH), folder / "project"
    skyquilt.call("run", survey, "-o", project, "--blocks", "1x2", "--image-width", WIDTH, "--set", "products.video_seconds=0",
                  "--set", "buildings.enabled=false", *TRAIN)  # buildings would change the classes of the cloud
    before = digest(project / "surface")
    expect(all(name in before for name in FILES), f"missing: {sorted(set(FILES) - set(before))}")
    text = skyquilt.call("surface", project)
    expect("surface: nothing to do" in text and digest(project / "surface") == before, f"a finished surface was made again:\n{text}")

    whole = Surface(project / "surface")
    dsm, orthophoto = maps_of(project / "products")
    whole.check_counts()
    whole.check_directions()
    whole.check_georeference()
    whole.check_places()
    whole.check_maps(dsm, orthophoto)
    whole.check_terrain(dsm)
    whole.check_contours()
    whole.check_with_node(node)

    ranks = copied(project, folder / "ranks")
    skyquilt.call("surface", ranks, ranks=3, says="pieces of the mesh fused by 2 other ranks")
    for name in before:
        if name != "surface.json":  # it has times
            expect(sha(ranks / "surface" / name) == sha(project / "surface" / name), f"3 ranks make another {name}")
    check_pieces(skyquilt, copied(project, folder / "little"), whole)
    check_boundary(skyquilt, copied(project, folder / "limited"), folder, dsm)
    check_local(skyquilt, folder)


if __name__ == "__main__":
    main(test)
