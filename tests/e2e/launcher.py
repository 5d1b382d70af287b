"""scripts/skyquilt-mpirun: restarts after a rank that was lost or stands still, gives up after the last restart, does not retry final results and passes
on signals. Machines that see different disks, and containers on one disk."""
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import time

from harness import QUICK_TRAIN, children, expect, main, small_project, state_of, wait_for

LAUNCHER = str(pathlib.Path(__file__).resolve().parents[2] / "scripts" / "skyquilt-mpirun")


def check_other_disk(skyquilt, folder, project):
    """Rank 1 has a copy of the project under the same path, as on a machine whose disk is not the shared one."""
    copy = shutil.copytree(project, folder / "copy", symlinks=True)
    mounting = f"mount --bind '{copy}' '{project}'"
    if subprocess.run(["unshare", "-m", "sh", "-c", mounting], stderr=subprocess.DEVNULL).returncode != 0:
        print("a disk that is not shared: skipped, no right to mount")
        return
    words = [skyquilt.program, "train", str(project), *QUICK_TRAIN]
    began = time.monotonic()
    done = subprocess.run(["mpirun", "--oversubscribe", "-n", "1", *words, ":", "-n", "1", "unshare", "-m", "sh", "-c", mounting + ' && exec "$@"', "sh", *words],
                          env=skyquilt.environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=120)
    expect(done.returncode == 3 and time.monotonic() - began < 60, f"ended with {done.returncode}:\n{done.stdout}")
    for words in (str(project / "checkpoints"), f"rank 1 on {socket.gethostname()}", "disk that all machines share"):
        expect(words in done.stdout, f"'{words}' is missing:\n{done.stdout}")
    expect("--restart" not in done.stdout and not list(project.glob("checkpoints/*.h5")), f"it trained, or advises to train anew:\n{done.stdout}")


def check_containers(skyquilt, project):
    """In containers every program has process number 1: what one that was killed has left is in nobody's way, and stays."""
    left = [project / ".state" / f".{name}.json.tmp.1.{n}" for name in ("partition", "prepare") for n in range(40)]
    for path in left:
        path.write_text("another's")
    command = ["unshare", "-pf", skyquilt.program, "partition", str(project), "--restart", "--blocks", "1x2"]
    if subprocess.run(["unshare", "-pf", "true"], stderr=subprocess.DEVNULL).returncode != 0:
        print("containers: skipped, no right to make a process namespace")
        return
    done = subprocess.run(command, env=skyquilt.environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=120)
    expect(done.returncode == 0, f"ended with {done.returncode}:\n{done.stdout}")
    expect(all(path.exists() for path in left), "a file that another process made was removed")


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

    # A rank stands still: it is named with its host, and the job ends and goes on.
    project = small_project(skyquilt, folder / "stalled")
    process, log = start("stalled", "-n", "3", "--oversubscribe", skyquilt.program, "train", str(project), *QUICK_TRAIN, "--set", "run.rank_timeout_s=4")
    wait_for(lambda: any(project.glob("checkpoints/block_*.h5")), "first checkpoint of a block", process)
    os.kill(ranks_of(process.pid)[-1], signal.SIGSTOP)
    expect(process.wait(timeout=300) == 0, log.read_text())
    text = log.read_text()
    for words in (f"rank 2 on {socket.gethostname()} gives no sign of life", f"rank 2 on {socket.gethostname()} stood still", "status 75", "new start 1 of 2"):
        expect(words in text, f"'{words}' is missing:\n{text}")
    expect(state_of(skyquilt, project) == state_of(skyquilt, whole), "after a standstill the result differs from undisturbed")

    check_other_disk(skyquilt, folder, small_project(skyquilt, folder / "disk"))
    check_containers(skyquilt, small_project(skyquilt, folder / "containers"))

    # A signal to the launcher makes the ranks save and end.
    project = small_project(skyquilt, folder / "stopped")
    process, log = start("stopped", *ranks, "train", str(project), *QUICK_TRAIN)
    wait_for(lambda: any(project.glob("checkpoints/block_*.h5")), "first checkpoint of a block", process)
    os.kill(process.pid, signal.SIGTERM)
    status = process.wait(timeout=120)
    expect(status == 130 and "new start" not in log.read_text(), f"ended with {status}:\n{log.read_text()}")
    skyquilt.call("train", project, *QUICK_TRAIN)
    expect(state_of(skyquilt, project) == state_of(skyquilt, whole), "stopped and continued differs from undisturbed")

    # Ranks may take their time to save.
    saving = (f"trap 'sleep 2.5; touch {folder}/saved.$OMPI_COMM_WORLD_RANK; exit 130' USR1; touch {folder}/begun.$OMPI_COMM_WORLD_RANK; "
              "while :; do sleep 0.1; done")
    process, log = start("saving", "-n", "2", "--oversubscribe", "bash", "-c", saving)
    wait_for(lambda: len(list(folder.glob("begun.*"))) == 2, "first signs of both ranks", process)
    os.kill(process.pid, signal.SIGTERM)
    status = process.wait(timeout=60)
    expect(status == 130 and len(list(folder.glob("saved.*"))) == 2, f"ranks were not left to save, status {status}:\n{log.read_text()}")

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
