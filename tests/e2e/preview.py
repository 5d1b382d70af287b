"""The first pictures of a project: a preview from the sparse points, then one from the context, then the orthophoto in place of both."""
import json
import re
import shutil

from harness import QUICK_TRAIN, expect, main, small_survey

NAMES = ("preview_ortho.json", "preview_ortho.png", "preview_ortho.tif")
BOTH = ("preview_context.json", "preview_context.png", "preview_context.tif", *NAMES)
QUICK = ["--steps", "60", *QUICK_TRAIN[2:]]


def previews(project):
    return tuple(sorted(path.name for path in (project / "products").glob("preview_*")))


def made_from(skyquilt, project):
    """Of each preview, as `info` has it."""
    return [preview["made_from"] for preview in json.loads(skyquilt.call("info", project, "--json")).get("previews", [])]


def state_of_products(skyquilt, project):
    stages = json.loads(skyquilt.call("info", project, "--json"))["stages"]
    return next(stage["state"] for stage in stages if stage["stage"] == "products")


def test(skyquilt, folder):
    survey = small_survey(skyquilt)
    project = folder / "project"
    text = skyquilt.call("prepare", survey, "-o", project)
    expect(re.search(r"first picture: .*products/preview_ortho.png, \d+ s after the poses", text), f"the picture is not named:\n{text}")
    expect(previews(project) == NAMES, f"prepare wrote {previews(project)}")
    expect(made_from(skyquilt, project) == ["sparse points"], "info does not say what the preview was made from")
    expect(state_of_products(skyquilt, project) == "not started", "a preview counts as the products")
    picture = (project / "products" / "preview_ortho.png").read_bytes()

    # The same command makes it again only when it is missing; then it is the same.
    text = skyquilt.call("prepare", survey, "-o", project)
    expect("first picture" not in text, f"the picture was made twice:\n{text}")
    (project / "products" / "preview_ortho.tif").unlink()
    skyquilt.call("prepare", survey, "-o", project)
    expect((project / "products" / "preview_ortho.png").read_bytes() == picture, "another picture of the same survey")
    without = folder / "without"
    text = skyquilt.call("prepare", survey, "-o", without, "--set", "products.preview=false")
    expect("first picture" not in text and not previews(without), f"a preview in spite of products.preview=false:\n{text}")
    skyquilt.call("prepare", survey, "-o", project, "--restart")
    expect((project / "products" / "preview_ortho.png").read_bytes() == picture, "another picture after a restart")

    # A picture that cannot be made ends no command.
    other = folder / "other"
    shutil.copytree(project, other)
    (other / "products" / "preview_ortho.tif").unlink()
    (other / "products" / "preview_ortho.png").unlink()
    (other / "products" / "preview_ortho.png").mkdir()
    skyquilt.call("prepare", survey, "-o", other, says="there is no preview of the orthophoto")

    skyquilt.call("partition", project, "--blocks", "1x2", "--set", "partition.max_log2_table_size=14")
    for ranks, at in ((0, project), (2, folder / "ranks")):
        if ranks:
            shutil.copytree(folder / "partitioned", at)
        else:
            shutil.copytree(project, folder / "partitioned")
        skyquilt.call("train", at, *QUICK, ranks=ranks)
        expect(previews(at) == BOTH and made_from(skyquilt, at) == ["sparse points", "context"], f"{ranks} ranks made {previews(at)}")
        expect((at / "products" / "preview_ortho.png").read_bytes() == picture, "training changed the preview from the sparse points")

    skyquilt.call("merge", project)
    # Without an orthophoto the report shows the preview.
    skyquilt.call("render", project, "--set", "products.ortho=false", "--set", "products.video_seconds=0")
    skyquilt.call("evaluate", project)
    page = (project / "report" / "index.html").read_text()
    expect("preview: from the sparse points" in page and (project / "report" / "images" / "preview_ortho.png").exists(), "the report shows no preview")
    skyquilt.call("render", project, "--ortho")
    expect(not previews(project) and not made_from(skyquilt, project), f"beside the orthophoto there are {previews(project)}")
    text = skyquilt.call("prepare", survey, "-o", project)
    expect("first picture" not in text and not previews(project), f"a preview beside the orthophoto:\n{text}")


main(test)
