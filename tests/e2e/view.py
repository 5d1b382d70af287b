"""`skyquilt view` as its users meet it: in a real browser, over several ranks, with unfinished projects, a full disk, and a process that is killed."""
import json
import math
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time

from harness import Failure, Skyquilt, expect, houses_project, main
from web_client import Viewer, WebSocket, looking, page_can_be_checked, skip
from web_documents import asset_path, collection, png


def views(description):
    """An eye, a rotation and the middle of the scene."""
    low, high = description["min_enu"], description["max_enu"]
    middle = [(a + b) / 2 for a, b in zip(low, high)]
    middle[2] = description["ground_m"]
    eye = [middle[0] + 20, middle[1] - 60, middle[2] + 60]
    return eye, looking(eye, middle), middle


def write_buildings(project, survey):
    """buildings/ as `skyquilt buildings` writes it, with a box for every house of the truth: so short a training shows no roofs that it could measure."""
    names = ("ground_m", "eave_m", "ridge_m", "height_m", "length_m", "width_m", "yaw_deg", "footprint_m2", "roof_m2", "volume_m3", "pitch_deg")
    buildings = []
    for house in json.loads((survey / "truth" / "buildings.json").read_text())["buildings"]:
        if not house["inside_area"]:
            continue
        ground, height, length, width = (house[key] for key in ("ground_z_m", "eave_height_m", "length_m", "width_m"))
        yaw = math.radians(house["yaw_deg"])
        corners = [(u * length / 2, v * width / 2) for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        ring = [(house["east_m"] + u * math.cos(yaw) - v * math.sin(yaw), house["north_m"] + u * math.sin(yaw) + v * math.cos(yaw)) for u, v in corners]
        walls = [{"kind": "wall", "outer": [i, (i + 1) % 4, 4 + (i + 1) % 4, 4 + i], "holes": []} for i in range(4)]
        faces = [{"kind": "ground", "outer": [3, 2, 1, 0], "holes": []}, {"kind": "roof", "outer": [4, 5, 6, 7], "holes": []}, *walls]
        values = (ground, ground + height, ground + height, height, length, width, house["yaw_deg"] % 180, length * width, length * width,
                  length * width * height, 0.0)
        buildings.append({"id": len(buildings) + 1, "roof": "flat", "accepted": len(buildings) > 0, "note": "", "given_id": "", "share_within": 0.9,
                          "roof_points": 100, "measures": {name: [value, 0.1] for name, value in zip(names, values)} | {"wall_seen": 0.5},
                          "lod22": {"vertex": [[*point, z] for z in (ground, ground + height) for point in ring], "face": faces}})
    folder = project / "buildings"
    folder.mkdir(exist_ok=True)
    (folder / "buildings.json").write_text(json.dumps({"format": "skyquilt buildings", "version": 1, "metric": True, "scale_source": "geo-reference",
                                                       "buildings": buildings}))
    (folder / "buildings.csv").write_text("id\n")


def check_page(skyquilt, project, survey, web, out):
    """The front end in Chromium."""
    if not page_can_be_checked(web, "app.js"):
        return
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir(parents=True)
    viewer = Viewer(skyquilt, project, "--front-end", web / "dist_test")
    try:
        done = subprocess.run(["node", "test/page/view_page.mjs", viewer.link, str(project), str(survey / "truth" / "buildings.json"), skyquilt.program, str(out)],
                              cwd=web, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace", timeout=400)
        print(done.stdout, flush=True)
        expect(done.returncode == 0, f"the page, see {out}:\n{done.stdout}")
    finally:
        viewer.close()


def check_session(skyquilt, project):
    """The link, the cookie, and what others get."""
    viewer = Viewer(skyquilt, project)
    try:
        status, headers, body = viewer.request("GET", "/", cookie=False)
        expect(status == 403 and b"skyquilt" in body.lower() and "Set-Cookie" not in headers, f"without the link: {status}")
        first = viewer.link
        viewer.log_in()
        second = viewer.next_link()
        expect(second != first, "the same link again")
        path = first[first.index("/?"):]
        expect(viewer.request("GET", path, cookie=False)[0] == 403, "the link works twice")
        status, headers, body = viewer.request("GET", "/")
        expect(status == 200 and b"<script" in body, f"the page: {status}")
        policy = headers["Content-Security-Policy"]
        expect("default-src 'self'" in policy and "unsafe" not in policy, policy)
        for wrong in ({"Host": "evil.example"}, {"Host": f"evil.example:{viewer.port}"}):
            expect(viewer.request("GET", "/data/project.json", headers=wrong)[0] in (403, 421), f"{wrong} is served")
        expect(viewer.request("PUT", "/data/measurements.geojson", body=b"{}", headers={"Origin": "http://evil.example"})[0] == 403, "a foreign page saves")
        expect(WebSocket(viewer.port, viewer.cookie, origin="http://evil.example").status == 403, "a foreign page opens the socket")
        expect(WebSocket(viewer.port, None).status == 403, "the socket opens without a session")
        status, headers, body = viewer.request("GET", "/data/buildings/buildings.csv")
        expect(status == 200 and headers["Content-Type"].startswith("text/csv") and body == b"id\n", f"buildings.csv: {status}")
        for path in ("/data/../config.toml", "/data/%2e%2e/config.toml", "/data/..%2fconfig.toml", "/data//etc/passwd", "/data/config.toml"):
            status, _, body = viewer.request("GET", path)
            expect(status in (400, 404) and b"image_width" not in body, f"{path}: {status}")
        expect(viewer.close() == 0, f"ended with {viewer.process.returncode}:\n{viewer.printed}")
    finally:
        if viewer.process.poll() is None:
            viewer.process.kill()


def exact_frame(skyquilt, project, *flags, ranks=0):
    """The last pass as PNG bytes."""
    viewer = Viewer(skyquilt, project, *flags, ranks=ranks).log_in()
    try:
        description = viewer.project()
        expect(description["scene"] is not None and description["tiles"] is not None, f"{description['missing']}")
        socket = viewer.socket()
        while not socket.welcome["engine"]["ready"]:
            socket.welcome = socket.text("engine")
        eye, rotation, _ = views(description)
        socket.view(1, eye, rotation, 320, 180)
        frame = socket.last_frame(1)
        expect(frame.format == 1 and frame.width == 320 and len(frame.depth) == 2 * frame.depth_width * frame.depth_height, "last pass")
        return frame.color, frame.depth
    finally:
        status = viewer.close()
        # mpirun itself ends with 1 after Ctrl-C.
        expect((status == 0 or ranks) and "viewer closed" in viewer.printed, f"ended with {status}:\n{viewer.printed}")


def check_ranks(skyquilt, project):
    """Other ranks give the same bytes."""
    alone = exact_frame(skyquilt, project)
    expect(exact_frame(skyquilt, project, ranks=3) == alone, "three ranks give another picture")
    return alone


def check_questions(skyquilt, project):
    """What the tools of the page ask, and two surveys side by side: here the same one, so that nothing has changed between them."""
    viewer = Viewer(skyquilt, project, "--compare", project).log_in()
    try:
        description = viewer.project()
        expect(description["before"]["tiles"] == "before/tiles/tileset.json", f"{description['before']['tiles']}")
        expect(viewer.request("GET", "/data/before/tiles/tileset.json")[0] == 200, "tiles of the earlier survey")
        socket = viewer.socket()
        while not socket.welcome["engine"]["ready"]:
            socket.welcome = socket.text("engine")
        _, _, middle = views(description)
        socket.send({"type": "pick", "id": 1, "project": "main", "origin": middle[:2] + [middle[2] + 80], "direction": [0, 0, -1],
                     "pixel_pitch": 0.001, "pixel_width_m": 0})
        picked = socket.text("picked")
        expect(picked["hit"] and 0 < picked["spread_m"] < 5, f"{picked}")
        socket.send({"type": "photos_at", "id": 2, "point": picked["point"]})
        sights = socket.text("photos")
        seen = [one for one in sights["photos"] if one["visible"]]
        expect(sights["checked"] and len(seen) >= 3, f"{len(seen)} of {len(sights['photos'])} photos see the middle")
        low, high = description["min_enu"], description["max_enu"]
        socket.send({"type": "profile", "id": 3, "project": "main", "from": low[:2], "to": high[:2], "samples": 200})
        heights = [height for height in socket.text("profile")["heights_m"] if height is not None]
        expect(len(heights) > 150 and max(heights) - min(heights) > 2, f"profile: {len(heights)} heights")
        x, y = middle[:2]
        square = [[x - 10, y - 10], [x + 10, y - 10], [x + 10, y + 10], [x - 10, y + 10]]
        for number, (base, least) in enumerate({"lowest": 1.0, "before": 0.0}.items()):
            socket.send({"type": "volume", "id": 10 + number, "project": "main", "polygon": square, "base": base})
            volume = socket.text("volume")
            expect(abs(volume["plan_area_m2"] - 400) < 1e-6 and volume["filled"] > 0.95, f"{volume}")
            expect(volume["cut_m3"] + volume["fill_m3"] >= least, f"{base}: {volume}")
        expect(volume["cut_m3"] < 1e-6 and volume["fill_m3"] < 1e-6, f"a survey differs from itself: {volume}")
        socket.send({"type": "trust_map", "id": 19})
        trust_map = socket.text("trust_map")
        status, headers, picture = viewer.request("GET", f"/data/{trust_map['url']}")
        expect(status == 200 and picture.startswith(b"\x89PNG") and trust_map["scale"] == 0.25, f"{trust_map} {status} {headers}")
        socket.send({"type": "error_map", "id": 20})
        error_map = socket.text("error_map")
        status, headers, picture = viewer.request("GET", f"/data/{error_map['url']}")
        expect(status == 200 and picture.startswith(b"\x89PNG") and error_map["photos"] >= 1, f"{error_map} {status} {headers}")
    finally:
        viewer.close()


def check_new_merge(skyquilt, project, ranks):
    """A scene that is merged while the viewer is open is loaded, by all ranks."""
    viewer = Viewer(skyquilt, project, ranks=ranks).log_in()
    try:
        socket = viewer.socket()
        while not socket.welcome["engine"]["ready"]:
            socket.welcome = socket.text("engine")
        revision = socket.welcome["engine"]["revision"]
        time.sleep(1.1)
        skyquilt.call("merge", project, "--restart")
        engine = socket.text("engine")["engine"]
        while not engine["ready"] or engine["revision"] == revision:
            engine = socket.text("engine")["engine"]
        expect(engine["revision"] > revision, f"revision {engine['revision']} after {revision}")
        eye, rotation, _ = views(viewer.project())
        socket.view(5, eye, rotation, 160, 90)
        expect(socket.last_frame(5).revision == engine["revision"], "a frame of the old scene")
    finally:
        viewer.close()


def check_killed_while_saving(skyquilt, project):
    """The old or the new file, never half."""
    file = project / "measurements.geojson"
    sizes = (3, 900)
    viewer = Viewer(skyquilt, project).log_in()
    for size in sizes:
        inode = file.stat().st_ino if file.exists() else 0
        expect(viewer.request("PUT", "/data/measurements.geojson", body=collection(size))[0] == 204, f"saving {size} features")
        expect(file.stat().st_ino != inode and len(json.loads(file.read_text())["features"]) == size, "it is written in place")
    viewer.close()
    for attempt in range(6):
        viewer = Viewer(skyquilt, project).log_in()
        expect(viewer.request("PUT", "/data/measurements.geojson", body=collection(3))[0] in (200, 204), "saving")
        child = os.fork()
        if child == 0:
            try:
                for turn in range(1000):
                    viewer.request("PUT", "/data/measurements.geojson", body=collection(sizes[turn % 2]))
            finally:
                os._exit(0)
        time.sleep(0.05 + 0.03 * attempt)
        os.killpg(viewer.process.pid, signal.SIGKILL)
        viewer.process.wait()
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        saved = json.loads(file.read_text())
        expect(len(saved["features"]) in sizes, f"{len(saved['features'])} features")
    viewer = Viewer(skyquilt, project).log_in()
    status, _, body = viewer.request("GET", "/data/measurements.geojson")
    expect(status == 200 and len(json.loads(body)["features"]) in sizes, f"after the kills: {status}")
    viewer.close()
    file.unlink()


def check_full_disk(skyquilt, project, folder):
    """Saving fails with a reason, and the old file stays."""
    disk = folder / "disk"
    disk.mkdir()
    if os.geteuid() != 0 or subprocess.run(["mount", "-t", "tmpfs", "-o", "size=3m", "tmpfs", str(disk)], stderr=subprocess.DEVNULL).returncode != 0:
        skip("full disk: needs root and tmpfs")
        return
    try:
        small = disk / "small"
        small.mkdir()
        shutil.copytree(project / "survey", small / "survey", ignore=shutil.ignore_patterns("*.ply", "*.bin"))
        viewer = Viewer(skyquilt, small, "--edit").log_in()
        try:
            expect(viewer.request("PUT", "/data/measurements.geojson", body=collection(2))[0] in (200, 204), "saving on a disk with space")
            filler = os.open(disk / "filler", os.O_WRONLY | os.O_CREAT)
            try:
                while os.write(filler, bytes(4096)):
                    pass
            except OSError:
                pass
            finally:
                os.close(filler)
            status, _, body = viewer.request("PUT", "/data/measurements.geojson", body=collection(900))
            expect(status == 507 and b"space" in body.lower(), f"full disk: {status} {body[:200]}")
            expect(len(json.loads((small / "measurements.geojson").read_text())["features"]) == 2, "the old file is gone")
            picture = png(200)
            status, _, body = viewer.request("PUT", asset_path(picture), body=picture)
            expect(status == 507 and b"space" in body.lower(), f"a picture on a full disk: {status} {body[:200]}")
            expect(not list(small.glob("tour/assets/*")), "half a picture is left")
        finally:
            viewer.close()
    finally:
        subprocess.run(["umount", str(disk)], check=True)


def check_unfinished(skyquilt, project, survey, folder):
    """Projects that lack something open as far as possible and say why."""
    young = folder / "young"
    skyquilt.call("prepare", survey, "-o", young)
    viewer = Viewer(skyquilt, young).log_in()
    try:
        description = viewer.project()
        expect(description["scene"] is None and description["tiles"] is None and description["photos"], "a project in training")
        what = {one["what"]: one for one in description["missing"]}
        expect(what and all(one["reason"] and one["advice"] for one in what.values()), f"{description['missing']}")
        for _ in range(100):  # until the engine has looked for a scene
            socket = viewer.socket()
            if "loaded" not in json.dumps(socket.welcome["engine"]):
                break
            time.sleep(0.1)
        expect(not socket.welcome["engine"]["ready"] and "train" in json.dumps(socket.welcome["engine"]), f"{socket.welcome}")
        socket.send({"type": "pick", "id": 7, "project": "main", "origin": [0, 0, 100], "direction": [0, 0, -1], "pixel_pitch": 0.001, "pixel_width_m": 0})
        while True:
            message = socket.receive()
            if not isinstance(message, bytes) and message.get("id") == 7:
                break
        expect(message["type"] == "error" and message["message"], f"{message}")
    finally:
        viewer.close()

    # Without photos, and with a scene of another version.
    bare = folder / "bare"
    shutil.copytree(project, bare, ignore=shutil.ignore_patterns("checkpoints", "cache"))
    survey_file = bare / "survey" / "survey.json"
    described = json.loads(survey_file.read_text())
    described["photo_root"] = str(folder / "nowhere")
    survey_file.write_text(json.dumps(described))
    scene = bytearray((bare / "scene.h5").read_bytes())
    at = scene.index(b"version ") + len(b"version ")
    scene[at:at + 1] = b"9"
    (bare / "scene.h5").write_bytes(bytes(scene))
    viewer = Viewer(skyquilt, bare).log_in()
    try:
        description = viewer.project()
        expect(description["tiles"] is not None, "the surface is shown without scene and photos")
        expect(not any(photo["available"] for photo in description["photos"]), "photos that are gone")
        text = json.dumps(description["missing"])
        expect("nowhere" in text and "scene" in text, text)
        expect(viewer.request("GET", "/data/photos/0/thumbnail.jpg")[0] == 404, "a photo that is gone")
        expect(not viewer.socket().welcome["engine"]["ready"], "a scene of another version")
    finally:
        viewer.close()
    # No surface: the orthophoto over the surface model.
    shutil.rmtree(bare / "surface")
    viewer = Viewer(skyquilt, bare).log_in()
    try:
        description = viewer.project()
        expect(description["tiles"] is None and description["terrain"], f"{description['missing']}")
        for path in (description["terrain"], "orthophoto.jpg"):
            status, _, body = viewer.request("GET", f"/data/{path}")
            expect(status == 200 and len(body) > 1000, f"{path}: {status}")
    finally:
        viewer.close()
    skyquilt.call("view", folder / "nothing", status=3, says="nothing")
    empty = folder / "empty"
    empty.mkdir()
    expect("project" in skyquilt.call("view", empty, status=3), "an empty folder")


def check_port(skyquilt, project):
    viewer = Viewer(skyquilt, project)
    try:
        text = skyquilt.call("view", project, "--port", viewer.port, status=2, timeout=60)
        expect(str(viewer.port) in text and "port" in text, text)
    finally:
        viewer.close()


def test(skyquilt: Skyquilt, folder):
    build = pathlib.Path(sys.argv[2]).resolve()
    project, survey = houses_project(skyquilt, folder / "project")
    try:
        probe = Viewer(skyquilt, project)
        probe.close()
    except Failure as failure:
        if "without the viewer's front end" not in str(failure):
            raise
        skip("all: the program has no front end, because nodejs, npm or the network was missing when it was built")
        return
    write_buildings(project, survey)
    check_session(skyquilt, project)
    check_page(skyquilt, project, survey, build / "web", build / "Testing" / "view")
    check_questions(skyquilt, project)
    check_ranks(skyquilt, project)
    check_killed_while_saving(skyquilt, project)
    check_full_disk(skyquilt, project, folder)
    check_unfinished(skyquilt, project, survey, folder)
    check_port(skyquilt, project)
    # Last: it removes what was made from the former scene.
    for ranks in (0, 3):
        check_new_merge(skyquilt, project, ranks)


if __name__ == "__main__":
    main(test)
