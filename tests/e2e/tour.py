"""Tours as their makers and players meet them: made in a real browser, saved with rights, changed by two editors."""
import json
import pathlib
import shutil
import subprocess
import sys

from harness import Failure, Skyquilt, expect, main
from web_client import Viewer, skip
from web_documents import asset_path, collection, png, tour

# A field that shows houses; nothing is measured on it.
TRAIN = ["--blocks", "1x1", "--image-width", "320", "--time-budget", "12s", "--set", "products.video_seconds=0", "--set", "buildings.enabled=false"]


def check_edit(skyquilt, project):
    """The two links of --edit, their rights, and two editors."""
    viewer = Viewer(skyquilt, project, "--edit")
    try:
        play = viewer.next_link()
        viewer.log_in()
        edit_cookie = viewer.cookie
        expect("edit" in viewer.printed and "playing only" in viewer.printed, viewer.printed)
        expect(viewer.next_link() not in (viewer.link, play), "the link for editing is renewed")
        status, headers, _ = viewer.request("GET", play[play.index("/?"):], cookie=False)
        expect(status == 303, f"the link to play: {status}")
        play_cookie = headers["Set-Cookie"].split(";")[0]
        picture = png(40)
        for cookie, saved, rights in ((play_cookie, 403, False), (edit_cookie, 204, True)):
            viewer.cookie = cookie
            status, _, body = viewer.request("GET", "/data/rights.json")
            expect(status == 200 and json.loads(body) == {"documents": rights, "tour": rights}, f"rights: {body}")
            for path, body in (("/data/tour.json", tour("<script>alert(1)</script>")), (asset_path(picture), picture),
                               ("/data/measurements.geojson", collection(1))):
                expect(viewer.request("PUT", path, body=body)[0] == saved, f"{path} with the rights {rights}")
        status, headers, body = viewer.request("GET", asset_path(picture))
        expect(status == 200 and body == picture and headers["Content-Type"] == "image/png", f"the picture: {status} {headers}")
        _, headers, _ = viewer.request("GET", "/data/tour.json")
        known = {"If-Match": headers["ETag"]}
        expect(viewer.request("PUT", "/data/tour.json", body=tour("mine"), headers=known)[0] == 204, "the first editor")
        expect(viewer.request("PUT", "/data/tour.json", body=tour("yours"), headers=known)[0] == 412, "the second editor")
        expect(json.loads((project / "tour.json").read_text())["title"] == "mine", "the second editor overwrites")
        viewer.cookie = play_cookie
        expect(viewer.socket().status == 101, "whoever plays may look")
    finally:
        viewer.close()
    viewer = Viewer(skyquilt, project).log_in()
    try:
        status, _, body = viewer.request("PUT", "/data/tour.json", body=tour("no"))
        expect(status == 403 and b"--edit" in body, f"without --edit: {status} {body}")
    finally:
        viewer.close()
    for name in ("tour.json", "measurements.geojson"):
        (project / name).unlink()
    shutil.rmtree(project / "tour")


def check_page(skyquilt, project, web, out):
    """A tour made by clicks and keys, saved, read again, changed, undone, fought over by two windows, and played."""
    if not (web / "dist_test" / "app.js").exists():
        skip("the page: its front end was not built (nodejs, npm or the network was missing)")
        return
    if not shutil.which("chromium"):
        skip("the page: chromium is not installed")
        return
    shutil.rmtree(out, ignore_errors=True)
    viewer = Viewer(skyquilt, project, "--edit", "--front-end", web / "dist_test")
    try:
        done = subprocess.run(["node", "test/page/tour_page.mjs", viewer.link, viewer.next_link(), str(project), str(out)], cwd=web, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, errors="replace", timeout=400)
        print(done.stdout, flush=True)
        expect(done.returncode == 0, f"the page, see {out}:\n{done.stdout}")
    finally:
        viewer.close()


def test(skyquilt: Skyquilt, folder):
    build = pathlib.Path(sys.argv[2]).resolve()
    survey, project = folder / "hamlet", folder / "project"
    skyquilt.call("simulate", "hamlet", "-o", survey, "--set", "simulate.image_width=320")
    skyquilt.call("run", survey, "-o", project, *TRAIN)
    try:
        Viewer(skyquilt, project).close()
    except Failure as failure:
        if "without the viewer's front end" not in str(failure):
            raise
        skip("all: the program has no front end, because nodejs, npm or the network was missing when it was built")
        return
    check_edit(skyquilt, project)
    check_page(skyquilt, project, build / "web", build / "Testing" / "tour")


if __name__ == "__main__":
    main(test)
