"""Plays NodeODM's part with 'skyquilt odm': lists the options, starts run.sh through a shell with quoted values, listens to its progress, ends its
process tree, starts it again, packs the results. Written from NodeODM's behaviour; nothing of NodeODM or OpenDroneMap is needed.

  python3 odm.py PROGRAM BUILD_FOLDER [NODE_CACHE]
"""
import argparse
import fcntl
import importlib.util
import json
import math
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
import zipfile

import ept_checker
import glb_reader
import las_reader
import tileset_checker
from foreign_readers import NodeReaders, Nearest, Obj, Raster, assimp_faces, node_cache
from harness import HOUSES_WIDTH, children, expect, hamlet, main

WIDTH = HOUSES_WIDTH
CONFIG = f"""[run]
image_width = {WIDTH}
[partition]
blocks = "1x1"
max_log2_table_size = 15
[train]
steps = 900
batch_samples = 8192
checkpoint_every_s = 0.3
[context]
batch_samples = 8192
checkpoint_every_s = 0.3
[evaluate]
max_photos = 1
"""
# What NodeODM packs into all.zip, of what we write.
PACKED = ["odm_orthophoto/odm_orthophoto.tif", "odm_orthophoto/odm_orthophoto.png", "odm_orthophoto/odm_orthophoto.wld",
          "odm_orthophoto/cutline.gpkg", "odm_georeferencing", "odm_texturing", "odm_dem/dsm.tif", "odm_dem/dtm.tif", "entwine_pointcloud", "3d_tiles",
          "images.json", "cameras.json", "odm_report"]
PORT = 6367
# The forms of ranges that NodeODM understands; another one makes it refuse every value.
DOMAINS = re.compile(r"^((positive |negative )?(integer|float)|percent|(float|integer): [-+.\d]+ <= x <= [-+.\d]+"
                     r"|(float|integer) (>=|>|<|<=) [-+.\d]+|json|string|path)$")
HIDDEN = {"-h", "name", "--version", "--project-path", "--gcp", "--geo", "--align", "--split-image-groups", "--copy-to", "--rerun", "--rerun-all"}


def engine_folder(folder, build):
    """The folder as it is installed."""
    source = pathlib.Path(__file__).resolve().parents[2] / "share" / "skyquilt" / "odm"
    engine = folder / "engine"
    shutil.copytree(source, engine, ignore=shutil.ignore_patterns("VERSION.in", "__pycache__"))
    shutil.copy(build / "share" / "skyquilt" / "odm" / "VERSION", engine / "VERSION")
    return engine


def listed_options(engine):
    """All options as NodeODM's helper records them: every value of add_argument as text."""
    options = {}

    class Recorder(argparse.ArgumentParser):
        def add_argument(self, *names, **words):
            super().add_argument(*names, **words)
            options[names[0]] = {key: str(value) for key, value in words.items()}

    spec = importlib.util.spec_from_file_location("config", engine / "opendm" / "config.py")
    module = importlib.util.module_from_spec(spec)
    sys.dont_write_bytecode = True
    spec.loader.exec_module(module)
    arguments, sys.argv = sys.argv, ["helper.py", "--project-path", str(engine), "bogusname"]
    try:
        module.config(parser=Recorder())
    finally:
        sys.argv = arguments
    return options


def check_options(engine):
    options = listed_options(engine)
    for name, words in options.items():
        if name in HIDDEN:
            continue
        expect(words["help"], f"{name} has no help")
        if words.get("default") in ("True", "False"):
            continue  # a flag
        expect(words.get("type", "") in ("<class 'int'>", "<class 'float'>", "<class 'str'>", "") or "function" in words["type"], f"{name}: {words}")
        if "choices" in words:
            choices = json.loads(words["choices"].replace("'", '"'))
            expect("default" not in words or words["default"] in choices, f"{name}: {words}")
        else:
            domain = words["metavar"].strip("<>").strip()
            expect(DOMAINS.match(domain), f"{name} has the range '{domain}', which NodeODM cannot handle")
        if words.get("type") in ("<class 'int'>", "<class 'float'>"):
            float(words["default"])
    for name in ("--dsm", "--dtm", "--pc-ept", "--cog", "--gltf", "--boundary", "--pc-quality", "--skyquilt-time-budget", "--skyquilt-config"):
        expect(name in options, f"{name} is not listed")
    expect((engine / "ENGINE").read_text().splitlines()[0] == "skyquilt", "ENGINE")
    return options


class Progress:
    """Hears what is sent to NodeODM's port. messages: (dataset, percent)."""

    def __init__(self):
        self.messages = []
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.socket.bind(("127.0.0.1", PORT))
        self.socket.settimeout(0.2)
        self.ended = False
        self.thread = threading.Thread(target=self.listen)
        self.thread.start()

    def listen(self):
        while not self.ended:
            try:
                parts = self.socket.recv(1000).decode().split("/")
            except TimeoutError:
                continue
            if len(parts) == 4 and parts[0] == "PGUP":
                self.messages.append((parts[2], float(parts[3])))

    def end(self):
        time.sleep(0.5)  # what was sent last
        self.ended = True
        self.thread.join()
        self.socket.close()


class Node:
    def __init__(self, skyquilt, engine, data):
        self.skyquilt, self.engine, self.data = skyquilt, engine, data

    def start(self, name, **options):
        """Flags that are true are bare, those that are false are left out, all other values are quoted and lose their own quotes."""
        words = []
        for option, value in {**options, "project_path": str(self.data)}.items():
            if value is False:
                continue
            words.append("--" + option.replace("_", "-") if not option.startswith("d3") else "--3d-tiles")
            if value is not True:
                words.append('"' + str(value).replace('"', "") + '"')
        environment = dict(self.skyquilt.environment, ODM_NONINTERACTIVE="1", SKYQUILT=str(pathlib.Path(self.skyquilt.program).resolve()))
        return subprocess.Popen(" ".join([str(self.engine / "run.sh"), *words, f'"{name}"']), shell=True, cwd=self.engine, env=environment,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace")

    def run(self, name, status=0, says=(), **options):
        began = time.monotonic()
        process = self.start(name, **options)
        text, _ = process.communicate(timeout=900)
        print(f"{time.monotonic() - began:6.1f} s  run.sh {options} {name}", flush=True)
        expect(process.returncode == status, f"run.sh {options} ended with {process.returncode}, not {status}:\n{text}")
        for wanted in [says] if isinstance(says, str) else says:
            expect(wanted in text, f"run.sh {options} does not say '{wanted}':\n{text}")
        return text


def end_tree(process):
    """As NodeODM cancels a task: SIGTERM to every process of the tree."""
    everyone, at = [process.pid], 0
    while at < len(everyone):
        everyone += children(everyone[at])
        at += 1
    for pid in everyone:
        try:
            os.kill(pid, signal.SIGTERM)
        except ProcessLookupError:
            pass


def check_cancelled(node, dataset, options):
    process = node.start(dataset.name, **options)
    lines = []
    reader = threading.Thread(target=lambda: lines.extend(process.stdout))
    reader.start()
    end = time.monotonic() + 300
    while not any((dataset / "skyquilt" / "checkpoints").glob("*.h5")) and time.monotonic() < end and process.poll() is None:
        time.sleep(0.02)
    expect(process.poll() is None, f"the run ended before it could be cancelled:\n{''.join(lines)}")
    end_tree(process)
    process.wait(timeout=120)
    reader.join()
    expect(process.returncode != 0, "a cancelled run looks like a finished one")
    expect(not (dataset / "odm_orthophoto" / "odm_orthophoto.tif").exists(), "a cancelled run has an orthophoto")


def expect_on(found, wanted, what):
    """Every point is one of the others, to a centimetre."""
    nearest = Nearest(wanted, 0.05)
    worst = max(nearest.distance(point) for point in found[::max(1, len(found) // 500)])
    expect(worst < 0.01, f"{what}: {worst:.4f} m apart")


def check_places(dataset, node_readers):
    """All products are in the same place."""
    textures, cloud = dataset / "odm_texturing", dataset / "odm_georeferencing"
    zone, offset = (cloud / "coords.txt").read_text().splitlines()[:2]
    expect(zone == "WGS84 UTM 32N", zone)
    east, north = (float(word) for word in offset.split())
    obj = Obj(textures / "odm_textured_model_geo.obj")
    expect(len(obj.triangles) > 500, f"only {len(obj.triangles)} triangles")
    on_map = [(x + east, y + north, z) for x, y, z in obj.positions]
    glb_file = textures / "odm_textured_model_geo.glb"
    glb = glb_reader.Glb(glb_file)
    centre = glb.document["extensions"]["CESIUM_RTC"]["center"]
    expect(centre == [east, north, 0.0], f"the GLB has the offset {centre}, coords.txt {offset}")
    corners = [(x + east, y + north, z) for x, y, z in (p for part in glb.parts() for t in part.triangles for p in (part.positions[i] for i in t))]
    expect(len(corners) == 3 * len(obj.triangles), f"the GLB has {len(corners) // 3} triangles, the OBJ {len(obj.triangles)}")
    expect_on(corners, on_map, "GLB and OBJ")
    for file in (glb_file, textures / "odm_textured_model_geo.obj"):
        expect(assimp_faces(file) in (len(obj.triangles), None), f"Assimp counts other triangles in {file.name}")
    if not node_readers.reason:
        node_readers.check("check_gltf.mjs", glb_file)
    las = las_reader.Las(cloud / "odm_georeferenced_model.las")
    ept = ept_checker.Ept(dataset / "entwine_pointcloud")
    expect(ept.ept["srs"]["horizontal"] == "32632", ept.ept["srs"])
    wanted = sorted((round(1000 * x), round(1000 * y), round(1000 * z), *rgb, kind) for x, y, z, kind, _, rgb in las.points)
    expect(sorted(ept.counted().elements()) == wanted, "EPT and LAS have other points")
    # The cloud lies on the mesh: it fills the same box.
    for axis in range(3):
        for pick in (min, max):
            apart = abs(pick(p[axis] for p in las.points) - pick(p[axis] for p in on_map))
            expect(apart < 1.0, f"cloud and mesh end {apart:.2f} m apart on axis {axis}")
    tileset_checker.Checker(dataset / "3d_tiles" / "model" / "tileset.json").check()
    rasters = {name: Raster(dataset / name) for name in ("odm_dem/dsm.tif", "odm_dem/dtm.tif")}
    rasters["odm_orthophoto/odm_orthophoto.tif"] = Raster(dataset / "odm_orthophoto/odm_orthophoto.tif", 2)
    for name, raster in rasters.items():
        expect(raster.crs() == "EPSG:32632" and raster.is_cog(), f"{name}: {raster.crs()}, COG {raster.is_cog()}")
        expect(any(True for _ in raster.cells()), f"{name} is empty")
        low, high = min(p[0] for p in on_map), max(p[0] for p in on_map)
        expect(raster.left < high and raster.left + raster.width * raster.cell > low, f"{name} is elsewhere")
    return rasters


def check_reports(dataset, survey):
    shots = json.loads((dataset / "odm_report" / "shots.geojson").read_text())["features"]
    cameras = json.loads((dataset / "cameras.json").read_text())
    rows = {row["filename"]: row for row in json.loads((dataset / "images.json").read_text())}
    photos = {path.name for path in (survey / "images").iterdir()}
    expect(len(shots) > 3 and photos >= {shot["properties"]["filename"] for shot in shots}, f"shots of other photos than {sorted(photos)[:3]} ...")
    for shot in shots:
        known, place = shot["properties"], shot["geometry"]["coordinates"]
        expect(known["camera"] in cameras and known["width"] == WIDTH and len(known["rotation"]) == 3, f"{known}")
        row = rows[known["filename"]]
        apart = math.dist((place[0] * 75e3, place[1] * 111e3), (row["longitude"] * 75e3, row["latitude"] * 111e3))
        expect(apart < 20.0, f"{known['filename']} is {apart:.1f} m from its tag")
    stats = json.loads((dataset / "odm_report" / "stats.json").read_text())
    expect(stats["reconstruction_statistics"]["reconstructed_shots_count"] == len(shots), f"{stats}")
    expect(stats["point_cloud_statistics"]["stats"]["statistic"][0]["count"] > 1000, f"{stats}")
    expect(stats["odm_processing_statistics"]["average_gsd"] > 0.0 and stats["processing_statistics"]["area"] > 100.0, f"{stats}")
    expect((dataset / "odm_report" / "index.html").is_file() and (dataset / "odm_report" / "metrics.json").is_file(), "no report")
    if any(shutil.which(name) for name in ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")):
        expect((dataset / "odm_report" / "report.pdf").read_bytes()[:5] == b"%PDF-", "report.pdf is no PDF")


def packed(dataset, archive):
    with zipfile.ZipFile(archive, "w") as zipped:
        for name in PACKED:
            path = dataset / name
            for file in sorted(path.rglob("*")) if path.is_dir() else [path]:
                if file.is_file():
                    zipped.write(file, file.relative_to(dataset))
    names = set(zipfile.ZipFile(archive).namelist())
    for name in PACKED:
        expect(name in names or any(entry.startswith(name + "/") for entry in names), f"{name} is not packed")


def check_one_at_a_time(node, dataset):
    """NodeODM restarts a task while the cancelled run may still save its work."""
    (dataset / "skyquilt").mkdir(exist_ok=True)
    with open(dataset / "skyquilt" / "odm.lock", "w") as lock:
        lock.write("4321")
        lock.flush()
        fcntl.flock(lock, fcntl.LOCK_EX)
        process = node.start(dataset.name, end_with="dataset")
        first = process.stdout.readline()
        expect("process 4321 still works on this dataset" in first, f"a second run begins with: {first}{process.stdout.read() if not first else ''}")
        fcntl.flock(lock, fcntl.LOCK_UN)
        text, _ = process.communicate(timeout=120)
    expect(process.returncode == 0 and "Finished dataset stage" in text, f"the second run ended with {process.returncode}:\n{text}")


def check_refusals(node, dataset, data):
    node.run(dataset.name, status=2, says="--skyquilt-time-budget: 'soon'", skyquilt_time_budget="soon")
    node.run(dataset.name, status=1, says="no polygon", boundary='{"type":"Point","coordinates":[9,45]}')
    node.run(dataset.name, status=2, says="Did you mean --orthophoto-resolution?", orthofoto_resolution="3")
    node.run(dataset.name, status=2, says="several spectral bands", radiometric_calibration="camera")
    node.run(dataset.name, status=2, says="--crop must be at least 0", crop="-1")
    text = node.run("nowhere", status=1, says="no such folder")  # 3 would be a fault of the installation
    expect("--project-path" in text.strip().splitlines()[-1], f"the last line names no remedy:\n{text}")
    (data / "empty" / "images").mkdir(parents=True)
    node.run("empty", status=1, says="images")
    (data / "broken" / "images").mkdir(parents=True)
    (data / "broken" / "images" / "photo.jpg").write_text("this is no picture")
    node.run("broken", status=1, says="photo")


def test(skyquilt, folder):
    build = pathlib.Path(sys.argv[2]).resolve()
    readers = NodeReaders(sys.argv[3] if len(sys.argv) > 3 else node_cache(skyquilt.program))
    engine, data = engine_folder(folder, build), folder / "data with spaces"
    check_options(engine)
    node = Node(skyquilt, engine, data)
    survey = hamlet(skyquilt, WIDTH)
    dataset = data / "0b1c2d3e-task"
    # The simulated survey brings its camera model, so that no poses have to be searched.
    shutil.copytree(survey, dataset / "images")
    (dataset / "images" / "images" / "wrong.jpg").write_text("this is no picture")
    (dataset / "image_groups.txt").write_text("a.jpg A\n")
    (folder / "small.toml").write_text(CONFIG)
    check_refusals(node, dataset, data)
    check_one_at_a_time(node, dataset)

    options = {"dsm": True, "dtm": True, "d3_tiles": True, "gltf": True, "pc_ept": True, "cog": True, "split": "400", "orthophoto_png": True,
               "orthophoto_cutline": True, "orthophoto_resolution": "40", "dem_resolution": "80", "ignore_gsd": True, "use_exif": False, "pc_quality": "low",
               "skyquilt_config": str(folder / "small.toml")}
    check_cancelled(node, dataset, options)
    progress = Progress()
    try:
        text = node.run(dataset.name, says=["prepare: nothing to do", "photos are not used: wrong.jpg", "--split: taken, without effect", "image_groups.txt: taken"], **options)
    finally:
        progress.end()
    for stage in ("dataset", "opensfm", "openmvs", "odm_meshing", "mvs_texturing", "odm_georeferencing", "odm_dem", "odm_orthophoto", "odm_report"):
        for word in ("Running", "Finished"):
            expect(f"[INFO]    {word} {stage} stage" in text, f"no line '{word} {stage} stage':\n{text}")
    percent = [value for name, value in progress.messages if name == dataset.name]
    expect(percent and percent == sorted(percent) and percent[-1] == 100.0 and len(set(percent)) > 8, f"progress {percent}")

    rasters = check_places(dataset, readers)
    expect(abs(rasters["odm_orthophoto/odm_orthophoto.tif"].cell - 0.4) < 1e-6, "the orthophoto has other cells")
    expect(abs(rasters["odm_dem/dtm.tif"].cell - 0.8) < 1e-6, "the terrain has other cells")
    same_file = [dataset / "odm_texturing" / "odm_textured_model_geo.obj", dataset / "skyquilt" / "surface" / "mesh.obj"]
    expect(os.path.samefile(*same_file), "the mesh is there twice")
    check_reports(dataset, survey)
    packed(dataset, folder / "all.zip")

    # Other options: only what depends on them is made again.
    options.update(orthophoto_png=False, crop="0", dtm=False)
    text = node.run(dataset.name, says=["train: nothing to do", "products begins anew", "surface begins anew"], **options)
    for name in ("odm_orthophoto/odm_orthophoto.png", "odm_dem/dtm.tif"):
        expect(not (dataset / name).exists(), f"{name} is left of an earlier run")
    text = node.run(dataset.name, says=["products: nothing to do", "evaluate started"], rerun_from="odm_report", **options)
    far = '{"type":"Polygon","coordinates":[[[9,45],[9.1,45],[9.1,45.1],[9,45]]]}'
    text = node.run(dataset.name, status=1, says=["beside the photos", "--boundary"], **options, boundary=far)
    expect("Running openmvs stage" not in text, f"a boundary elsewhere is found late:\n{text}")
    copy = folder / "copy"
    text = node.run(dataset.name, says="results copied", end_with="opensfm", copy_to=str(copy), **options)
    expect("Running openmvs stage" not in text, f"--end-with opensfm runs more:\n{text}")
    expect((copy / "odm_dem" / "dsm.tif").is_file(), "--copy-to copied nothing")


main(test)
