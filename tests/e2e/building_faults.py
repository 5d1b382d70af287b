"""Buildings of a project in copies of it: refused commands, faults of what the stage needs, kills, a full disk. No half file is left, and the files at
the end are those of an undisturbed run."""
import hashlib
import random
import shutil
import subprocess
import time

from building_files import BuildingFiles
from harness import expect, kill_group


def sha(file):
    return hashlib.sha256(file.read_bytes()).hexdigest()


def made(project):
    """Digest of everything that the stage writes."""
    files = sorted(path for path in (project / "buildings").rglob("*") if path.is_file()) + [project / "surface" / "cloud.las"]
    return {str(path.relative_to(project)): sha(path) for path in files}


class BuildingFaults:
    """project: with a finished surface and buildings; wanted: digests of their files; plain_cloud: cloud.las without their classes."""

    def __init__(self, skyquilt, folder, node):
        self.skyquilt = skyquilt
        self.folder = folder
        self.node = node
        self.copies = 0
        self.project = folder / "project"

    def fresh(self, parent=None):
        """Without buildings, and without their classes in the cloud."""
        self.copies += 1
        project = (parent or self.folder) / f"copy{self.copies}"
        shutil.copytree(self.project, project, symlinks=True)
        self.without_buildings(project)
        return project

    def without_buildings(self, project):
        shutil.rmtree(project / "buildings", ignore_errors=True)
        shutil.rmtree(project / "report", ignore_errors=True)
        for stage in ("buildings", "evaluate"):
            (project / ".state" / f"{stage}.json").unlink(missing_ok=True)
        shutil.copy(self.plain_cloud, project / "surface" / "cloud.las")

    def refused(self, project, *words, status, says):
        text = self.skyquilt.call("buildings", project, *words, status=status)
        expect(all(part in text for part in says), f"{words} is not explained by {says}:\n{text}")

    def check_bad_words(self):
        project = self.project
        a, b = "1,2,3", "-4,2,3"
        for bar in ((a, b), (a, b, "0"), (a, b, "-1"), (a, b, "nan"), (a, b, "x"), (a, a, "2"), ("1,2", b, "2"), (a + ",4", b, "2"), (a, "1e300,0,0", "1"),
                    ("0,0,0", "1e-200,0,0", "1"), ("0,0,0", "1e-9,0,0", "1e9")):
            text = self.skyquilt.call("buildings", project, "--scale-bar", *bar, status=2)
            expect("scale-bar" in text or "scale_bar" in text, f"--scale-bar {bar} is not explained:\n{text}")
        n = len(BuildingFiles(project).rows)
        for ids in ("0", "-1", str(n + 1), f"1,{n + 1}", "x", "99999999999999999999"):
            self.skyquilt.call("buildings", project, "--facades", ids, status=2, says="--facades")
        for option in ("min_area_m2=0", "max_green=nan", "facade_gsd=0", "overhang_m=-1", "share_yaw_m=30", "min_aera_m2=3"):
            text = self.skyquilt.call("buildings", project, "--set", f"buildings.{option}", status=2)
            expect(option.split("=")[0] in text, f"buildings.{option} is not explained:\n{text}")
        expect(not (project / "buildings" / "facades").exists() and made(project) == self.wanted, "refused commands changed something")

    def check_surface_needed(self):
        project = self.fresh()
        cloud, terrain, table = (project / "surface" / name for name in ("cloud.las", "dtm.tif", "surface.json"))
        textures = project / "cache" / "surface" / "textures"
        again = "'skyquilt surface' with --restart and --set surface."
        for path, says in ((table, ["surface.json", f"'skyquilt surface {project}'"]), (terrain, ["dtm.tif", again + "maps=true"]),
                           (cloud, ["cloud.las", again + "cloud=true"]), (textures, ["textures", again + "cloud=true"])):
            hidden = path.rename(self.folder / "hidden")
            self.refused(project, status=3, says=says)
            hidden.rename(path)
        for path in (cloud, next(iter(sorted(textures.glob("0_*.bin"))))):
            whole = path.read_bytes()
            path.write_bytes(whole[:len(whole) // 2])
            self.refused(project, status=3, says=[path.name, again + "cloud=true"])
            path.write_bytes(whole)
        self.skyquilt.call("buildings", project)
        expect(made(project) == self.wanted, "after faults of the surface other buildings are found")
        # Another surface: buildings are made again.
        self.skyquilt.call("surface", project, "--restart", "--set", "surface.cloud=false", "--set", "surface.maps=false", "--set", "surface.glb=false")
        expect(not (project / "buildings").exists(), "buildings outlive their surface")
        self.refused(project, status=3, says=[again])
        self.skyquilt.call("surface", project, "--restart", "--set", "surface.cloud=true", "--set", "surface.maps=true")
        self.skyquilt.call("buildings", project)
        expect(made(project) == self.wanted, "the same surface has other buildings")

    def check_kills(self):
        """At a random moment, while the cloud is written again, after the first file, while the GeoPackage is written, and after the last file."""
        project = self.fresh()
        end = time.monotonic() + random.Random(1).uniform(0.05, 0.4)
        folder = project / "buildings"
        moments = [lambda: time.monotonic() > end, lambda: any((project / "surface").glob("cloud.las?*")), (folder / "buildings.json").exists,
                   lambda: any(folder.glob("buildings.gpkg*")), (folder / "buildings.dxf").exists]
        kills = sum(self.kill_at(project, moment) for moment in moments)
        expect(kills > 0, "the stage always ended before it could be killed")
        print(f"{kills} kills: the same files", flush=True)

    def kill_at(self, project, moment):
        """Whether the stage was killed before its end."""
        self.without_buildings(project)
        process = self.skyquilt.start("buildings", project)
        while process.poll() is None and not moment():
            time.sleep(0.0005)
        killed = process.poll() is None
        if killed:
            kill_group(process)
        process.stdout.close()
        for path in [*(project / "buildings").glob("*"), project / "surface" / "cloud.las"]:
            name = str(path.relative_to(project))
            unfinished = ".partial" in name or ".tmp." in name or name.endswith(("-journal", "-wal"))
            whole = sha(path) == self.wanted.get(name) or (path.name == "cloud.las" and sha(path) == sha(self.plain_cloud))
            expect(whole or unfinished, f"killed, {name} is a half file")
        self.skyquilt.call("buildings", project)
        # A killed process cannot remove what it was just writing under another name.
        found = {name: value for name, value in made(project).items() if ".tmp." not in name and ".partial" not in name}
        differing = sorted(name for name in found.keys() | self.wanted.keys() if found.get(name) != self.wanted.get(name))
        expect(not differing, f"killed and resumed, these files differ: {differing}")
        return killed

    def check_full_disk(self):
        disk = self.folder / "small"
        disk.mkdir()
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=1000000000", "tmpfs", str(disk)], stderr=subprocess.PIPE, text=True)
        if mounted.returncode != 0:
            print(f"full disk and folders that cannot be written: skipped, no right to mount ({mounted.stderr.strip()})", flush=True)
            return
        try:
            project = self.fresh(disk)
            used = shutil.disk_usage(disk).used
            sizes = {name: (self.project / name).stat().st_size for name in self.wanted}
            # At the cloud, and at the files.
            for room, words in ((0.5 * sizes["surface/cloud.las"], []), (0.5 * sum(sizes.values()) - 0.5 * sizes["surface/cloud.las"],
                                                                         ["--set", "buildings.classify_cloud=false", "--restart"])):
                subprocess.run(["mount", "-o", f"remount,size={int(used + room)}", str(disk)], check=True)
                text = self.skyquilt.call("buildings", project, *words, status=3)
                # SQLite, which writes the GeoPackage, does not name the reason.
                expect(("no space left" in text.lower() or "Check the free space" in text) and str(project) in text, f"a full disk is not named:\n{text}")
                for name, digest in made(project).items():
                    expect(digest in (self.wanted.get(name), sha(self.plain_cloud)), f"on a full disk {name} is a half file, or left over")
            subprocess.run(["mount", "-o", "remount,size=1000000000", str(disk)], check=True)
            self.skyquilt.call("buildings", project, "--restart", "--set", "buildings.classify_cloud=true")
            expect(made(project) == self.wanted, "after a full disk other files are made")
            self.without_buildings(project)
            (project / "buildings").mkdir()
            subprocess.run(["mount", "--bind", str(project / "buildings"), str(project / "buildings")], check=True)
            subprocess.run(["mount", "-o", "remount,bind,ro", str(project / "buildings")], check=True)
            self.refused(project, status=3, says=[str(project / "buildings")])
            subprocess.run(["umount", "-l", str(project / "buildings")], check=True)
            (project / "buildings").rmdir()
            (project / "buildings").write_text("not a folder")
            self.refused(project, status=3, says=[str(project / "buildings")])
            self.skyquilt.call("buildings", project, "--restart")
            expect(made(project) == self.wanted, "after a file in the folder's place other files are made")
        finally:
            subprocess.run(["umount", "-l", str(disk)])
