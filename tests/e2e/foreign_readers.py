"""Programs and packages of others that read the files of a surface: GDAL, Assimp, and packages of Node.js; and small readers of PLY and OBJ."""
import fcntl
import hashlib
import json
import math
import os
import pathlib
import re
import shutil
import struct
import subprocess
import tempfile

from harness import expect

SOURCE = pathlib.Path(__file__).resolve().parents[1] / "surface_readers"
PACKAGE_FILES = ("package.json", "package-lock.json", ".npmrc")
OLDEST_NODE = 18
HASTE = ("--fetch-retries=1", "--fetch-retry-mintimeout=1000", "--fetch-retry-maxtimeout=2000")  # where no registry is reached


def skip(text):
    print(f"skipped: {text}", flush=True)


def output(*command, text=None):
    done = subprocess.run([str(word) for word in command], input=text, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace",
                          timeout=300)
    expect(done.returncode == 0, f"{' '.join(map(str, command))} ended with {done.returncode}:\n{done.stdout}{done.stderr}")
    return done.stdout


def node_cache(program):
    """Where the packages are installed: not into the source tree."""
    return pathlib.Path(os.environ.get("SKYQUILT_NODE_CACHE") or pathlib.Path(program).resolve().parent / "node_cache")


class NodeReaders:
    """The checkers of tests/surface_readers. reason: why there are none."""

    def __init__(self, cache):
        self.folder = None
        self.reason = self.install(pathlib.Path(cache))
        if self.reason:
            skip(f"checks with packages of Node.js: {self.reason}")

    def install(self, cache):
        if not shutil.which("node") or not shutil.which("npm"):
            return "node or npm is not installed"
        version = subprocess.run(["node", "--version"], stdout=subprocess.PIPE, text=True).stdout.strip()
        if not re.match(r"v\d+\.", version) or int(version[1:].split(".")[0]) < OLDEST_NODE:
            return f"node is {version}, {OLDEST_NODE} or newer is needed"
        key = hashlib.sha256(b"".join((SOURCE / name).read_bytes() for name in PACKAGE_FILES)).hexdigest()[:12]
        installed = cache / key
        cache.mkdir(parents=True, exist_ok=True)
        with open(cache / "lock", "w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)  # several tests ask for them at once
            if not installed.exists() and (reason := self.install_packages(installed)):
                return reason
            for script in SOURCE.glob("*.mjs"):
                copy = installed / script.name
                if not copy.exists() or copy.read_bytes() != script.read_bytes():  # another test may be running it
                    shutil.copy(script, copy)
        self.folder = installed
        return ""

    def install_packages(self, installed):
        """Into the folder, which is complete or absent. The reason if that failed."""
        fresh = pathlib.Path(tempfile.mkdtemp(prefix="new_", dir=installed.parent))
        try:
            for name in PACKAGE_FILES:
                shutil.copy(SOURCE / name, fresh / name)
            done = subprocess.run(["npm", "ci", "--ignore-scripts", "--no-audit", "--no-fund", *HASTE], cwd=fresh, stdout=subprocess.PIPE,
                                  stderr=subprocess.STDOUT, text=True, errors="replace", timeout=240)
            expect("EUSAGE" not in done.stdout, f"package-lock.json does not fit package.json:\n{done.stdout}")
            if done.returncode != 0:
                return f"npm could not install them: {done.stdout.strip().splitlines()[0] if done.stdout.strip() else done.returncode}"
            fresh.rename(installed)
        except subprocess.TimeoutExpired:
            return "npm did not end in time"
        finally:
            shutil.rmtree(fresh, ignore_errors=True)
        return ""

    def check(self, script, *files):
        """What the script printed; a failure is one of the test."""
        done = subprocess.run(["node", script, *(str(pathlib.Path(file).resolve()) for file in files)], cwd=self.folder, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, errors="replace", timeout=120)
        expect(done.returncode == 0, f"{script} {files[0]} ended with {done.returncode}:\n{done.stdout}{done.stderr}")
        return json.loads(done.stdout)


def assimp_faces(file):
    """Triangles as Assimp counts them; None when it is not installed."""
    if not shutil.which("assimp"):
        skip(f"Assimp is not installed, {pathlib.Path(file).name} is not read with it")
        return None
    text = output("assimp", "info", file)
    found = re.search(r"^Faces:\s+(\d+)", text, re.MULTILINE)
    expect(found and "triangles" in text, f"assimp info {file}:\n{text}")
    return int(found.group(1))


def transformed(points, source, target):
    """Points (x, y, z) in another CRS, both as EPSG codes; longitude before latitude."""
    lines = "".join(f"{x!r} {y!r} {z!r}\n" for x, y, z in points)
    text = output("gdaltransform", "-s_srs", source, "-t_srs", target, text=lines)
    moved = [tuple(float(word) for word in line.split()[:3]) for line in text.splitlines() if line.strip()]
    expect(len(moved) == len(points), f"gdaltransform gave {len(moved)} of {len(points)} points")
    return moved


class Raster:
    """One band of a GeoTIFF as GDAL reads it. values: rows from the north; NaN: no data."""

    def __init__(self, file, band=1):
        self.file = pathlib.Path(file)
        self.info = json.loads(output("gdalinfo", "-json", file))
        self.width, self.height = self.info["size"]
        self.left, self.cell, skew, self.top, skew_too, down = self.info["geoTransform"]
        expect(skew == skew_too == 0.0 and down == -self.cell, f"{file} is not north-up with square cells: {self.info['geoTransform']}")
        self.nodata = self.info["bands"][band - 1].get("noDataValue")
        lines = output("gdal_translate", "-q", "-of", "XYZ", "-b", band, file, "/vsistdout/").splitlines()
        flat = [float(line.split()[2]) for line in lines]
        expect(len(flat) == self.width * self.height, f"{file} has {len(flat)} values")
        flat = [math.nan if value == self.nodata else value for value in flat]
        self.values = [flat[row * self.width:(row + 1) * self.width] for row in range(self.height)]

    def crs(self):
        """"EPSG:32632", or "" when there is none."""
        wkt = self.info.get("coordinateSystem", {}).get("wkt", "")
        found = re.findall(r'ID\["EPSG",(\d+)\]\]$', wkt.strip())
        return f"EPSG:{found[-1]}" if found else ""

    def is_cog(self):
        return self.info["metadata"].get("IMAGE_STRUCTURE", {}).get("LAYOUT") == "COG"

    def at(self, easting, northing):
        column, row = math.floor((easting - self.left) / self.cell), math.floor((self.top - northing) / self.cell)
        return self.values[row][column] if 0 <= column < self.width and 0 <= row < self.height else math.nan

    def cells(self):
        """(easting, northing, value) of the centres of the cells with data."""
        for row, values in enumerate(self.values):
            for column, value in enumerate(values):
                if not math.isnan(value):
                    yield self.left + (column + 0.5) * self.cell, self.top - (row + 0.5) * self.cell, value


PLY_TYPES = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d"}


class Ply:
    """A binary PLY file. vertices: dictionaries would be slow, so tuples with the names in `names`; triangles: three indices each."""

    def __init__(self, file):
        content = pathlib.Path(file).read_bytes()
        end = content.index(b"end_header\n") + len(b"end_header\n")
        lines = content[:end].decode("ascii").splitlines()
        expect(lines[:2] == ["ply", "format binary_little_endian 1.0"], f"{file} begins with {lines[:2]}")
        elements = []
        for line in lines:
            words = line.split()
            if words[0] == "element":
                elements.append((words[1], int(words[2]), []))
            elif words[0] == "property":
                elements[-1][2].append(words[1:])
        expect([element[0] for element in elements] in (["vertex"], ["vertex", "face"]), f"{file} has elements {elements}")
        properties = elements[0][2]
        self.names = [words[-1] for words in properties]
        record = "<" + "".join(PLY_TYPES[words[0]] for words in properties)
        size = struct.calcsize(record) * elements[0][1]
        self.vertices = list(struct.iter_unpack(record, content[end:end + size]))
        self.triangles = []
        size_of_faces = 0
        if len(elements) > 1:
            expect(elements[1][2] == [["list", "uchar", "int", "vertex_indices"]], f"faces of {file} have {elements[1][2]}")
            size_of_faces = 13 * elements[1][1]
            faces = list(struct.iter_unpack("<B3i", content[end + size:end + size + size_of_faces]))
            expect(all(face[0] == 3 for face in faces), f"{file} has faces that are no triangles")
            self.triangles = [face[1:] for face in faces]
        expect(end + size + size_of_faces == len(content), f"{file} has {len(content)} bytes, {end + size + size_of_faces} are announced")

    def column(self, name):
        index = self.names.index(name)
        return [vertex[index] for vertex in self.vertices]

    def positions(self):
        return list(zip(self.column("x"), self.column("y"), self.column("z")))


class Obj:
    """A Wavefront OBJ file whose materials and textures must exist."""

    def __init__(self, file):
        file = pathlib.Path(file)
        self.positions, self.triangles, used, materials = [], [], set(), {}
        n_uv = 0
        for line in file.read_text().splitlines():
            words = line.split()
            if not words:
                continue
            if words[0] == "v":
                self.positions.append(tuple(float(word) for word in words[1:4]))
            elif words[0] == "vt":
                n_uv += 1
                expect(all(-1e-6 <= float(word) <= 1.0 + 1e-6 for word in words[1:3]), f"{file.name} has texture coordinates {words[1:3]}")
            elif words[0] == "f":
                corners = [[int(number) if number else 0 for number in word.split("/")] for word in words[1:]]
                expect(len(corners) == 3, f"{file.name} has a face of {len(corners)} corners")
                expect(all(1 <= corner[0] <= len(self.positions) and 1 <= corner[1] <= n_uv for corner in corners), f"{file.name}: {line}")
                self.triangles.append(tuple(corner[0] - 1 for corner in corners))
            elif words[0] == "usemtl":
                used.add(words[1])
            elif words[0] == "mtllib":
                materials.update(self.read_materials(file.parent / words[1]))
        expect(used and used <= set(materials), f"{file.name} uses materials {sorted(used - set(materials))} that are not there")
        expect(all(materials[name] for name in used), f"{file.name} has materials without a texture")

    @staticmethod
    def read_materials(file):
        materials, name = {}, None
        for line in file.read_text().splitlines():
            words = line.split()
            if words and words[0] == "newmtl":
                name = words[1]
                materials[name] = None
            elif words and words[0] == "map_Kd":
                picture = file.parent / words[-1]
                expect(picture.is_file() and picture.read_bytes()[:3] == b"\xff\xd8\xff", f"{picture} is no JPEG")
                materials[name] = picture
        return materials


class Nearest:
    """Distances to the nearest of some points, at most `reach` metres away."""

    def __init__(self, points, reach):
        self.reach = reach
        self.boxes = {}
        for point in points:
            self.boxes.setdefault(self.box_of(point), []).append(point)

    def box_of(self, point):
        return tuple(math.floor(value / self.reach) for value in point)

    def distance(self, point):
        i, j, k = self.box_of(point)
        near = [other for x in (i - 1, i, i + 1) for y in (j - 1, j, j + 1) for z in (k - 1, k, k + 1) for other in self.boxes.get((x, y, z), ())]
        return min((math.dist(point, other) for other in near), default=math.inf)


def projected_area(positions, triangles):
    """Of the triangles seen from above (z up); negative where they are clockwise."""
    total = 0.0
    for a, b, c in triangles:
        (ax, ay, _), (bx, by, _), (cx, cy, _) = positions[a], positions[b], positions[c]
        total += 0.5 * ((bx - ax) * (cy - ay) - (cx - ax) * (by - ay))
    return total


def plane_distance(point, corners):
    """Distance to the plane of a triangle; infinity when the point is not above, below or on it, or the triangle has no area."""
    a, b, c = corners
    u, v, w = (tuple(q[i] - p[i] for i in range(3)) for p, q in ((a, b), (a, c), (a, point)))
    normal = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    squared = sum(value * value for value in normal)
    if squared < 1e-16:
        return math.inf

    def weight(p, q):
        cross = (p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0])
        return sum(x * y for x, y in zip(cross, normal)) / squared

    beta, gamma = weight(w, v), weight(u, w)
    slack = 0.01
    if beta < -slack or gamma < -slack or beta + gamma > 1.0 + slack:
        return math.inf
    return abs(sum(x * y for x, y in zip(w, normal))) / math.sqrt(squared)
