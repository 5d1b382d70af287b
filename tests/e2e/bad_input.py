"""Wrong usage and bad input: each case has its own message and exit status, and no saved work is lost."""
import math
import os
import shutil

from colmap_files import read_images, write_images
from harness import expect, main, small_survey


def test(skyquilt, folder):
    out = folder / "out"

    empty = folder / "empty"
    empty.mkdir()
    skyquilt.call("run", empty, "-o", out, status=3, says=str(empty))

    fake = folder / "fake"
    fake.mkdir()
    for i in range(4):
        (fake / f"p{i}.jpg").write_text("this is no photo\n")
    skyquilt.call("run", fake, "-o", folder / "out_fake", status=3, says="p0.jpg")

    skyquilt.call("run", folder / "absent", "-o", out, status=3, says="absent")

    survey = small_survey(skyquilt)

    config = folder / "wrong.toml"
    config.write_text("[train]\nlevles = 4\n")
    skyquilt.call("run", survey, "-o", out, "--config", config, status=2, says=("levels", "wrong.toml"))
    config.write_text("[train\n")
    skyquilt.call("run", survey, "-o", out, "--config", config, status=3, says="wrong.toml")

    for words in (["--altitudes=-5,10", "--blocks", "1x2"], ["--blocks", "0x2"], ["--blocks", "many"], ["--time-budget", "soon"], ["--time-budget", "-5min"],
                  ["--time-budget", "1min", "--steps", "5"], ["--steps", "-1"], ["--brightness", "sunny"], ["--memory", "lots"], ["--holdout", "every:0"]):
        skyquilt.call("run", survey, "-o", folder / "out_usage", *words, status=2)
    skyquilt.call("run", survey, "-o", folder / "out_altitudes", "--blocks", "2x2", "--altitudes", "50,60", status=2, says=("2", "4"))
    skyquilt.call("bench", "kernel", "--isa", "quantum", status=2)
    skyquilt.call("bench", "kernel", "--levels", "3", "--features", "2", status=2)
    skyquilt.call("bench", status=2)
    skyquilt.call("simulate", "atlantis", "-o", folder / "atlantis", status=2)
    skyquilt.call("train", survey, status=3)

    blocked = folder / "blocked"
    blocked.write_text("a file where a folder should be")
    skyquilt.call("run", survey, "-o", blocked, status=3, says="blocked")
    if os.geteuid() != 0:
        locked = folder / "locked"
        locked.mkdir()
        locked.chmod(0o555)
        skyquilt.call("run", survey, "-o", locked / "out", status=3, says="locked")

    # One damaged photo among good ones is left out with a warning that names it.
    damaged = folder / "damaged"
    shutil.copytree(survey, damaged)
    photos = sorted((damaged / "images").rglob("*.jpg"))
    content = photos[1].read_bytes()
    photos[1].write_bytes(content[:len(content) // 3])
    skyquilt.call("prepare", damaged, "-o", folder / "out_damaged", says=photos[1].name)

    # A pose that is not a number.
    broken = folder / "broken"
    shutil.copytree(survey, broken)
    file = broken / "sparse" / "0" / "images.bin"
    images = read_images(file)
    images[0].rotation = (math.nan, *images[0].rotation[1:])
    write_images(file, images)
    skyquilt.call("prepare", broken, "-o", folder / "out_broken", status=3, says=images[0].name)

    # Camera models of other programs: what is wrong and where, before anything is made.
    for name, content, found in (("transforms.json", '{"fl_x": 500,\n "frames": [\n  {"file_path": 7}]}', "line 3: frames[0].file_path"),
                                 ("reconstruction.json", '[{"shots": {}}]', "line 1"), ("cameras.xml", "<document>\n<chunk>\n</document>", "line 3"),
                                 ("project.opf", "{}\n", 'has no "format"'), ("model.dat", "x", "Give a COLMAP folder")):
        model = folder / "models" / name
        model.parent.mkdir(exist_ok=True)
        model.write_text(content)
        skyquilt.call("prepare", survey, "--model", model, "-o", folder / f"out_{name}", status=3, says=(name, found))

    # Tags that allow no place on Earth: a warning, or an error if asked for.
    unplaced = folder / "unplaced"
    skyquilt.call("simulate", "hamlet", "-o", unplaced, "--image-width", "64", "--set", "simulate.exact_frame=false", "--set", "simulate.tags_equal=true")
    skyquilt.call("prepare", unplaced, "-o", folder / "out_unplaced", says="all GPS tags have one latitude and longitude")
    out_required = folder / "out_required"
    skyquilt.call("prepare", unplaced, "-o", out_required, "--set", "prepare.require_georeference=true", status=3,
                  says=("all GPS tags have one latitude and longitude", "geo_residuals.csv"))
    expect((out_required / "survey" / "geo_residuals.csv").exists(), "there is no table of residuals")
    expect(not (out_required / "survey" / "survey.json").exists(), "a refused survey was saved")

    # Refused commands do not change what an earlier command saved.
    project = folder / "project"
    skyquilt.call("prepare", survey, "-o", project)
    saved = (project / "survey" / "survey.json").read_bytes()
    skyquilt.call("prepare", survey, "-o", project, "--holdout", "every:5", status=2)
    skyquilt.call("train", project, status=3)
    skyquilt.call("merge", project, status=3)
    skyquilt.call("evaluate", project, status=3)
    skyquilt.call("render", project / "scene.h5", status=3)
    expect((project / "survey" / "survey.json").read_bytes() == saved, "a refused command changed the survey")
    skyquilt.call("prepare", survey, "-o", project, "--holdout", "every:5", "--restart")


main(test)
