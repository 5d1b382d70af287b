"""Tours as their makers and players meet them: saved with rights, made in a real browser, changed by two editors, exported as a folder, played from it."""
import hashlib
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys

from harness import Failure, Skyquilt, expect, houses_project, main, wait_for
from web_client import Viewer, page_can_be_checked, skip
from web_documents import asset_path, collection, png, tour

# Pictures of the size in which the page is looked at, and small ones where nobody looks.
EXPORT = ["--size", "40MB", "--set", "tour.still_width=400", "--set", "tour.still_height=250", "--set", "tour.panorama_width=512"]
SMALL_EXPORT = ["--size", "40MB", "--set", "tour.still_width=160", "--set", "tour.still_height=100", "--set", "tour.panorama_width=256"]
# Neither a model nor a picture.
PAGE = b"glTF<html><script>window.hacked = 1</script></html>"


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
        for name, content in (("png", PAGE), ("glb", PAGE), ("glb", picture), ("png", b"MZ" + bytes(100))):
            path = f"/data/tour/assets/{hashlib.sha256(content).hexdigest()}.{name}"
            status, _, body = viewer.request("PUT", path, body=content)
            expect(status == 415 and b"not saved" in body, f"{content[:10]} as {name}: {status} {body}")
            expect(viewer.request("GET", path)[0] == 404, f"{content[:10]} as {name} was saved")
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


def check_page(skyquilt, project, truth, web, out):
    """A tour made by clicks and keys, saved, read again, changed, undone, fought over by two windows, played, and left while it is saved."""
    shutil.rmtree(out, ignore_errors=True)
    viewer = Viewer(skyquilt, project, "--edit", "--front-end", web / "dist_test")
    try:
        done = subprocess.run(["node", "test/page/tour_page.mjs", viewer.link, viewer.next_link(), str(project), str(truth), str(out)], cwd=web,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace", timeout=400)
        print(done.stdout, flush=True)
        expect(done.returncode == 0, f"the page, see {out}:\n{done.stdout}")
    finally:
        viewer.close()


def contents(folder):
    return {str(file.relative_to(folder)): file.read_bytes() for file in sorted(folder.rglob("*")) if file.is_file()}


def check_export(skyquilt, project, folder):
    """A proposed tour as a folder: within its size, whole after a kill, and never over somebody else's files."""
    target = folder / "exported"
    export = ["tour", project, "-o", target, *SMALL_EXPORT]
    text = skyquilt.call(*export, "--auto", "3")
    expect(len(json.loads((project / "tour.json").read_text())["stops"]) == 3, text)
    first = contents(target)
    for name in ("index.html", "tour.js", "tour.css", "licences.txt", "poster.jpg", "embed.html", "data/project.json.js", "data/tour.json.js"):
        expect(len(first.get(name, b"")) > 50, f"{name} is missing: {list(first)[:40]}")
    expect(sum(map(len, first.values())) <= 40e6, "the folder is larger than --size")
    whole = b"".join(first.values())
    expect(str(project).encode() not in whole and str(skyquilt.program).encode() not in whole, "the folder names places of this machine")

    tour_file = project / "tour.json"
    edited = json.loads(tour_file.read_text())
    edited["stops"][0]["title"] = "<img src=x onerror=alert(1)>"
    tour_file.write_text(json.dumps(edited))
    process = skyquilt.start(*export)
    wait_for((folder / "exported.partial").exists, "the folder in which the export is made", process)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    expect(contents(target) == first, "a killed export changed the folder")
    skyquilt.call(*export)
    expect(json.loads(tour_file.read_text()) == edited, "an export changed the tour")
    expect(contents(target) != first and not [one for one in folder.iterdir() if one.name.startswith(".exported")], f"{list(folder.iterdir())}")

    foreign = folder / "foreign"
    foreign.mkdir()
    (foreign / "letter.txt").write_text("dear")
    text = skyquilt.call("tour", project, "-o", foreign, *SMALL_EXPORT, status=3)
    expect("foreign" in text and (foreign / "letter.txt").read_text() == "dear", text)
    text = skyquilt.call("tour", project, "-o", target, "--size", "1MB", *SMALL_EXPORT[2:], status=3)
    expect("MB" in text or "size" in text, text)
    check_full_disk_and_ranks(skyquilt, project, folder, sum(map(len, contents(target).values())))


def check_full_disk_and_ranks(skyquilt, project, folder, size):
    """An export that does not fit beside the one before it leaves that one as it was; three ranks export the same files as one."""
    disk = folder / "disk"
    disk.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size + 1_500_000}", "tmpfs", str(disk)], stderr=subprocess.PIPE, text=True)
    if mounted.returncode != 0:
        skip(f"an export on a full disk: no right to mount ({mounted.stderr.strip()})")
        return
    try:
        export = ["tour", project, "-o", disk / "exported", *SMALL_EXPORT]
        skyquilt.call(*export)
        first = contents(disk)
        text = skyquilt.call(*export, status=3)
        expect("space" in text.lower() and str(disk) in text, f"a full disk is not named:\n{text}")
        expect(contents(disk) == first, "on a full disk the export changed, or something is left over")
        subprocess.run(["mount", "-o", "remount,size=200m", str(disk)], check=True)
        shutil.rmtree(project / "tour")
        text = skyquilt.call(*export, ranks=3)
        second = contents(disk)
        # The manifest has the time of the export.
        other = [name for name in first if second.get(name) != first[name] and "manifest" not in name]
        expect(second.keys() == first.keys() and not other, f"after a full disk, by three ranks, other files are exported: {other}\n{text}")
    finally:
        subprocess.run(["umount", "-l", str(disk)], check=True)


def check_exported_page(skyquilt, project, exported, web, out):
    """The tour that was made in the page, exported, and played without the program; beside `skyquilt render`."""
    # A model that no upload would have let in.
    name = hashlib.sha256(PAGE).hexdigest() + ".glb"
    (project / "tour" / "assets" / name).write_bytes(PAGE)
    tour_file = project / "tour.json"
    made = json.loads(tour_file.read_text())
    made["things"].append({"id": "shed", "kind": "model", "at": [0, 0, 0], "yaw_deg": 0, "scale": 1, "name": "Shed", "asset": name, "stops": None})
    made["assets"][name] = {"name": "shed.glb", "bytes": len(PAGE)}
    tour_file.write_text(json.dumps(made))
    text = skyquilt.call("tour", project, "-o", exported, *EXPORT)
    expect("Shed" in text and f"{name} is left out" in text, text)
    expect(not (exported / "data" / "assets" / f"{name}.js").exists(), "a file that is no model was exported")
    # The script with the hook of tests.
    shutil.copy(web / "dist_test" / "tour.js", exported / "tour.js")
    done = subprocess.run(["node", "test/page/exported_page.mjs", str(exported), str(project), skyquilt.program, str(out)], cwd=web, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, errors="replace", timeout=300)
    print(done.stdout, flush=True)
    expect(done.returncode == 0, f"the exported page, see {out}:\n{done.stdout}")


def test(skyquilt: Skyquilt, folder):
    build = pathlib.Path(sys.argv[2]).resolve()
    project, survey = houses_project(skyquilt, folder / "project")
    try:
        Viewer(skyquilt, project).close()
    except Failure as failure:
        if "without the viewer's front end" not in str(failure):
            raise
        skip("all: the program has no front end, because nodejs, npm or the network was missing when it was built")
        return
    check_export(skyquilt, project, folder)
    (project / "tour.json").unlink()
    shutil.rmtree(project / "tour")
    check_edit(skyquilt, project)
    if not page_can_be_checked(build / "web", "app.js"):
        return
    check_page(skyquilt, project, survey / "truth" / "buildings.json", build / "web", build / "Testing" / "tour")
    check_exported_page(skyquilt, project, folder / "clicked", build / "web", build / "Testing" / "exported")


if __name__ == "__main__":
    main(test)
