"""Disturbs small trainings by kills, full disks and damaged files. Every one must resume and end with the same result as undisturbed.

Usage: fault_drill.py SKYQUILT [--kills 200] [--truncations 20] [--flips 100] [--seed 1]
"""
import argparse
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import time

from harness import QUICK_TRAIN, Failure, children, expect, main, small_project, state_of

LAYOUTS = (0, 2, 3)  # ranks; 0: without a launcher
WAYS = ("anywhere", "while a checkpoint is written", "just after one")


class Drill:
    def __init__(self, skyquilt, folder, options):
        self.skyquilt = skyquilt
        self.folder = folder
        self.options = options
        self.random = random.Random(options.seed)
        self.projects = 0
        self.kills = dict.fromkeys(WAYS, 0)
        self.unreadable = 0
        self.template = small_project(skyquilt, folder / "template")
        self.wanted = {}
        for ranks in LAYOUTS:
            project = self.fresh()
            skyquilt.call("train", project, *QUICK_TRAIN, ranks=ranks)
            self.wanted[ranks] = state_of(skyquilt, project)

    def fresh(self, parent=None):
        self.projects += 1
        project = (parent or self.folder) / f"project{self.projects}"
        shutil.copytree(self.template, project, symlinks=True)
        return project

    def compare(self, project, ranks, what):
        found, wanted = state_of(self.skyquilt, project), self.wanted[ranks]
        for name, arrays in wanted.items():
            differing = [array for array in arrays if found[name].get(array) != arrays[array]]
            expect(not differing, f"{what} (ranks: {ranks}): {name} differs from an undisturbed run in {differing}")

    def wait_for_moment(self, process, project, way, began):
        """Waits for the moment to kill the process. False if it ended before."""
        checkpoints = project / "checkpoints"

        def writing():
            return checkpoints.exists() and any(".tmp" in name for name in os.listdir(checkpoints))

        end = began + self.random.uniform(0.05, 1.6)
        while time.monotonic() < end:
            if process.poll() is not None:
                return False
            time.sleep(0.002)
        if way != WAYS[0]:
            while not writing():
                if process.poll() is not None:
                    return False
                time.sleep(0.0003)
        if way == WAYS[2]:
            while writing():
                if process.poll() is not None:
                    return False
        return process.poll() is None

    def kill_one(self, process, ranks):
        """Kills one rank or the launcher, then the rest of the job, as a batch system would."""
        victims = (children(process.pid) + [process.pid]) if ranks else [process.pid]
        try:
            os.kill(self.random.choice(victims), signal.SIGKILL)
        except ProcessLookupError:
            pass
        try:
            process.communicate(timeout=30)
        except subprocess.TimeoutExpired:
            raise Failure(f"{ranks} ranks still ran 30 s after one was killed")
        finally:
            try:
                os.killpg(process.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
        for victim in victims:  # orphans of a killed launcher
            while pathlib.Path(f"/proc/{victim}").exists() and victim != process.pid:
                try:
                    os.kill(victim, signal.SIGKILL)
                except ProcessLookupError:
                    break
                time.sleep(0.005)

    def check_readable(self, project):
        """Of every field that ever had a checkpoint, the newest or the one before it must be whole."""
        names = {p.name.removesuffix(".prev") for p in (project / "checkpoints").glob("*.h5*") if ".tmp" not in p.name}
        for name in names:
            candidates = [project / "checkpoints" / name, project / "checkpoints" / (name + ".prev")]
            whole = [subprocess.run([self.skyquilt.program, "info", str(c)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode == 0
                     for c in candidates if c.exists()]
            self.unreadable += not any(whole)
            expect(any(whole), f"after a kill no checkpoint of {name} in {project} can be read")

    def kill_until(self, wanted_kills):
        finished = 0
        while sum(self.kills.values()) < wanted_kills:
            ranks = self.random.choice(LAYOUTS)
            project = self.fresh()
            while True:
                way = self.random.choice(WAYS)
                process = self.skyquilt.start("train", project, *QUICK_TRAIN, ranks=ranks)
                if sum(self.kills.values()) < wanted_kills and self.wait_for_moment(process, project, way, time.monotonic()):
                    self.kill_one(process, ranks)
                    self.kills[way] += 1
                    self.check_readable(project)
                    continue
                text = process.communicate(timeout=600)[0]
                expect(process.returncode == 0, f"resumed training (ranks: {ranks}) ended with {process.returncode}:\n{text}")
                break
            self.compare(project, ranks, "killed and resumed")
            shutil.rmtree(project)
            finished += 1
            print(f"{sum(self.kills.values())} of {wanted_kills} kills, {finished} trainings ended with the result of an undisturbed one", flush=True)
        print("kills " + ", ".join(f"{n} {way}" for way, n in self.kills.items()) + f"; {self.unreadable} unreadable checkpoints, 0 lost blocks")

    def full_disk(self):
        disk = self.folder / "disk"
        disk.mkdir()
        need = sum(p.stat().st_size for p in self.template.rglob("*") if p.is_file())
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={need + 3_000_000}", "tmpfs", str(disk)], stderr=subprocess.PIPE, text=True)
        if mounted.returncode != 0:
            print(f"full disk and read-only folder: skipped, no right to mount ({mounted.stderr.strip()})")
            return
        try:
            project = self.fresh(disk)
            text = self.skyquilt.call("train", project, *QUICK_TRAIN, status=3)
            expect("No space left" in text or "disk" in text.lower(), f"a full disk is not named:\n{text}")
            expect(str(disk) in text or "checkpoints" in text, f"the file that could not be written is not named:\n{text}")
            subprocess.run(["mount", "-o", "remount,size=200000000", str(disk)], check=True)
            self.skyquilt.call("train", project, *QUICK_TRAIN)
            self.compare(project, 0, "resumed after a full disk")
            shutil.rmtree(project / "checkpoints")
            subprocess.run(["mount", "-o", "remount,ro", str(disk)], check=True)
            text = self.skyquilt.call("train", project, *QUICK_TRAIN, status=3)
            expect("ead-only" in text or "write" in text, f"a read-only folder is not named:\n{text}")
            subprocess.run(["mount", "-o", "remount,rw", str(disk)], check=True)
            self.skyquilt.call("train", project, *QUICK_TRAIN)
            self.compare(project, 0, "resumed after a read-only folder")
        finally:
            subprocess.run(["umount", "-l", str(disk)])
        print("full disk, read-only folder: reported, nothing lost, resumed with bit-identical results")

    def half_way(self):
        """A training that was killed when a block had a checkpoint and a previous checkpoint: (project, checkpoint)."""
        while True:
            project = self.fresh()
            process = self.skyquilt.start("train", project, *QUICK_TRAIN)
            while process.poll() is None:
                if any(project.glob("checkpoints/block_*.prev")):
                    time.sleep(self.random.uniform(0.0, 0.2))
                    self.kill_one(process, 0)
                    break
                time.sleep(0.001)
            process.wait()
            damaged = [p for p in project.glob("checkpoints/block_*.h5") if p.with_name(p.name + ".prev").exists()]
            process.stdout.close()
            if damaged:
                return project, damaged[0]

    def damage(self):
        project, file = self.half_way()
        content = file.read_bytes()
        used = 0
        broken = []
        for _ in range(self.options.truncations):
            broken.append(content[:self.random.randrange(len(content))])
        for _ in range(self.options.flips):
            changed = bytearray(content)
            changed[self.random.randrange(len(changed))] ^= 1 << self.random.randrange(8)
            broken.append(bytes(changed))
        for bytes_ in broken:
            file.write_bytes(bytes_)
            done = subprocess.run([self.skyquilt.program, "info", str(file)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace",
                                  timeout=60)
            expect(done.returncode == 3 and file.name in done.stdout, f"damage was not found, status {done.returncode}:\n{done.stdout}")
        # A damaged or foreign newest file is refused with a reason, and the previous file is used.
        for kind, bytes_ in (("cut off", broken[0]), ("with a flipped bit", broken[-1]), ("of something else", b"not a checkpoint" * 100), ("empty", b"")):
            copy = self.folder / "damaged"
            shutil.copytree(project, copy, symlinks=True)
            (copy / "checkpoints" / file.name).write_bytes(bytes_)
            self.skyquilt.call("train", copy, *QUICK_TRAIN, says=file.name)
            self.compare(copy, 0, f"resumed with a file {kind}")
            shutil.rmtree(copy)
            used += 1
        print(f"{self.options.truncations} truncations and {self.options.flips} flipped bits: all found; {used} trainings resumed from the previous file")


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("skyquilt")
    parser.add_argument("--kills", type=int, default=200)
    parser.add_argument("--truncations", type=int, default=20)
    parser.add_argument("--flips", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    return parser.parse_args()


def test(skyquilt, folder):
    drill = Drill(skyquilt, folder, parse())
    same = all(drill.wanted[ranks] == drill.wanted[0] for ranks in LAYOUTS)
    print(f"reference trainings on {LAYOUTS} ranks are {'bit-identical' if same else 'each repeatable, not the same'}", flush=True)
    drill.damage()
    drill.full_disk()
    drill.kill_until(drill.options.kills)


if __name__ == "__main__":
    if len(sys.argv) < 2 or sys.argv[1] in ("-h", "--help"):
        parse()
    main(test)
