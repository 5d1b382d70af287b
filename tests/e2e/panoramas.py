"""Panoramas as input: simulated ones become views, and the views of one place get one pose. Then several cameras on a rig, held-out photos, a kill while
panoramas are cut, files of rigs with faults."""
import csv
import json
import math
import shutil
import sys

from harness import expect, kill_group, main, shared, wait_for

NO_POSES = ["--set", "prepare.colmap=no-such-program"]  # ends after the views, with status 3
VIEWS = ["--set", "prepare.panorama_width=240"]


def survey_of(project):
    return json.loads((project / "survey" / "survey.json").read_text())


def views_of(project):
    """Without the hidden file that is being written."""
    views = (project / "survey" / "views").glob("*/*.jpg")
    return sorted(view for view in views if not view.name.startswith("."))


def rows_of(project):
    with open(project / "survey" / "views.csv", newline="") as table:
        return list(csv.DictReader(table))


def product(a, b):
    """Of rotations as quaternions w, x, y, z."""
    aw, ax, ay, az = a
    bw, bx, by, bz = b
    return [aw * bw - ax * bx - ay * by - az * bz, aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw]


def inverse(rotation):
    return [rotation[0], -rotation[1], -rotation[2], -rotation[3]]


def turned(rotation, vector):
    return product(product(rotation, [0.0, *vector]), inverse(rotation))[1:]


def angle_deg(a, b):
    relative = product(a, inverse(b))
    return math.degrees(2.0 * math.atan2(math.hypot(*relative[1:]), abs(relative[0])))


def centre(rotation, translation):
    return [-x for x in turned(inverse(rotation), translation)]


def rig_of(file):
    """Rotation cam_from_rig by prefix."""
    (rig,) = json.loads(file.read_text())
    return {camera["image_prefix"]: camera.get("cam_from_rig_rotation", [1.0, 0.0, 0.0, 0.0]) for camera in rig["cameras"]}


def shots_of(photos, rig):
    """By the name of the shot: rotation rig_from_enu and centre by each of its photos."""
    shots = {}
    for photo in photos:
        prefix = photo["name"].split("/")[0] + "/"
        rotation = product(inverse(rig[prefix]), photo["rotation_wxyz"])
        shots.setdefault(photo["name"].split("/", 1)[1], []).append((rotation, centre(photo["rotation_wxyz"], photo["translation_m"])))
    return shots


def expect_rigs_agree(shots, least_photos):
    for name, poses in shots.items():
        expect(len(poses) >= least_photos, f"only {len(poses)} photos of {name} have a pose")
        for rotation, place in poses[1:]:
            expect(angle_deg(rotation, poses[0][0]) < 0.05, f"poses of {name} differ by {angle_deg(rotation, poses[0][0])} degrees from their rig")
            expect(math.dist(place, poses[0][1]) < 1e-3, f"views of {name} are {math.dist(place, poses[0][1])} m apart")


def expect_like_truth(shots, survey):
    with open(survey / "truth" / "panorama_poses.csv", newline="") as table:
        truth = {row["name"]: ([float(row[f"rotation_{axis}"]) for axis in "wxyz"], [float(row[f"translation_{axis}_m"]) for axis in "xyz"])
                 for row in csv.DictReader(table)}
    names = sorted(shots)
    # Shape alone: tags of places that are so near each other say little about scale.
    apart = [(math.dist(centre(*truth[a]), centre(*truth[b])), math.dist(shots[a][0][1], shots[b][0][1])) for a, b in zip(names, names[1:])]
    scale = sum(wanted for wanted, _ in apart) / sum(got for _, got in apart)
    for a, b, (wanted, got) in zip(names, names[1:], apart):
        expect(abs(scale * got - wanted) < 0.15 + 0.05 * wanted, f"{a} and {b} are {scale * got:.2f} m apart, in truth {wanted:.2f} m")
        # The frame of the rig is that of the first view, which looks to the panorama's middle.
        wanted, got = product(truth[b][0], inverse(truth[a][0])), product(shots[b][0][0], inverse(shots[a][0][0]))
        expect(angle_deg(got, wanted) < 0.5, f"{a} and {b} are turned by {angle_deg(got, wanted)} degrees against the truth")


def check_poses(skyquilt, survey, folder):
    project = folder / "walk"
    said = skyquilt.call("prepare", survey / "panoramas", "-o", project, *VIEWS, "--holdout", "every:3", says=["panoramas became", "each with one pose"])
    rows, found = rows_of(project), survey_of(project)
    panoramas = sorted(file.name for file in (survey / "panoramas").glob("*.jpg"))
    expect(f"{len(panoramas)} panoramas became {12 * len(panoramas)} views" in said, "the numbers are not in the log")
    expect([row["view"] for row in rows if row["taken"] == "yes"] and sorted({row["panorama"] for row in rows}) == panoramas, "views.csv lacks panoramas")
    expect(len(rows) == 12 * len(panoramas) == len(views_of(project)), "views.csv lists other views than there are")
    expect(all(row["latitude_deg"] and row["gimbal_yaw_deg"] for row in rows), "views without tags")
    rig = rig_of(project / "survey" / "views" / "rig_config.json")
    shots = shots_of(found["photos"], rig)
    expect(len(shots) >= 0.9 * len(panoramas), f"{len(shots)} of {len(panoramas)} panoramas have a pose")
    expect_rigs_agree(shots, 12)
    expect_like_truth(shots, survey)
    tested = {}
    for photo in found["photos"]:
        tested.setdefault(photo["name"].split("/", 1)[1], set()).add(photo["is_test"])
    expect(all(len(values) == 1 for values in tested.values()), "views of one panorama are held out apart")
    expect(0 < sum(values == {True} for values in tested.values()) < len(tested), "no panorama is held out, or all")
    expect({camera["model"] for camera in found["cameras"]} == {"PINHOLE"}, "views have a lens that was adjusted")
    skyquilt.call("prepare", survey / "panoramas", "-o", project, *VIEWS, "--holdout", "every:3", says="up to date")
    return project


def check_rig(skyquilt, project, folder):
    """The level views of each place as photos of four cameras of a rig that the user describes. They do not overlap."""
    photos = folder / "rig"
    (entries,) = json.loads((project / "survey" / "views" / "rig_config.json").read_text())
    cameras = [camera for camera in entries["cameras"] if int(camera["image_prefix"][9:11]) < 4]
    for camera in cameras:
        shutil.copytree(project / "survey" / "views" / camera["image_prefix"], photos / camera["image_prefix"])
    file = photos / "rig_config.json"
    file.write_text(json.dumps([{"cameras": cameras}]))
    skyquilt.call("prepare", photos, "-o", folder / "of_rig", says=["of a rig", "each with one pose"])
    shots = shots_of(survey_of(folder / "of_rig")["photos"], rig_of(file))
    expect_rigs_agree(shots, 4)
    file.write_text('[{"cameras": [{"image_prefix": "pano_view00/"}]}]')
    skyquilt.call("prepare", photos, "-o", folder / "no_rotation", status=3, says=["rig_config.json", "cam_from_rig_rotation", "line 1"])
    file.write_text('[{"cameras": [{"image_prefix": "left/", "ref_sensor": true}]}]')
    skyquilt.call("prepare", photos, "-o", folder / "no_such_photos", status=3, says=["image_prefix", "pano_view00/"])
    skyquilt.call("prepare", photos, "-o", folder / "no_program", "--rig", "none", *NO_POSES, status=3, says="no-such-program")


def check_kill(skyquilt, survey, folder):
    """A kill while panoramas are cut leaves whole views; the same command finishes them."""
    cut = ["prepare", survey / "panoramas", "--set", "prepare.panorama_width=400", "--nadir-mask", "30", *NO_POSES]
    skyquilt.call(*cut, "-o", folder / "whole", status=3)
    whole = {str(view.relative_to(folder / "whole")): view.read_bytes() for view in views_of(folder / "whole")}
    masks = sorted(mask.name for mask in (folder / "whole" / "survey" / "view_masks").glob("*/*.png"))
    expect(len(masks) == len(whole) / 3, f"{len(masks)} masks of the nadir for {len(whole)} views")
    killed = folder / "killed"
    for least in (1, len(whole) // 2):
        process = skyquilt.start(*cut, "-o", killed)
        wait_for(lambda: len(views_of(killed)) >= least, f"{least} views", process)
        kill_group(process)
        expect(all(view.read_bytes()[-2:] == b"\xff\xd9" for view in views_of(killed)), "a kill left half a view")
        expect(not (killed / "survey" / "views.csv").exists() or len(views_of(killed)) == len(whole), "the table is there before the views")
    skyquilt.call(*cut, "-o", killed, status=3)
    expect(not list((killed / "survey" / "views").rglob(".*")), "an unfinished view is left")
    expect({str(view.relative_to(killed)): view.read_bytes() for view in views_of(killed)} == whole, "views after kills differ from those of one go")
    skyquilt.call(*cut, "-o", killed, status=3, says="already cut")


def test(skyquilt, folder):
    if shutil.which("colmap") is None:
        print("skipped: no colmap")
        sys.exit(77)
    survey = shared(skyquilt, "panoramas", lambda made: skyquilt.call(
        "simulate", "hamlet", "-o", made, "--flight", "street", "--panoramas", "--image-width", "64", "--set", "simulate.tags=all", "--set",
        "simulate.panorama_width=768", "--set", "simulate.panoramas=6", "--set", "simulate.photos=8"))
    project = check_poses(skyquilt, survey, folder)
    check_rig(skyquilt, project, folder)
    check_kill(skyquilt, survey, folder)


if __name__ == "__main__":
    main(test)
