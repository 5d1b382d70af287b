"""The block of a rank that becomes very slow moves to an idle rank, which resumes from the checkpoint. The result is bit-identical."""
import os
import pathlib
import signal
import socket
import subprocess
import time

from harness import children, expect, main, small_project, state_of

TRAIN = ["--steps", "5000", "--set", "train.batch_samples=4096", "--set", "context.batch_samples=4096", "--set", "context.steps=300"]


def rank_of(pid):
    try:
        words = pathlib.Path(f"/proc/{pid}/environ").read_bytes().split(b"\0")
    except OSError:
        return None
    found = [word for word in words if word.startswith(b"OMPI_COMM_WORLD_RANK=")]
    return int(found[0].split(b"=")[1]) if found else None


def test(skyquilt, folder):
    whole = small_project(skyquilt, folder / "whole")
    skyquilt.call("train", whole, *TRAIN)

    slowed = small_project(skyquilt, folder / "slowed")
    log = folder / "slowed.log"
    with open(log, "w") as stream:
        process = subprocess.Popen(skyquilt.command(["train", slowed, *TRAIN], 3), env=skyquilt.environment, stdout=stream, stderr=subprocess.STDOUT,
                                   start_new_session=True)
    end = time.monotonic() + 400
    slow = None
    while process.poll() is None and "continues on rank" not in log.read_text():
        expect(time.monotonic() < end, f"no rank took over the slow rank's block:\n{log.read_text()}")
        if not any(slowed.glob("checkpoints/block_*")):
            time.sleep(0.05)
            continue
        if slow is None:
            slow = next((pid for pid in children(process.pid) if rank_of(pid) == 1), None)
            expect(slow is not None, "rank 1 is not there")
        os.kill(slow, signal.SIGSTOP)
        time.sleep(0.45)
        os.kill(slow, signal.SIGCONT)
        time.sleep(0.05)
    status = process.wait(timeout=300)
    text = log.read_text()
    expect(status == 0, f"ended with {status}:\n{text}")
    host = socket.gethostname()
    expect(f"continues on rank 2 on {host}: rank 1 on {host} is slow" in text, text)
    expect(state_of(skyquilt, slowed) == state_of(skyquilt, whole), "the moved block differs from one that stayed where it was")


if __name__ == "__main__":
    main(test)
