"""Faults while a surface is made: killed, stopped, without space or memory, with damaged files. What is finished is kept, no half file is left, and
the files at the end are those of an undisturbed run.
Usage: surface_faults.py SKYQUILT [--kills 5] [--seed 1]"""
import argparse
import hashlib
import json
import pathlib
import random
import resource
import shutil
import signal
import subprocess
import time

from harness import QUICK_TRAIN, expect, kill_group, main, small_project

LIMITED_BYTES = 200_000  # of a file, where no small disk can be mounted: less than a mesh needs


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("skyquilt")
    parser.add_argument("--kills", type=int, default=5)
    parser.add_argument("--seed", type=int, default=1)
    return parser.parse_args()


def bytes_below(*folders):
    return sum(path.stat().st_size for folder in folders for path in folder.rglob("*") if path.is_file())


def contents(folder):
    """Digest of every file of a surface; the table of it without its times."""
    found = {}
    for path in sorted(folder.rglob("*")):
        if not path.is_file():
            continue
        content = path.read_bytes()
        if path.name == "surface.json":
            content = json.dumps({key: value for key, value in json.loads(content).items() if "seconds" not in key}).encode()
        found[str(path.relative_to(folder))] = hashlib.sha256(content).hexdigest()
    return found


class Faults:
    def __init__(self, skyquilt, folder, options):
        self.skyquilt = skyquilt
        self.folder = folder
        self.options = options
        self.random = random.Random(options.seed)
        self.projects = 0
        self.template = small_project(skyquilt, folder / "template")
        skyquilt.call("train", self.template, *QUICK_TRAIN)
        skyquilt.call("merge", self.template)
        whole = self.fresh()
        begun = time.monotonic()
        skyquilt.call("surface", whole)
        self.seconds = time.monotonic() - begun
        self.wanted = contents(whole / "surface")
        self.bytes = bytes_below(whole / "surface", whole / "cache" / "surface")
        self.whole = whole
        expect(len(self.wanted) > 8 and "mesh.glb" in self.wanted, f"the undisturbed run made only {sorted(self.wanted)}")

    def fresh(self, parent=None):
        self.projects += 1
        project = (parent or self.folder) / f"project{self.projects}"
        shutil.copytree(self.template, project, symlinks=True)
        return project

    def no_half_files(self, project, what, partial=False):
        """Every file is the one of an undisturbed run. partial: others may be there under names that say so, after a kill."""
        for name, digest in contents(project / "surface").items():
            unfinished = ".partial" in name or ".tmp." in name or name.endswith(("-journal", "-wal"))
            expect(digest == self.wanted.get(name) or (partial and unfinished), f"{what}, {name} is a half file, or left over")

    def finish(self, project, what, *words, ranks=0):
        text = self.skyquilt.call("surface", project, *words, ranks=ranks)
        # A killed process cannot remove what it was just writing under another name.
        found = {name: digest for name, digest in contents(project / "surface").items() if ".tmp." not in name}
        differing = sorted(name for name in set(found) | set(self.wanted) if found.get(name) != self.wanted.get(name))
        expect(not differing, f"{what}, these files differ from those of an undisturbed run: {differing}\n{text}")
        return text

    def flip(self, project):
        """Flips a bit of a file of finished steps; returns its name, or nothing when there is none."""
        files = [path for path in (project / "cache" / "surface").rglob("*.bin") if path.stat().st_size > 0]
        if not files:
            return ""
        file = self.random.choice(sorted(files))
        content = bytearray(file.read_bytes())
        content[self.random.randrange(len(content))] ^= 1 << self.random.randrange(8)
        file.write_bytes(content)
        return file.name

    def kill_often(self):
        kills, damaged = 0, []
        while kills < self.options.kills:
            project = self.fresh()
            for attempt in range(2):
                process = self.skyquilt.start("surface", project)
                # At any moment of the run, and soon after the start for the second time, when it goes on with what is finished.
                try:
                    process.wait(self.random.uniform(0.05, 1.0 if attempt == 0 else 0.4) * self.seconds)
                    break
                except subprocess.TimeoutExpired:
                    kill_group(process)
                process.stdout.close()
                kills += 1
                if (project / "surface").exists():
                    self.no_half_files(project, "killed", partial=True)
            process.stdout.close()
            if self.random.random() < 0.5:
                damaged.append(self.flip(project))
                self.finish_or_name(project, damaged[-1])
            else:
                self.finish(project, "killed and resumed")
            shutil.rmtree(project)
        print(f"{kills} kills, {sum(map(bool, damaged))} flipped bits: all ended with the files of an undisturbed run", flush=True)

    def finish_or_name(self, project, damaged):
        """A damaged file is made again, or named; then the user may start again."""
        done = subprocess.run(self.skyquilt.command(["surface", project], 0), env=self.skyquilt.environment, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, errors="replace", timeout=600)
        if done.returncode == 0:
            self.finish(project, f"resumed with a damaged {damaged or 'nothing'}")
            return
        text = f"resumed with a damaged {damaged or 'nothing'} it ends with {done.returncode}:\n{done.stdout}"
        expect(done.returncode == 3 and damaged and damaged in done.stdout, text)
        self.finish(project, f"started again after damage of {damaged}", "--restart")

    def stop(self):
        project = self.fresh()
        work = project / "cache" / "surface"
        process = self.skyquilt.start("surface", project)
        while process.poll() is None and not any(work.rglob("*.bin")):
            time.sleep(0.005)
        process.send_signal(signal.SIGTERM)
        text, _ = process.communicate(timeout=120)
        expect(process.returncode == 130, f"a stopped run ends with {process.returncode}:\n{text}")
        if (project / "surface").exists():
            self.no_half_files(project, "stopped")
        self.finish(project, "stopped and resumed")
        print("stopped by SIGTERM: status 130, resumed", flush=True)

    def full_disk(self):
        disk = self.folder / "small"
        disk.mkdir()
        need = bytes_below(self.template)
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={need + 2_000_000}", "tmpfs", str(disk)], stderr=subprocess.PIPE, text=True)
        if mounted.returncode != 0:
            print(f"full disk: a limit of the size of files instead, no right to mount ({mounted.stderr.strip()})", flush=True)
            self.limited_files()
            return
        try:
            for share in (0.1, 0.8):
                # Blocks and inodes take more than the bytes of files.
                subprocess.run(["mount", "-o", "remount,size=1000000000", str(disk)], check=True)
                project = self.fresh(disk)
                used = shutil.disk_usage(disk).used
                subprocess.run(["mount", "-o", f"remount,size={int(used + share * self.bytes)}", str(disk)], check=True)
                text = self.skyquilt.call("surface", project, status=3)
                self.expect_named(text, project, f"with {share} of the space needed")
                subprocess.run(["mount", "-o", "remount,size=1000000000", str(disk)], check=True)
                self.finish(project, "resumed after a full disk")
                shutil.rmtree(project)
        finally:
            subprocess.run(["umount", "-l", str(disk)])
        print("full disk: reported, no half files, resumed", flush=True)

    def limited_files(self):
        project = self.fresh()
        # Without restore_signals=False the limit would kill the program, instead of failing its writes.
        done = subprocess.run(self.skyquilt.command(["surface", project], 0), env=self.skyquilt.environment, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, errors="replace", timeout=600, restore_signals=False,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (LIMITED_BYTES, LIMITED_BYTES)))
        expect(done.returncode == 3, f"with a limit of the size of files it ends with {done.returncode}:\n{done.stdout}")
        self.expect_named(done.stdout, project, "with a limit of the size of files")
        self.finish(project, "resumed after a limit of the size of files")
        print("limited files: reported, no half files, resumed", flush=True)

    def expect_named(self, text, project, what):
        lower = text.lower()
        expect("no space left" in lower or "too large" in lower, f"{what}, the reason is not named:\n{text}")
        expect(str(project / "surface") in text or str(project / "cache") in text, f"{what}, the file is not named:\n{text}")
        if (project / "surface").exists():
            self.no_half_files(project, what)

    def too_little_memory(self):
        project = self.fresh()
        self.skyquilt.call("surface", project, "--memory", "100kB", status=2, says="--memory")
        if (project / "surface").exists():
            self.no_half_files(project, "with too little memory")
        # The limit is kept in the project, as all options are.
        self.finish(project, "with enough memory after too little", "--memory", "2GiB")
        print("too little memory: status 2 with advice", flush=True)

    def damaged_results(self):
        """Textures of a finished surface, when its files have been lost."""
        project = self.folder / "lost"
        shutil.copytree(self.whole, project, symlinks=True)
        damaged = self.flip(project)
        expect(damaged, "nothing is kept of a finished surface")
        (project / "surface" / "surface.json").unlink()
        (project / "surface" / "mesh.glb").unlink()
        self.finish_or_name(project, damaged)
        print(f"a flipped bit in {damaged}: made again", flush=True)

    def no_surface(self):
        project = self.fresh()
        nothing = [word for option in ("min_views=100", "min_opacity=0.999", "virtual_views=false") for word in ("--set", f"surface.{option}")]
        self.skyquilt.call("surface", project, *nothing, says="no surface was found")
        left = sorted(path.name for path in (project / "surface").rglob("*") if path.is_file())
        expect(left == ["surface.json"], f"a scene without surface has files {left}")
        table = json.loads((project / "surface" / "surface.json").read_text())
        expect(table["triangles"] == 0 and table["files"] == [], f"the table of no surface: {table}")
        self.skyquilt.call("surface", project, *nothing, says="nothing to do")
        print("a scene without surface: a warning, no files", flush=True)


def test(skyquilt, folder):
    faults = Faults(skyquilt, pathlib.Path(folder), parse())
    print(f"an undisturbed run takes {faults.seconds:.1f} s, files and cache {faults.bytes / 1e6:.1f} MB", flush=True)
    faults.no_surface()
    faults.too_little_memory()
    faults.stop()
    faults.full_disk()
    faults.damaged_results()
    faults.kill_often()


if __name__ == "__main__":
    main(test)
