"""`prepare --gcp` on a simulated survey: poses from photos in the fast way, then the same reconstruction placed by ten control points and judged by ten
check points, with tags that are wrong by tens of metres and with none, from the files of all programs and in US survey feet, with a wrong point, and
with files that cannot be used. Then a scene is trained, and the targets are searched in its maps. Skipped where COLMAP is missing.

    control.py skyquilt [place]      another place than the hamlet"""
import json
import math
import os
import pathlib
import shutil
import subprocess
import sys

from foreign_readers import Raster, transformed
from harness import expect, main
from targets import find_target

SKIPPED = 77
PLACE = sys.argv[2] if len(sys.argv) > 2 else "hamlet"
SEEN = 0.15  # contrast of a target's fields in a map; beside targets it is less
SIMULATE = ["--image-width", "640", "--seed", "3", "--set", "simulate.latitude_deg=40.7", "--set", "simulate.longitude_deg=-74.0", "--set",
            "simulate.height_m=20", "--set", "simulate.gps_noise_m=2", "--set", "simulate.tag_bias_m=15", "--set", "simulate.control_points=10",
            "--set", "simulate.check_points=10"]


def survey_of(project):
    return json.loads((project / "survey" / "survey.json").read_text())


def points_of(project, use=None):
    return [point for point in survey_of(project)["control"]["points"] if use is None or point["use"] == use]


def earth(latitude_deg, longitude_deg, height_m):
    """Earth-centred coordinates on WGS84."""
    a, e2 = 6378137.0, 0.00669437999014
    latitude, longitude = math.radians(latitude_deg), math.radians(longitude_deg)
    n = a / math.sqrt(1.0 - e2 * math.sin(latitude) ** 2)
    return ((n + height_m) * math.cos(latitude) * math.cos(longitude), (n + height_m) * math.cos(latitude) * math.sin(longitude),
            (n * (1.0 - e2) + height_m) * math.sin(latitude))


def expect_accurate(project, what):
    """The issue's limits for check points: 1 GSD horizontally, 1.5 GSD vertically, and errors within 1.96 of their stated sigma."""
    checks = points_of(project, "check")
    expect(len(checks) == 10, f"{what}: {len(checks)} check points instead of 10")
    gsd = sum(point["gsd_m"] for point in checks) / len(checks)
    errors = [point["error_m"] for point in checks]
    horizontal = math.sqrt(sum(e[0] ** 2 + e[1] ** 2 for e in errors) / len(errors)) / gsd
    vertical = math.sqrt(sum(e[2] ** 2 for e in errors) / len(errors)) / gsd
    within = sum(abs(e) <= 1.96 * s for point in checks for e, s in zip(point["error_m"], point["sigma_m"]))
    print(f"{what}: check points {horizontal:.2f} GSD horizontally, {vertical:.2f} GSD vertically, {within} of {3 * len(checks)} errors within 1.96 sigma")
    expect(horizontal <= 1.0, f"{what}: {horizontal:.2f} GSD horizontally")
    expect(vertical <= 1.5, f"{what}: {vertical:.2f} GSD vertically")
    # 95 % of 30: fewer than 25 come by chance less than once in a hundred.
    expect(within >= 25, f"{what}: only {within} of {3 * len(checks)} errors are within 1.96 of their sigma")


def without_tags(source, target):
    """A JPEG without its EXIF and XMP."""
    data = source.read_bytes()
    kept, at = [data[:2]], 2
    while data[at + 1] != 0xDA:
        size = 2 + int.from_bytes(data[at + 2:at + 4], "big")
        if data[at + 1] != 0xE1:
            kept.append(data[at:at + size])
        at += size
    target.write_bytes(b"".join(kept) + data[at:])


def in_feet(text):
    """gcp_list.txt in UTM as one in EPSG:2263, transformed by PROJ's cs2cs through GDAL."""
    rows = [line.split() for line in text.splitlines()]
    source = rows[0][0]
    plane = "\n".join(" ".join(row[:2]) for row in rows[1:]) + "\n"
    moved = subprocess.run(["gdaltransform", "-s_srs", source, "-t_srs", "EPSG:2263", "-output_xy"], input=plane, capture_output=True, text=True,
                           check=True).stdout.splitlines()
    foot_m = 1200.0 / 3937.0
    lines = ["EPSG:2263"]
    for row, xy in zip(rows[1:], moved):
        lines.append(" ".join([*xy.split()[:2], f"{float(row[2]) / foot_m:.5f}", *row[3:]]))
    return "\n".join(lines) + "\n"


def expect_in_maps(skyquilt, project, truth):
    """Orthophoto and surface model have the targets within 1 GSD of their coordinates, root mean square over the points."""
    skyquilt.call("partition", project, "--blocks", "1x1")
    skyquilt.call("train", project, "--set", "context.steps=600", "--set", "train.steps=800", "--set", "train.batch_samples=16384",
                  "--set", "context.batch_samples=16384")
    skyquilt.call("merge", project)
    skyquilt.call("render", project, "--ortho", "--dsm", "--resolution", "0.1")
    picture, surface = Raster(project / "products" / "orthophoto.tif", band=2), Raster(project / "products" / "dsm.tif")
    expect(surface.crs() == truth["crs"], f"dsm.tif is in '{surface.crs()}'")
    gsd = sum(point["gsd_m"] for point in points_of(project)) / len(points_of(project))
    true = transformed([(p["longitude_deg"], p["latitude_deg"], 0.0) for p in truth["points"]], "EPSG:4326", truth["crs"])
    off, heights, unseen = [], [], []
    for point, (easting, northing, *_) in zip(truth["points"], true, strict=True):
        found, east, north = find_target(picture, easting, northing, point["side_m"], 3.0 * gsd)
        height = surface.at(easting, northing) - point["height_m"]
        if found < SEEN or math.isnan(height):
            unseen.append(point["label"])
            continue
        off.append(math.hypot(east, north))
        heights.append(height)
    plan, up = (math.sqrt(sum(value ** 2 for value in values) / max(1, len(values))) / gsd for values in (off, heights))
    print(f"maps: {len(off)} targets off by {plan:.2f} GSD in the orthophoto, {up:.2f} GSD in the surface model; not seen: {unseen}")
    expect(len(off) >= 0.8 * len(true), f"targets that the maps do not show: {unseen}")
    blank = sorted(find_target(picture, easting + 5.0, northing, truth["points"][0]["side_m"], 3.0 * gsd)[0] for easting, northing, *_ in true)
    expect(blank[len(blank) // 2] < SEEN, f"targets are seen beside their places: {blank}")
    expect(plan <= 1.0 and up <= 1.0, f"targets are off by {plan:.2f} GSD in the orthophoto, {up:.2f} GSD in the surface model")


def test(skyquilt, folder):
    skyquilt.call("simulate", PLACE, "-o", folder / "survey", *SIMULATE)
    photos, control = folder / "survey" / "images", folder / "survey" / "control"
    checks = ",".join((control / "check_points.txt").read_text().split())
    skyquilt.call("prepare", photos, "-o", folder / "poses")
    log = (folder / "poses" / "log.txt").read_text() if (folder / "poses" / "log.txt").exists() else ""
    models = [path.parent for path in sorted((folder / "poses" / "survey" / "colmap").rglob("images.bin"))]
    expect(models, f"no reconstruction was found:\n{log}")
    model = models[0]

    def prepare(name, *words, source=photos, status=0):
        return skyquilt.call("prepare", source, "-o", folder / name, "--model", model, "--set", "products.preview=false", *words, status=status)

    # Tags that are all wrong by some 20 m, none, and a point that is wrong by 5 m.
    gcp = control / "gcp_list.txt"
    prepare("tags", "--gcp", gcp, "--check-points", checks)
    expect_accurate(folder / "tags", "wrong tags")
    expect(len(points_of(folder / "tags", "control")) == 10, "not all control points are used")
    expect(survey_of(folder / "tags")["height_reference"] == "ellipsoid", "heights from control points are not ellipsoidal")
    for name in ("geo_control.csv", "control.geojson"):
        text = (folder / "tags" / "survey" / name).read_text()
        expect(all(point["label"] in text for point in points_of(folder / "tags")), f"{name} lacks points")
    bare = folder / "bare"
    bare.mkdir()
    for photo in photos.iterdir():
        without_tags(photo, bare / photo.name)
    prepare("no_tags", "--gcp", gcp, "--check-points", checks, source=bare)
    expect(survey_of(folder / "no_tags")["georeferenced"], "control points do not place photos without tags")
    expect_accurate(folder / "no_tags", "no tags")
    rows = gcp.read_text().splitlines()
    wrong = folder / "wrong.txt"
    label = next(point["label"] for point in points_of(folder / "tags", "control"))
    moved = [" ".join([f"{float(row.split()[0]) + 4.0:.4f}", f"{float(row.split()[1]) - 3.0:.4f}", *row.split()[2:]]) if row.split()[-1] == label else row
             for row in rows]
    wrong.write_text("\n".join(moved) + "\n")
    text = prepare("wrong", "--gcp", wrong, "--check-points", checks)
    expect([point["label"] for point in points_of(folder / "wrong", "rejected")] == [label], "the wrong control point is not found")
    expect(any(label in problem["finding"] for problem in survey_of(folder / "wrong")["problems"]) and label in text, "the wrong point is not named")
    expect_accurate(folder / "wrong", "a control point wrong by 5 m")

    # The same points in the forms of other programs, and in feet: the same survey to a millimetre.
    feet = folder / "feet.txt"
    feet.write_text(in_feet(gcp.read_text()))
    truth = json.loads((control / "truth.json").read_text())
    crs = ["--set", f"prepare.gcp_crs={truth['crs']}"]
    forms = {"opensfm": ["--gcp", control / "ground_control_points.json"],
             "pix4d": ["--gcp", control / "pix4d.csv", "--set", f"prepare.gcp_marks={control / 'pix4d_marks.csv'}", *crs],
             "metashape": ["--gcp", control / "metashape.csv", "--set", f"prepare.gcp_marks={control / 'metashape_marks.xml'}", *crs],
             "feet": ["--gcp", feet]}
    wanted = survey_of(folder / "tags")
    for name, words in forms.items():
        prepare(name, *words, "--check-points", checks)
        found = survey_of(folder / name)
        apart = max(abs(a - b) for one, other in zip(points_of(folder / "tags"), points_of(folder / name), strict=True)
                    for a, b in zip(one["error_m"], other["error_m"]))
        # Errors agree and so do places: so do the results.
        places = math.dist(earth(*(wanted["origin"][key] for key in ("latitude_deg", "longitude_deg", "height_m"))),
                           earth(*(found["origin"][key] for key in ("latitude_deg", "longitude_deg", "height_m"))))
        given = max(math.dist(one["given_in_enu_m"], other["given_in_enu_m"])
                    for one, other in zip(points_of(folder / "tags"), points_of(folder / name), strict=True))
        print(f"{name}: errors differ by {1e3 * apart:.3f} mm, places by {1e3 * given:.3f} mm, origins by {1e3 * places:.3f} mm")
        expect(max(apart, given, places) <= 1e-3, f"{name}: another result than with gcp_list.txt")

    # Files that cannot be used, or only in part.
    def faulty(name, lines, line, words, source=photos, status=3):
        file = folder / f"{name}.txt"
        file.write_text("\n".join(lines) + "\n")
        text = prepare(f"fault_{name}", "--gcp", file, source=source, status=status)
        for word in [*words, *([f"line {line}"] if line else [])]:
            expect(word in text, f"{name}: the message does not say '{word}':\n{text}")

    missing = rows.copy()
    missing[1] = " ".join([*missing[1].split()[:5], "not_there.jpg", *missing[1].split()[6:]])
    faulty("missing_photo", missing, 2, ["not_there.jpg"], status=0)
    outside = rows.copy()
    outside[2] = " ".join([*outside[2].split()[:3], "99999", *outside[2].split()[4:]])
    faulty("outside", outside, 3, ["99999"])
    twice = rows.copy()
    twice[1] = " ".join([f"{float(twice[1].split()[0]) + 30.0:.4f}", *twice[1].split()[1:]])
    faulty("twice", twice, 2, [twice[1].split()[-1]])
    faulty("zone", ["EPSG:32633", *rows[1:]], 2, ["km"])
    labels = []
    for row in rows[1:]:
        if row.split()[-1] not in labels and not row.split()[-1].startswith("check"):
            labels.append(row.split()[-1])
    two = [rows[0]] + [row for row in rows[1:] if row.split()[-1] in labels[:2]]
    faulty("two_points", two, 0, ["only compared"], status=0)
    faulty("two_points_alone", two, 0, ["three"], source=bare)
    start = rows[1].split()[:2]
    lined = [rows[0]]
    for row in rows[1:]:
        if row.split()[-1] in labels[:4]:
            index = labels.index(row.split()[-1])
            lined.append(" ".join([f"{float(start[0]) + 9.0 * index:.4f}", f"{float(start[1]) + 5.0 * index:.4f}", *row.split()[2:]]))
    faulty("line", lined, 0, ["line"], source=bare)
    empty = folder / "empty.txt"
    empty.write_text("")
    text = prepare("fault_empty", "--gcp", empty, status=3)
    expect("empty.txt" in text, f"an empty file is not named:\n{text}")
    prepare("fault_absent", "--gcp", folder / "absent.txt", status=3)

    expect_in_maps(skyquilt, folder / "tags", truth)


if __name__ == "__main__":
    if shutil.which("colmap") is None or shutil.which("gdaltransform") is None:
        print("skipped: COLMAP or GDAL's programs are missing")
        raise SystemExit(SKIPPED)
    main(test)
