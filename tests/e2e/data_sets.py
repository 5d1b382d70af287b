"""The field's own data sets, made of a simulated hamlet whose photos lose their tags: forms of Blender, LLFF, Mip-NeRF 360, MatrixCity and Mega-NeRF are
trained on shortly and scored on their own splits; Mega-NeRF's is converted, ray by ray as its documentation says. Faults end with status 3 and a remedy."""
import json
import math
import os
import pathlib
import pickle
import shutil
import struct
import subprocess
import sys

from colmap_files import read_images, read_points
from harness import expect, main, metrics_of, small_survey

CONVERTER = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "convert_mega_nerf.py"
WIDTH, HEIGHT = 160, 120
TEST_EVERY = 5
RUN = ["--blocks", "1x1", "--image-width", "0", "--steps", "250", "--brightness", "none", "--set", "train.batch_samples=8192", "--set",
       "context.batch_samples=8192", "--set", "context.steps=150", "--set", "partition.max_log2_table_size=14", "--set", "products.video_seconds=0",
       "--set", "products.kinds=video", "--set", "surface.enabled=false", "--set", "buildings.enabled=false"]
SHORT = ["--set", "train.batch_samples=8192", "--set", "context.batch_samples=8192", "--set", "context.steps=80", "--set", "brightness.correction=none"]
# Reads what this test writes in place of PyTorch's files: pickles of dictionaries, whose lists stand for tensors.
FAKE_TORCH = """
import pickle

__version__ = "stand-in"

class Tensor(list):
    def tolist(self):
        return list(self)

def load(file, map_location, weights_only):
    assert map_location == "cpu" and weights_only
    return {key: Tensor(value) if isinstance(value, list) else value for key, value in pickle.loads(file.read_bytes()).items()}
"""


def without_tags(jpeg):
    """A JPEG without EXIF and XMP: no place, no exposure."""
    kept, at = jpeg[:2], 2
    while jpeg[at + 1] != 0xDA:
        end = at + 2 + int.from_bytes(jpeg[at + 2:at + 4], "big")
        kept += jpeg[at:end] if jpeg[at + 1] != 0xE1 else b""
        at = end
    return kept + jpeg[at:]


class Hamlet:
    """Cameras as NeRF has them, 3 x 4 from right, up, backwards, in east, north, up."""

    def __init__(self, folder):
        model = folder / "sparse" / "0"
        images = sorted(read_images(model / "images.bin"), key=lambda image: image.name)
        self.names = [image.name for image in images]
        self.cameras = [self.camera_to_world(image) for image in images]
        self.points = read_points(model / "points3D.bin")
        self.photos, self.model = folder / "images", model
        cameras = (model / "cameras.bin").read_bytes()
        _, _, kind, width, height, self.focal, _, _, self.k1 = struct.unpack("<QIiQQ4d", cameras[:72])
        expect((kind, width, height) == (2, WIDTH, HEIGHT), "the simulated lens is not the one that this test was written for")

    @staticmethod
    def camera_to_world(image):
        w, x, y, z = image.rotation
        r = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
             [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
        centre = [-sum(r[k][i] * image.translation[k] for k in range(3)) for i in range(3)]
        return [[r[0][i], -r[1][i], -r[2][i], centre[i]] for i in range(3)]

    def copy_photo(self, i, file):
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(without_tags((self.photos / self.names[i]).read_bytes()))

    def write_ply(self, file, origin=(0.0, 0.0, 0.0), scale=1.0):
        lines = ["ply", "format ascii 1.0", f"element vertex {len(self.points)}", *(f"property double {axis}" for axis in "xyz"),
                 *(f"property uchar {colour}" for colour in ("red", "green", "blue")), "end_header"]
        for point in self.points:
            lines.append(" ".join(repr(scale * (x - o)) for x, o in zip(point.head[:3], origin)) + " %d %d %d" % point.head[3:6])
        file.write_text("\n".join(lines) + "\n")


def surveyed(project):
    """Photos of survey.json by name."""
    return {photo["name"]: photo for photo in json.loads((project / "survey" / "survey.json").read_text())["photos"]}


def held_out(photos):
    return sorted(name for name, photo in photos.items() if photo["is_test"])


def trains(skyquilt, project, tested):
    """The rest of a short run of what was prepared, scored on the photos of the split."""
    for stage in (["partition", "--blocks", "1x1", "--image-width", "0"], ["train", "--steps", "120"], ["merge"], ["evaluate"]):
        skyquilt.call(stage[0], project, *stage[1:], *SHORT)
    published = metrics_of(project)["as_published"]
    expect((published["photos"], published["width"], published["height"]) == (len(tested), WIDTH, HEIGHT), f"as_published is of other pictures: {published}")
    expect(published["psnr"] > 13.0, f"PSNR is {published['psnr']}")


def trains_blenders_form(skyquilt, hamlet, folder):
    data, project = folder / "lego", folder / "blender"
    files = {part: {"camera_angle_x": 2.0 * math.atan(0.5 * WIDTH / hamlet.focal), "k1": hamlet.k1, "ply_file_path": "points.ply", "frames": []}
             for part in ("train", "test")}
    tested = []
    for i, camera in enumerate(hamlet.cameras):
        part = "test" if i % TEST_EVERY == 0 else "train"
        name = f"{part}/r_{i}"
        hamlet.copy_photo(i, data / f"{name}.jpg")
        files[part]["frames"].append({"file_path": f"./{name}", "transform_matrix": camera + [[0.0, 0.0, 0.0, 1.0]]})
        tested += [f"{name}.jpg"] if part == "test" else []
    hamlet.copy_photo(1, data / "test" / "r_0_normal_0001.jpg")
    hamlet.write_ply(data / "points.ply")
    for part, content in files.items():
        (data / f"transforms_{part}.json").write_text(json.dumps(content, indent=1))
    skyquilt.call("run", data, "--model", data, "-o", project, *RUN,
                  says=["data set Blender: 28 pictures, 1 others are left out", "6 of 28 photos are held out, as in published results on scenes of Blender"])
    photos = surveyed(project)
    expect(held_out(photos) == sorted(tested), f"held out are {held_out(photos)}")
    expect(len(photos) == len(hamlet.names), f"{len(photos)} photos are in the survey")
    metrics = metrics_of(project)
    published = metrics["as_published"]
    expect(sorted(image["name"] for image in metrics["images"]) == sorted(tested), "other photos than those of the split were scored")
    expect((published["photos"], published["width"], published["height"], published["unmasked_share"]) == (len(tested), WIDTH, HEIGHT, 1.0),
           f"as_published is of other pictures: {published}")
    expect(published["psnr"] == metrics["psnr_full_frame"] and published["psnr"] > 16.0, f"PSNR is {published['psnr']}")
    expect(published["ssim"] == metrics["ssim_full_frame"] and published["ssim"] > 0.3, f"SSIM is {published['ssim']}")
    expect("sigma 1.5" in published["ssim_variant"] and "not measured" in published["lpips_variant"], f"variants are not named: {published}")
    bench = folder / "bench"
    words = ["bench", "methods", "--data", data, "-o", bench, "--methods", "skyquilt", "--steps", "60", "--set", "partition.max_log2_table_size=14"]
    skyquilt.call(*words, "--place", "hamlet", status=2, says="has its own pictures, poses and split")
    skyquilt.call("bench", "methods", "--data", folder / "modules", "-o", bench, status=3, says="no such folder")
    skyquilt.call(*words, says=["Methods on Blender", "skyquilt"])
    result = json.loads((bench / "methods.json").read_text())["results"][0]
    rows = (bench / "methods.csv").read_text().splitlines()
    expect(len(rows) == 2 and float(rows[1].split(",")[1]) == result["psnr_full_db"] > 12.0, f"the rows are {rows}")
    expect((result["blocks"], result["training_photos"]) == (1, len(hamlet.names) - len(tested)), f"trained otherwise: {result}")
    expect(result["ssim_full"] is not None, result)
    # A picture less is another row than the published one.
    (data / tested[0]).unlink()
    skyquilt.call("prepare", data, "--model", data, "-o", folder / "fewer", status=3,
                  says=["transforms_test.json: line ", f"{tested[0].removesuffix('.jpg')}, which is not among the photos", "Unpack all pictures"])


def prepares_llffs_form(skyquilt, hamlet, folder):
    data, project = folder / "fern", folder / "llff"
    rows = []
    for i, camera in enumerate(hamlet.cameras):
        hamlet.copy_photo(i, data / "images" / f"IMG_{i:04}.jpg")
        last = (float(HEIGHT), float(WIDTH), hamlet.focal)
        rows += [value for r in range(3) for value in (-camera[r][1], camera[r][0], camera[r][2], camera[r][3], last[r])] + [10.0, 90.0]
    header = f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({len(hamlet.cameras)}, 17), }}"
    header += " " * (-(len(header) + 11) % 64) + "\n"
    npy = b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode() + struct.pack(f"<{len(rows)}d", *rows)
    (data / "poses_bounds.npy").write_bytes(npy)
    shutil.copytree(hamlet.model, data / "sparse" / "0")
    skyquilt.call("prepare", data, "--model", data / "poses_bounds.npy", "-o", project, "--up", "0,0,1",
                  says="4 of 28 photos are held out, as in published results on scenes of LLFF")
    expect(held_out(surveyed(project)) == [f"IMG_{i:04}.jpg" for i in range(0, 28, 8)], "other photos than every eighth are held out")
    trains(skyquilt, project, range(0, 28, 8))
    # As of Mip-NeRF 360: pictures of another folder, with COLMAP's cameras.
    for i, name in enumerate(hamlet.names):
        hamlet.copy_photo(i, data / "images_4" / name)
    skyquilt.call("prepare", data / "images_4", "--model", data, "-o", folder / "garden", "--up", "0,0,1", says="4 of 28 photos are held out, as in published results on scenes of")
    trains(skyquilt, folder / "garden", range(0, 28, 8))
    (data / "poses_bounds.npy").write_bytes(npy[:-1])
    skyquilt.call("prepare", data, "--model", data / "poses_bounds.npy", "-o", folder / "cut", status=3,
                  says=["poses_bounds.npy", "ends before its 28 x 17 numbers (truncated)", "imgs2poses.py"])


def convert(folder, *words, status=0):
    """The converter with the stand-in for PyTorch. Returns what it printed."""
    done = subprocess.run([sys.executable, str(CONVERTER), *map(str, words)], env=dict(os.environ, PYTHONPATH=str(folder / "modules")), text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    expect(done.returncode == status, f"the converter ended with {done.returncode}, not {status}:\n{done.stdout}")
    return done.stdout


def product(matrix, vector):
    return [sum(a * b for a, b in zip(row, vector)) for row in matrix]


def converts_mega_nerfs_form(skyquilt, hamlet, folder):
    data, project, scale = folder / "rubble", folder / "mega", 37.5
    (folder / "modules").mkdir()
    (folder / "modules" / "torch.py").write_text(FAKE_TORCH)
    drb_from_enu = [[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]
    origin_enu = [3.0, -4.0, 20.0]
    intrinsics = [hamlet.focal, hamlet.focal + 1.0, 80.5, 59.0]
    stored, validated = {}, []
    for i, camera in enumerate(hamlet.cameras):
        part = "val" if i % TEST_EVERY == 0 else "train"
        columns = [product(drb_from_enu, [row[k] for row in camera]) for k in range(3)]
        columns.append([x / scale for x in product(drb_from_enu, [camera[r][3] - origin_enu[r] for r in range(3)])])
        c2w = [[column[r] for column in columns] for r in range(3)]
        hamlet.copy_photo(i, data / part / "rgbs" / f"{i:06}.jpg")
        metadata = data / part / "metadata" / f"{i:06}.pt"
        metadata.parent.mkdir(parents=True, exist_ok=True)
        metadata.write_bytes(pickle.dumps({"H": HEIGHT, "W": WIDTH, "c2w": c2w, "intrinsics": intrinsics, "distortion": [0.0] * 4}))
        stored[f"{part}/rgbs/{i:06}.jpg"] = c2w
        validated += [f"{part}/rgbs/{i:06}.jpg"] if part == "val" else []
    (data / "coordinates.pt").write_bytes(pickle.dumps({"origin_drb": product(drb_from_enu, origin_enu), "pose_scale_factor": scale}))
    expect("28 pictures, 6 of them held out" in convert(folder, data), "the converter counts otherwise")

    file = data / "transforms.json"
    content = json.loads(file.read_text())
    expect(len(content["frames"]) == 28 and content["test_filenames"] == validated, "the converter lists other photos")
    fx, fy, cx, cy = intrinsics
    for frame in content["frames"]:
        c2w, matrix = stored[frame["file_path"]], frame["transform_matrix"]
        for i, j in ((0, 0), (159, 0), (0, 119), (159, 119), (77, 31)):
            # ray_utils.py with center_pixels: right, up, backwards of the camera, in axes down, right, backwards.
            down, right, backwards = product([row[:3] for row in c2w], [(i + 0.5 - cx) / fx, -(j + 0.5 - cy) / fy, -1.0])
            # nerfstudio's description.
            ours = product([row[:3] for row in matrix[:3]], [(i + 0.5 - frame["cx"]) / frame["fl_x"], -(j + 0.5 - frame["cy"]) / frame["fl_y"], -1.0])
            expect(all(abs(a - b) < 1e-9 for a, b in zip(ours, (right, -backwards, -down))), f"the ray of {frame['file_path']} at {i}, {j} is {ours}")
        down, right, backwards = (scale * row[3] for row in c2w)
        expect(all(abs(row[3] - x) < 1e-9 for row, x in zip(matrix, (right, -backwards, -down))), f"{frame['file_path']} is elsewhere")

    hamlet.write_ply(data / "points.ply", origin_enu)
    file.write_text(json.dumps(dict(content, ply_file_path="points.ply")))
    skyquilt.call("prepare", data, "--model", file, "-o", project, says=["6 of 28 photos are held out", "lengths are metres"])
    photos = surveyed(project)
    expect(held_out(photos) == validated, f"held out are {held_out(photos)}")
    trains(skyquilt, project, validated)

    (data / "train" / "rgbs" / "000001.jpg").unlink()
    expect("000001.jpg: no such picture" in convert(folder, data, status=3), "a missing picture is not named")
    (data / "val" / "metadata" / "000000.pt").write_bytes(pickle.dumps({"H": HEIGHT, "W": WIDTH, "c2w": [[0.0] * 4] * 2, "intrinsics": intrinsics}))
    shutil.copy(data / "train" / "rgbs" / "000002.jpg", data / "train" / "rgbs" / "000001.jpg")
    expect("000000.pt: 'c2w' must have the shape 3 x 4" in convert(folder, data, status=3), "a pose of another shape is not named")
    (data / "coordinates.pt").write_bytes(b"PK")
    expect("coordinates.pt: cannot be read by PyTorch" in convert(folder, data, status=3), "a damaged file is not named")


def trains_matrixcitys_form(skyquilt, hamlet, folder):
    data, project, tested = folder / "aerial", folder / "city", []
    model = data / "pose" / "block_A"
    model.mkdir(parents=True)
    hamlet.write_ply(model / "points.ply", scale=0.01)
    for part, block in (("test", "block_1_test"), ("train", "block_1")):
        file = {"fl_x": hamlet.focal, "fl_y": hamlet.focal, "k1": hamlet.k1, "cx": WIDTH / 2, "cy": HEIGHT / 2, "w": WIDTH, "h": HEIGHT, "ply_file_path": "points.ply",
                "frames": []}
        for i, camera in enumerate(hamlet.cameras):
            if (i % TEST_EVERY == 0) != (part == "test"):
                continue
            name = f"{part}/{block}/{i:04}.png"
            hamlet.copy_photo(i, folder / "photo.jpg")
            (data / name).parent.mkdir(parents=True, exist_ok=True)
            subprocess.run(["ffmpeg", "-v", "error", "-i", str(folder / "photo.jpg"), "-y", str(data / name)], check=True)
            matrix = [row[:3] + [0.01 * row[3]] for row in camera] + [[0.0, 0.0, 0.0, 1.0]]
            file["frames"].append({"file_path": f"../../{name}", "transform_matrix": matrix})
            tested += [name] if part == "test" else []
        (model / f"transforms_{part}.json").write_text(json.dumps(file))
    skyquilt.call("prepare", data, "--model", model, "-o", project, says=["data set MatrixCity", "6 of 28 photos are held out"])
    expect(held_out(surveyed(project)) == sorted(tested), "other photos than those of the split are held out")
    trains(skyquilt, project, tested)


def test(skyquilt, folder):
    hamlet = Hamlet(small_survey(skyquilt))
    trains_blenders_form(skyquilt, hamlet, folder)
    prepares_llffs_form(skyquilt, hamlet, folder)
    converts_mega_nerfs_form(skyquilt, hamlet, folder)
    trains_matrixcitys_form(skyquilt, hamlet, folder)


main(test)
