"""Held-out photos leave no trace in a scene: with other pixels in them, or with other poses and other observations of points, everything from the
sparse points to the textures of the surface is the same to the last bit. Only what tells of the held-out photos themselves may differ.
(Structure from motion is not part of it: the simulated survey has poses and points.)"""
import dataclasses
import hashlib
import json
import math

from colmap_files import read_images, read_points, write_images, write_points
from harness import arrays_of, copied, expect, main, prepare_small, small_project, small_survey, state_of

TRAIN = ["--steps", "150", "--set", "train.batch_samples=4096", "--set", "context.batch_samples=4096"]
# Coarse, but with every step that reads photos or looks from their places.
SURFACE = [word for option in ("voxel_gsd=3", "view_gsd=4", "texel_gsd=4", "obj=false", "tiles=false", "maps=false")
           for word in ("--set", f"surface.{option}")]
EVERY = 8  # the default of --holdout: photo i in name order with i % 8 == 0
MOVED_M, TURNED_DEG = (6.0, -4.0, 9.0), 12.0


def held_out(names):
    return sorted(names)[::EVERY]


def parts_of(jpeg):
    """Segments before the scan as (marker, bytes), and the rest."""
    expect(jpeg[:2] == b"\xff\xd8", "a photo is not a JPEG file")
    segments, at = [], 2
    while jpeg[at + 1] != 0xDA:
        end = at + 2 + int.from_bytes(jpeg[at + 2:at + 4], "big")
        segments.append((jpeg[at + 1], jpeg[at:end]))
        at = end
    return segments, jpeg[at:]


def with_pixels_of(photo, other):
    """The tags of one photo, the picture of another."""
    def is_tag(marker):
        return 0xE0 <= marker <= 0xEF

    tags = [segment for marker, segment in parts_of(photo)[0] if is_tag(marker)]
    segments, scan = parts_of(other)
    return b"\xff\xd8" + b"".join(tags) + b"".join(segment for marker, segment in segments if not is_tag(marker)) + scan


def with_other_pixels(survey):
    """Every held-out photo shows what a photo of another place shows."""
    photos = sorted((survey / "images").iterdir())
    given = {photo.name: photo.read_bytes() for photo in photos}
    names = list(given)
    for name in held_out(names):
        other = names[(names.index(name) + len(names) // 2 + 1) % len(names)]
        (survey / "images" / name).write_bytes(with_pixels_of(given[name], given[other]))
    return survey


def product(a, b):
    """Of quaternions, w x y z."""
    return (a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
            a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0])


def rotated(q, v):
    return product(product(q, (0.0, *v)), (q[0], -q[1], -q[2], -q[3]))[1:]


def moved(image):
    """An image with another pose and no observations. x_in_camera = rotation x + translation."""
    shift = rotated(image.rotation, MOVED_M)  # of the camera by MOVED_M: x_in_camera = rotation (x - MOVED_M) + translation
    half = math.radians(TURNED_DEG) / 2.0
    turn = (math.cos(half), 0.0, math.sin(half), 0.0)
    translation = rotated(turn, [t - s for t, s in zip(image.translation, shift)])
    return dataclasses.replace(image, rotation=product(turn, image.rotation), translation=translation, observations=b"")


def with_other_poses(survey):
    """Held-out photos stand and look elsewhere. Half of the points are no longer seen by any of them, the others by all."""
    model = survey / "sparse" / "0"
    images = read_images(model / "images.bin")
    chosen = held_out(image.name for image in images)
    ids = [image.id for image in images if image.name in chosen]
    expect(len(ids) == len(chosen) > 2, f"the model has poses of {ids}")
    write_images(model / "images.bin", [moved(image) if image.id in ids else image for image in images])

    points = read_points(model / "points3D.bin")
    for number, point in enumerate(points):
        point.track = [seen for seen in point.track if seen[0] not in ids] + [(image_id, 0) for image_id in ids if number % 2]
    write_points(model / "points3D.bin", points)
    return survey


def survey_of(project):
    folder = project / "survey"
    survey = json.loads((folder / "survey.json").read_text())
    expect(survey["n_points"] > 1000, f"{project} has only {survey['n_points']} points")
    found = {f"survey.json {photo['name']}": photo for photo in survey.pop("photos")}
    # Where the photos lie differs between copies of a survey.
    found |= {f"survey.json {key}": value for key, value in survey.items() if key not in ("photo_root", "truth")}
    return found | files_in(folder, but="survey.json")


def blocks_of(project):
    blocks = json.loads((project / "blocks.geojson").read_text())
    found = {f"blocks.geojson {key}": value for key, value in blocks.items() if key != "features" and not key.endswith("config_hash")}
    for feature in blocks["features"]:
        properties = feature["properties"]
        found |= {f"blocks.geojson {properties['name']} {key}": value for key, value in properties.items()}
    return found


def surface_of(project):
    folder = project / "surface"
    table = json.loads((folder / "surface.json").read_text())
    expect(table["triangles"] > 500 and table["points"] > 500, f"{project} has hardly any surface: {table}")
    return {f"surface.json {key}": value for key, value in table.items() if "seconds" not in key} | files_in(folder, but="surface.json")


def files_in(folder, but):
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.iterdir() if path.is_file() and path.name != but}


def fields_of(skyquilt, project):
    files = state_of(skyquilt, project) | {"scene.h5": arrays_of(skyquilt, project / "scene.h5")[0]}
    return {f"{file} {array}": digest for file, arrays in files.items() for array, digest in arrays.items()}


def results_of(skyquilt, project):
    """Trains a prepared project and makes its surface. Every result by name."""
    skyquilt.call("train", project, *TRAIN)
    skyquilt.call("merge", project)
    skyquilt.call("surface", project, *SURFACE)
    return survey_of(project) | blocks_of(project) | surface_of(project) | fields_of(skyquilt, project)


def tells_of_poses(name, chosen):
    """Whether a result tells of the poses of the chosen photos, of how well all poses agree with the tags, or of who observed the points that are
    kept for scores. Nothing that leads to a scene reads it."""
    survey = [*chosen, "fit", "checks", "problems", "n_observations"]
    return name in [f"survey.json {key}" for key in survey] + ["tracks.bin", "geo_residuals.csv", "cameras.geojson"]


def different(found, wanted):
    return sorted(name for name in found.keys() | wanted.keys() if found.get(name) != wanted.get(name))


def prepared_for_all(skyquilt, survey, project):
    """Points and directions where no photo is held out."""
    skyquilt.call("prepare", survey, "-o", project, "--holdout", "none")
    return {name: (project / "survey" / name).read_bytes() for name in ("points.ply", "directions.json")}


def test(skyquilt, folder):
    survey = small_survey(skyquilt)
    chosen = held_out(photo.name for photo in (survey / "images").iterdir())
    pixels = with_other_pixels(copied(survey, folder / "pixels"))
    poses = with_other_poses(copied(survey, folder / "poses"))

    # Where no photo is held out, the same changes are seen.
    given = prepared_for_all(skyquilt, survey, folder / "all")
    for changed, files in ((pixels, ["directions.json"]), (poses, ["directions.json", "points.ply"])):
        found = different(prepared_for_all(skyquilt, changed, folder / f"all_{changed.name}"), given)
        expect(found == files, f"without held-out photos, other {changed.name} change {found}, not {files}")

    wanted = results_of(skyquilt, small_project(skyquilt, folder / "given"))
    faults = []
    for changed in (pixels, poses):
        project = prepare_small(skyquilt, changed, folder / f"other_{changed.name}")
        names = different(results_of(skyquilt, project), wanted)
        faults += [f"other {changed.name}: {name}" for name in names if changed is pixels or not tells_of_poses(name, chosen)]
    expect(not faults, "\n  ".join([f"{len(faults)} results depend on held-out photos", *faults]))


main(test)
