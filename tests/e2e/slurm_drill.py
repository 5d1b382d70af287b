"""scripts/skyquilt.slurm on a real Slurm of two nodes: a node is lost, then the time limit comes, and the result has the bits of an undisturbed run.

Usage: slurm_drill.py SKYQUILT [--steps N] [--keep FOLDER], in namespaces of its own: scripts/slurm_on_one_machine.sh
"""
import argparse
import os
import pathlib
import shutil
import sys
import tempfile
import time

from harness import Failure, Skyquilt, arrays_of, expect
from slurm_cluster import Cluster, read, run

ROOT = pathlib.Path(__file__).resolve().parents[2]
NODES = ["node1", "node2"]
TASKS_PER_NODE = 2
PICTURES = 160
OPTIONS = ["--blocks", "1x3", "--image-width", str(PICTURES), "--set", "train.batch_samples=4096", "--set", "context.batch_samples=4096", "--set",
           "partition.max_log2_table_size=14", "--set", "train.checkpoint_every_s=2", "--set", "context.checkpoint_every_s=2", "--set",
           "products.video_seconds=0", "--set", "surface.enabled=false", "--set", "evaluate.max_photos=4"]
# Slurm looks every 30 s which signals are due within the next 30 s: this one comes 20 to 50 s after a start.
TIME = ["--time=1", "--signal=B:USR1@10"]
ROOT_MAY = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


class Drill:
    def __init__(self, skyquilt, folder, steps):
        self.skyquilt, self.folder = skyquilt, folder
        self.options = [*OPTIONS, "--steps", str(steps)]
        self.began = time.monotonic()
        self.cluster = Cluster(folder / "slurm", NODES, TASKS_PER_NODE)
        self.project, self.log = folder / "out", folder / "job.log"

    def say(self, text):
        print(f"{time.monotonic() - self.began:6.1f} s  {text}", flush=True)

    def submit(self, survey):
        environment = dict(os.environ, **ROOT_MAY, SKYQUILT=self.skyquilt.program, TMPDIR=str(self.folder / "slurm" / "tmp"))
        shown = run("sbatch", "--nodes=2", f"--ntasks-per-node={TASKS_PER_NODE}", "--cpus-per-task=1", *TIME, f"--output={self.log}", "scripts/skyquilt.slurm",
                    "run", survey, "-o", self.project, *self.options, cwd=ROOT, env=environment)
        self.say(shown)
        return shown.split()[-1]

    def wait(self, number, condition, what, seconds):
        end = time.monotonic() + seconds
        while True:
            job = self.cluster.job(number)
            if condition(job):
                self.say(f"{what}: job {number} is {job.get('JobState')}, restarts {job.get('Restarts')}, reason {job.get('Reason')}")
                return job
            over = job.get("JobState") in ("COMPLETED", "FAILED", "TIMEOUT", "CANCELLED", "NODE_FAIL")
            if over or time.monotonic() > end:
                raise Failure(f"not seen: {what}; job {number} is {job.get('JobState')}, reason {job.get('Reason')}. The job's output ends with:\n"
                              f"{read(self.log)[-4000:]}")
            time.sleep(0.5)

    def trains(self, job):
        return job.get("JobState") == "RUNNING" and any(self.project.glob("checkpoints/block_*.h5"))

    def test(self):
        survey = self.folder / "survey"
        self.skyquilt.call("simulate", "hamlet", "-o", survey, "--image-width", PICTURES)
        whole = self.folder / "whole"
        self.skyquilt.call("run", survey, "-o", whole, *self.options)
        self.say("undisturbed run is done")

        self.cluster.start()
        self.say(f"{run('slurmctld', '-V')} with {len(NODES)} nodes: " + ", ".join(f"{name} {self.cluster.state(name)}" for name in NODES))
        number = self.submit(survey)
        self.wait(number, self.trains, "a block trains", 120)
        self.cluster.take_away(NODES[1])
        self.say(f"{NODES[1]} is taken away")
        self.wait(number, lambda job: job.get("Restarts") == "1", "Slurm misses the node and queues the job again", 180)
        self.cluster.start_node(NODES[1])
        self.say(f"{NODES[1]} is back")
        self.wait(number, lambda job: "the time limit is near" in read(self.log), "signal of the time limit", 400)
        self.wait(number, lambda job: int(job.get("Restarts", "0")) >= 2, "Slurm has queued the job again", 60)
        self.wait_for_end(number)
        self.compare(whole)

    def wait_for_end(self, number):
        job = self.wait(number, lambda job: job.get("JobState") in ("COMPLETED", "FAILED", "TIMEOUT", "CANCELLED", "NODE_FAIL"), "the end", 600)
        expect(job["JobState"] == "COMPLETED" and job["ExitCode"] == "0:0", f"the job ended as {job['JobState']}:\n{read(self.log)[-4000:]}")

    def compare(self, whole):
        names = sorted(str(path.relative_to(whole)) for path in [whole / "scene.h5", *whole.glob("checkpoints/*.h5")])
        expect(len(names) == 5, f"the undisturbed run has {names} instead of a scene, a context and three blocks")
        compared = 0
        both = (arrays_of(self.skyquilt, *(project / name for name in names)) for project in (whole, self.project))
        for name, wanted, found in zip(names, *both, strict=True):
            differing = [array for array in wanted if found.get(array) != wanted[array]]
            expect(wanted.keys() == found.keys() and not differing, f"{name} differs from that of the undisturbed run in {differing}")
            compared += len(wanted)
        self.say(f"same bits as the undisturbed run: {compared} arrays of {', '.join(names)}")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("skyquilt")
    parser.add_argument("--steps", type=int, default=15000)
    parser.add_argument("--keep", type=pathlib.Path)
    options = parser.parse_args()
    if os.getpid() != 1:
        parser.error("call scripts/slurm_on_one_machine.sh, which gives this script namespaces of its own")
    if options.keep and options.keep.exists() and any(options.keep.iterdir()):
        parser.error(f"--keep {options.keep}: the folder is not empty")
    folder = options.keep.resolve() if options.keep else pathlib.Path(tempfile.mkdtemp(prefix="skyquilt_slurm_"))
    drill = Drill(Skyquilt(options.skyquilt), folder, options.steps)
    status = 1
    try:
        drill.test()
        print("passed")
        status = 0
    except Failure as failure:
        print(f"FAILED: {failure}")
    finally:
        drill.cluster.stop()
        if not options.keep:
            shutil.rmtree(folder, ignore_errors=True)
    sys.exit(status)


if __name__ == "__main__":
    main()
