"""A photo folder as drones, disks and other programs leave it: everything that is no photo is named and left out, wrong tags are repaired, and the survey
is that of the clean folder. Then folders and files that cannot be used, with what to do about them."""
import csv
import json
import math
import pathlib
import shutil
import struct
import sys

from harness import expect, main, small_survey

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))
from tag_faults import edit_photo, set_xmp, xmp_value  # noqa: E402


def survey_of(project):
    return json.loads((project / "survey" / "survey.json").read_text())


def zero_altitude(tag, tiff, at, order):
    if tag == 6:  # GPSAltitude, a rational
        struct.pack_into(order + "I", tiff, struct.unpack_from(order + "I", tiff, at)[0], 0)


def leave(*_):
    pass


def spoil(folder):
    """Files that are no photos, and tags of three kinds that drones and programs write wrongly."""
    images = folder / "images"
    photos = sorted(images.glob("*.jpg"))
    (images / "@eaDir").mkdir()
    shutil.copy(photos[0], images / "@eaDir" / "SYNOPHOTO_THUMB_M.jpg")
    shutil.copy(photos[1], images / f"._{photos[1].name}")
    shutil.copy(photos[2], images / f"{photos[2].stem}_T.jpg")
    (images / f"{photos[3].stem}.HEIC").write_bytes(b"heic")
    (images / f"{photos[4].stem}.DNG").write_bytes(b"raw")
    earlier = images / "earlier"
    (earlier / "products").mkdir(parents=True)
    shutil.copy(photos[5], earlier / "products" / "ortho.jpg")
    (earlier / "blocks.geojson").write_text("{}")
    (folder / "masks").mkdir()
    for photo in photos[:6]:  # all white: a grey picture of its size
        shutil.copy(folder / "white.png", folder / "masks" / f"{photo.name}.png")
    for i, photo in enumerate(photos):
        def turned(text, drop=i % 3 == 0):
            text = set_xmp(text, "GimbalPitchDegree", -xmp_value(text, "GimbalPitchDegree"))
            return set_xmp(text, "AbsoluteAltitude", 0.0) if drop else text
        edit_photo(photo, zero_altitude if i % 3 == 0 else leave, turned)
    return len(photos)


def white_png(width, height):
    """A grey PNG, uncompressed but for zlib's frame."""
    import zlib

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = b"".join(b"\0" + b"\xff" * width for _ in range(height))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def apart(one, other):
    """Largest distance between cameras of two surveys of nearly the same origin, metres."""
    def centre(photo):
        w, x, y, z = photo["rotation_wxyz"]
        t = photo["translation_m"]
        rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
        return [-sum(rows[k][axis] * t[k] for k in range(3)) for axis in range(3)]
    places = {photo["name"]: centre(photo) for photo in one["photos"]}
    return max(math.dist(places[photo["name"]], centre(photo)) for photo in other["photos"])


def test(skyquilt, folder):
    source = small_survey(skyquilt)
    for name in ("clean", "spoilt"):
        shutil.copytree(source / "images", folder / name / "images")
        shutil.copytree(source / "sparse", folder / name / "sparse")

    def prepare(name, *words, status=0):
        return skyquilt.call("prepare", folder / name / "images", "-o", folder / f"{name}_out", "--model", folder / name / "sparse/0", *words, status=status)

    prepare("clean")
    clean = survey_of(folder / "clean_out")
    camera = clean["cameras"][0]
    (folder / "spoilt" / "white.png").write_bytes(white_png(camera["width"], camera["height"]))
    n = spoil(folder / "spoilt")
    text = prepare("spoilt")
    found = survey_of(folder / "spoilt_out")
    expect([photo["name"] for photo in found["photos"]] == [photo["name"] for photo in clean["photos"]], "other photos are taken than from the clean folder")
    expect(found["georeferenced"] and apart(clean, found) < 1.0, f"the cameras are {apart(clean, found)} m from those of the clean folder")
    expect(not found["problems"], f"problems: {found['problems']}")
    for words in ("opposite sign", "from RelativeAltitude", "earlier/", f"{n} photos are taken"):
        expect(words in text, f"the log does not say '{words}':\n{text}")
    with (folder / "spoilt_out" / "survey" / "input.csv").open(newline="") as table:
        rows = list(csv.DictReader(table))
    taken = [row for row in rows if row["taken"] == "yes"]
    left = [row["file"] for row in rows if row["taken"] == "no"]
    expect(len(taken) == n and sum(bool(row["mask"]) for row in taken) == 6, f"{len(taken)} photos with {sum(bool(row['mask']) for row in taken)} masks")
    expect(all(row["reason"] for row in rows if row["taken"] == "no"), "files are left out without a reason")
    for name in ("_T.jpg", ".HEIC", ".DNG", "earlier/"):
        expect(any(name in file for file in left), f"{name} is not listed: {left}")

    # A choice of one's own, one that chooses nothing, and a folder of pictures that nothing here can read.
    text = prepare("clean", "--set", "prepare.photos=*_000?.jpg", "--restart")
    expect(0 < len(survey_of(folder / "clean_out")["photos"]) < n, text)
    text = prepare("clean", "--set", "prepare.photos=*.bmp", "--restart", status=3)
    expect("prepare.photos" in text and "*.bmp" in text, text)
    raw = folder / "raw"
    raw.mkdir()
    (raw / "IMG_1.X3F").write_bytes(b"raw")
    text = skyquilt.call("prepare", raw, "-o", folder / "raw_out", status=3)
    expect("darktable-cli" in text, f"there is no advice how to convert the photos:\n{text}")
    for name in ("IMG_1.HEIC", "IMG_2.DNG", "IMG_3.heic"):
        (raw / name).write_bytes(b"damaged")
    text = skyquilt.call("prepare", raw, "-o", folder / "raw_out_2", status=3)
    expect("IMG_1.HEIC" in text and "IMG_2.DNG" in text, f"damaged photos are not named:\n{text}")

    # Two zones as one survey; zones that cannot be.
    north, south = folder / "north", folder / "south"
    for zone, half in ((north, 0), (south, 1)):
        zone.mkdir()
        for photo in sorted((folder / "clean" / "images").glob("IMG_*.jpg"))[half::2]:
            shutil.copy(photo, zone / photo.name)
    no_poses = ["--set", "prepare.colmap=no-such-program"]
    skyquilt.call("prepare", north, south, "-o", folder / "zones_out", *no_poses, status=3, says=["2 zones: north, south", "no-such-program"])
    with open(folder / "zones_out" / "survey" / "input.csv", newline="") as table:
        names = [row["file"] for row in csv.DictReader(table) if row["taken"] == "yes"]
    expect(len(names) == n and {name.split("/")[0] for name in names} == {"north", "south"}, f"other photos of two zones: {names}")
    skyquilt.call("prepare", north, north, "-o", folder / "twice_out", status=2, says="given twice")
    skyquilt.call("prepare", north, south, "-o", north / "out", status=2, says="project folder")
    skyquilt.call("prepare", north, folder / "none", "-o", folder / "none_out", status=3, says="no such folder")

    # A table of positions as spreadsheets write them, with axes exchanged.
    lines = ["photo;lat;lon;height"]
    for photo in sorted((folder / "spoilt" / "images").glob("IMG_*.jpg")):
        if photo.stem.endswith("_T"):
            continue
        values = {}

        def read(text, values=values):
            values.update(x=xmp_value(text, "GpsLongitude"), y=xmp_value(text, "GpsLatitude"))
            return text
        copy = folder / "read.jpg"
        shutil.copy(folder / "clean" / "images" / photo.name, copy)
        edit_photo(copy, leave, read)
        lines.append(f'"C:\\flight one\\{photo.stem}.JPG";{values["y"]:.8f};{values["x"]:.8f};NaN'.replace(".", ",").replace(",JPG", ".JPG"))
    (folder / "clean" / "images" / "geo.txt").write_bytes(b"\xef\xbb\xbfEPSG:4326\r\n" + "\r\n".join(lines).encode() + b"\r\n")
    prepare("clean", "--restart")
    expect(survey_of(folder / "clean_out")["georeferenced"], "positions of a table with headings are not used")


if __name__ == "__main__":
    main(test)
