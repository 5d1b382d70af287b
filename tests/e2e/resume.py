"""A run that is killed or interrupted during training is resumed by the same command and ends with the result of an undisturbed run."""
import os
import signal

from harness import SMALL, expect, hamlet, kill_group, main, metrics_of, replaced, wait_for


def test(skyquilt, folder):
    survey = hamlet(skyquilt, 240)
    # Blocks that take long enough to be stopped in between.
    options = replaced(SMALL, "--steps", "450") + ["--set", "train.checkpoint_every_s=0.3", "--set", "context.checkpoint_every_s=0.3"]
    whole = folder / "whole"
    skyquilt.call("run", survey, "-o", whole, *options)

    def block_begun(project):
        return lambda: any(project.glob("checkpoints/block_*.h5"))

    killed = folder / "killed"
    process = skyquilt.start("run", survey, "-o", killed, *options)
    wait_for(block_begun(killed), "first checkpoint of a block", process)
    kill_group(process)
    expect(not (killed / "scene.h5").exists(), "the run was over before it could be killed")
    skyquilt.call("run", survey, "-o", killed, *options, says="prepare: nothing to do")
    difference = abs(metrics_of(killed)["psnr"] - metrics_of(whole)["psnr"])
    expect(difference < 1e-6, f"killed and resumed differs by {difference} dB")

    for ranks in (0, 2):
        stopped = folder / f"stopped{ranks}"
        process = skyquilt.start("run", survey, "-o", stopped, *options, ranks=ranks)
        wait_for(block_begun(stopped), "first checkpoint of a block", process)
        os.kill(process.pid, signal.SIGINT)
        process.communicate(timeout=120)
        # A launcher may kill slow ranks itself and report that instead.
        expect(process.returncode == 130 or ranks, f"interrupted run ended with {process.returncode}")
        skyquilt.call("run", survey, "-o", stopped, *options, ranks=ranks)
        difference = abs(metrics_of(stopped)["psnr"] - metrics_of(whole)["psnr"])
        expect(difference < 0.1, f"interrupted and resumed on {ranks} ranks differs by {difference} dB")


main(test)
