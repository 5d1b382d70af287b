"""Runs the skyquilt program as a user would and checks exit status and files. Needs only Python's standard library."""
import atexit
import contextlib
import fcntl
import hashlib
import json
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

STEPS = "300"
# Small fields: these tests are about the pipeline, not about image quality.
SMALL = ["--steps", STEPS, "--blocks", "1x2", "--image-width", "240", "--set", "train.batch_samples=8192", "--set", "context.batch_samples=8192",
         "--set", "partition.max_log2_table_size=15", "--set", "products.video_seconds=0", "--set", "products.resolution_m=0.3",
         "--set", "surface.enabled=false"]

# For small_project: two blocks of some seconds each, saved so often that a checkpoint is always recent.
QUICK_TRAIN = ["--steps", "300", "--set", "train.checkpoint_every_s=0.1", "--set", "context.checkpoint_every_s=0.1", "--set", "train.batch_samples=4096",
               "--set", "context.batch_samples=4096"]


class Failure(Exception):
    pass


def expect(condition, text):
    if not condition:
        raise Failure(text)


class Skyquilt:
    def __init__(self, program):
        self.program = program
        self.environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")

    def command(self, words, ranks):
        launcher = ["mpirun", "-n", str(ranks), "--oversubscribe"] if ranks else []
        return launcher + [self.program] + [str(word) for word in words]

    def call(self, *words, ranks=0, status=0, timeout=900, says=()):
        """Runs to the end and returns everything printed; a different exit status is a failure, and so is a text of `says` that was not printed."""
        shown, began, used = " ".join(str(word) for word in words), time.monotonic(), cpu_seconds()
        done = subprocess.run(self.command(words, ranks), env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              errors="replace", timeout=timeout)
        # What the test's time is spent on.
        print(f"{time.monotonic() - began:6.1f} s, {cpu_seconds() - used:6.1f} CPU s  skyquilt {shown}", flush=True)
        expect(done.returncode == status, f"'skyquilt {shown}' ended with {done.returncode}, not {status}:\n{done.stdout}")
        for text in [says] if isinstance(says, str) else says:
            expect(text in done.stdout, f"'skyquilt {shown}' does not say '{text}':\n{done.stdout}")
        return done.stdout

    def start(self, *words, ranks=0):
        return subprocess.Popen(self.command(words, ranks), env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                errors="replace", start_new_session=True)


def cpu_seconds():
    """Of all programs that this test started and that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def replaced(words, flag, value):
    changed = list(words)
    changed[changed.index(flag) + 1] = value
    return changed


def metrics_of(project):
    return json.loads((project / "report" / "metrics.json").read_text())


def wait_for(condition, what, process, seconds=300):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return
        if process.poll() is not None:
            raise Failure(f"the program ended before {what}:\n{process.stdout.read()}")
        time.sleep(0.01)
    raise Failure(f"no {what} within {seconds} s")


def digest(folder, but=()):
    """Names, sizes and times of all files below a folder."""
    found = {}
    for path in sorted(folder.rglob("*")):
        if path.is_file() and path.name not in but:
            stat = path.stat()
            found[str(path.relative_to(folder))] = (stat.st_size, stat.st_mtime_ns)
    return found


def kill_group(process):
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()


@contextlib.contextmanager
def locked(path):
    pathlib.Path(path).parent.mkdir(parents=True, exist_ok=True)
    with open(path, "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def shared(skyquilt, name, make):
    """A folder that several tests read and none changes: the first test that needs it calls make(folder). It is kept in SKYQUILT_TEST_SHARED, which
    ctest sets, until the program changes; without that, every run of a test makes its own."""
    root = os.environ.get("SKYQUILT_TEST_SHARED")
    if not root:
        own = tempfile.mkdtemp(prefix="skyquilt_shared_")
        atexit.register(shutil.rmtree, own, ignore_errors=True)
        root = os.environ["SKYQUILT_TEST_SHARED"] = os.path.join(own, "shared")
    of_program = pathlib.Path(root) / hashlib.sha256(pathlib.Path(skyquilt.program).read_bytes()).hexdigest()[:16]
    with locked(f"{root}.lock"):
        if not of_program.exists():
            shutil.rmtree(root, ignore_errors=True)  # those of former programs
            of_program.mkdir(parents=True)
    with locked(of_program / f"{name}.lock"):
        folder, finished = of_program / name, of_program / f"{name}.finished"
        if not finished.exists():
            shutil.rmtree(folder, ignore_errors=True)
            make(folder)
            finished.touch()
        return folder


def hamlet(skyquilt, width):
    """The simulated hamlet with photos of that width; only to be read."""
    return shared(skyquilt, f"hamlet_{width}", lambda folder: skyquilt.call("simulate", "hamlet", "-o", folder, "--image-width", width))


def small_survey(skyquilt):
    return hamlet(skyquilt, 160)


def copied(source, target):
    shutil.copytree(source, target, symlinks=True)
    return target


def prepare_small(skyquilt, survey, project):
    """Prepares a survey and divides it into two blocks, ready to be trained."""
    skyquilt.call("prepare", survey, "-o", project)
    skyquilt.call("partition", project, "--blocks", "1x2", "--set", "partition.max_log2_table_size=14")
    return project


def small_project(skyquilt, project):
    """A project of the small survey, from prepare_small."""
    return copied(shared(skyquilt, "small_project", lambda folder: prepare_small(skyquilt, small_survey(skyquilt), folder)), project)


HOUSES_WIDTH = 360


def houses_project(skyquilt, project):
    """A finished project of the hamlet, trained long enough that a house can be measured, with a surface; returns its survey too. By steps, so that
    it does not depend on what runs beside it."""
    survey = hamlet(skyquilt, HOUSES_WIDTH)

    def make(folder):
        skyquilt.call("run", survey, "-o", folder, "--blocks", "1x1", "--image-width", HOUSES_WIDTH, "--steps", "900", "--set",
                      "context.steps=500", "--set", "products.resolution_m=0.2", "--set", "products.video_seconds=0", "--set", "buildings.enabled=false", "--set", "evaluate.max_photos=1")

    return copied(shared(skyquilt, "houses", make), project), survey


def arrays_of(skyquilt, *files):
    """Digest of every array, for each file. Attributes, such as seconds, may differ and are left out."""
    described = json.loads(skyquilt.call("info", *files, "--json"))
    return [{array["name"]: array["xxh64"] for array in one["arrays"]} for one in ([described] if len(files) == 1 else described.values())]


def state_of(skyquilt, project):
    files = sorted(p for p in (project / "checkpoints").glob("*.h5"))
    expect(len(files) == 3, f"{project} has {[p.name for p in files]} instead of the context and two blocks")
    return dict(zip([p.name for p in files], arrays_of(skyquilt, *files)))


def children(pid):
    found = subprocess.run(["ps", "-o", "pid=", "--ppid", str(pid)], stdout=subprocess.PIPE, text=True).stdout.split()
    return [int(word) for word in found]


def main(test):
    folder = pathlib.Path(tempfile.mkdtemp(prefix="skyquilt_e2e_"))
    try:
        test(Skyquilt(sys.argv[1]), folder)
        print(f"passed; {cpu_seconds():.1f} CPU s in all")
    except Failure as failure:
        print(f"FAILED: {failure}")
        sys.exit(1)
    finally:
        for path in folder.rglob("*"):
            if path.is_dir() and not path.is_symlink():
                path.chmod(0o755)
        shutil.rmtree(folder, ignore_errors=True)
