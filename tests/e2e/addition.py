"""A zone that is added to a finished project: the poses that it has stay, blocks that no added photo shows keep their training, others are trained; a run
that is killed meanwhile goes on. Skipped where COLMAP is missing."""
import json
import shutil
import sys

from harness import SMALL, expect, hamlet, kill_group, main, metrics_of, replaced, wait_for

SKIPPED = 77
OPTIONS = replaced(replaced(SMALL, "--blocks", "1x3"), "--steps", "60") + ["--set", "products.ortho=false", "--set", "products.dsm=false"]


def zones_of(skyquilt, survey, folder):
    """The photos west and east of a line; the exact survey says where they are."""
    skyquilt.call("prepare", survey, "-o", folder / "exact")
    features = json.loads((folder / "exact" / "survey" / "cameras.geojson").read_text())["features"]
    east = {f["properties"]["name"]: f["geometry"]["coordinates"][0] for f in features}
    line = sorted(east.values())[int(0.55 * len(east))]
    for name, longitude in east.items():
        zone = folder / ("west" if longitude < line else "east")
        zone.mkdir(exist_ok=True)
        shutil.copy2(survey / "images" / name, zone / name)
    return folder / "west", folder / "east"


def poses_of(project):
    survey = json.loads((project / "survey" / "survey.json").read_text())
    return {photo["name"].split("/")[-1]: (photo["rotation_wxyz"], photo["translation_m"], photo["is_test"])
            for photo in survey["photos"]}, survey["origin"]


def test(skyquilt, folder):
    west, east = zones_of(skyquilt, hamlet(skyquilt, 480), folder)
    project = folder / "project"
    skyquilt.call("run", east, "-o", project, "--add", status=3)
    skyquilt.call("run", west, "-o", project, *OPTIONS)
    before, origin = poses_of(project)
    kept = (project / "checkpoints" / "block_r0c0.h5").read_bytes()
    skyquilt.call("run", west, east, "-o", project, *OPTIONS, status=2, says="--add")

    process = skyquilt.start("run", east, "-o", project, "--add")
    begun, block = project / ".state" / "before" / ".state" / "checkpoints.json", project / "checkpoints" / "block_r0c2.h5"
    wait_for(lambda: begun.exists() and block.exists() and block.stat().st_mtime > begun.stat().st_mtime, "first block of the addition", process)
    kill_group(process)
    expect(not json.loads((project / ".state" / "train.json").read_text()).get("finished_utc"), "the run was over before it could be killed")
    skyquilt.call("run", east, "-o", project, "--add", says="keep their training: r0c0")

    after, origin_after = poses_of(project)
    expect(origin == origin_after, "the frame has moved")
    for name, pose in before.items():
        expect(after[name] == pose, f"the pose of {name} has changed")
    expect(len(after) >= len(before) + 10, f"{len(after)} of 28 photos have a pose")
    expect((project / "checkpoints" / "block_r0c0.h5").read_bytes() == kept, "a block that no added photo shows was trained again")
    trained = {field["name"] for field in json.loads((project / "train.json").read_text())["fields"]}
    expect({"context", "r0c0", "r0c1", "r0c2", "r0c3"} <= trained, f"trained: {trained}")
    expect(metrics_of(project)["psnr"] > 18.0, "PSNR of " + str(metrics_of(project)["psnr"]))
    skyquilt.call("run", east, "-o", project, "--add", says="train: nothing to do")


if shutil.which("colmap") is None:
    sys.exit(SKIPPED)
main(test)
