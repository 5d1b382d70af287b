"""scripts/skyquilt-mpirun: restarts after a lost rank, gives up after the last restart, does not retry final results and passes on signals."""
import os
import pathlib
import signal
import subprocess

from harness import QUICK_TRAIN, children, expect, main, small_project, state_of, wait_for

LAUNCHER = str(pathlib.Path(__file__).resolve().parents[2] / "scripts" / "skyquilt-mpirun")


def test(skyquilt, folder):
    whole = small_project(skyquilt, folder / "whole")
    skyquilt.call("train", whole, *QUICK_TRAIN)

    def start(name, *words):
        log = folder / f"{name}.log"
        command = [LAUNCHER, "--restarts", "2", "--wait", "0", *words]
        process = subprocess.Popen(command, env=skyquilt.environment, stdout=open(log, "w"), stderr=subprocess.STDOUT, start_new_session=True)
        process.stdout = open(log)
        return process, log

    ranks = ["-n", "2", "--oversubscribe", skyquilt.program]

    def ranks_of(launcher):
        return [rank for mpirun in children(launcher) for rank in children(mpirun)]

    # A rank is killed during training. --restart applies to the first start only.
    project = small_project(skyquilt, folder / "lost")
    process, log = start("lost", *ranks, "train", str(project), *QUICK_TRAIN, "--restart")
    wait_for(lambda: any(project.glob("checkpoints/block_*.h5")), "first checkpoint of a block", process)
    os.kill(ranks_of(process.pid)[-1], signal.SIGKILL)
    expect(process.wait(timeout=300) == 0, log.read_text())
    text = log.read_text()
    expect("new start 1 of 2" in text and "ended with status 0 after 1 new start" in text, text)
    expect(state_of(skyquilt, project) == state_of(skyquilt, whole), "killed and started again differs from undisturbed")

    # A signal to the launcher makes the ranks save and end.
    project = small_project(skyquilt, folder / "stopped")
    process, log = start("stopped", *ranks, "train", str(project), *QUICK_TRAIN)
    wait_for(lambda: any(project.glob("checkpoints/block_*.h5")), "first checkpoint of a block", process)
    os.kill(process.pid, signal.SIGTERM)
    status = process.wait(timeout=120)
    expect(status == 130 and "new start" not in log.read_text(), f"ended with {status}:\n{log.read_text()}")
    skyquilt.call("train", project, *QUICK_TRAIN)
    expect(state_of(skyquilt, project) == state_of(skyquilt, whole), "stopped and continued differs from undisturbed")

    # A program that always dies is given up with its own status. A final result is not tried again.
    process, log = start("dies", "-n", "1", "sh", "-c", "kill -9 $$")
    status = process.wait(timeout=120)
    expect(status == 137 and "given up after 2 new starts" in log.read_text(), f"ended with {status}:\n{log.read_text()}")
    process, log = start("wrong", *ranks, "train", str(folder / "nowhere"))
    status = process.wait(timeout=120)
    expect(status in (2, 3) and "new start" not in log.read_text(), f"ended with {status}:\n{log.read_text()}")
    for words in (["--restarts", "many"], []):
        done = subprocess.run([LAUNCHER, *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        expect(done.returncode == 2, f"{words}: ended with {done.returncode}")


if __name__ == "__main__":
    main(test)
