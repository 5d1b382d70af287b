"""Stages from Python: options, progress, interruptions that resume to the same bits, one project's log apart from another's."""
import os
import signal
import sys
import threading
import unittest

from support import PROGRAM, TINY, InFolder, harness

import skyquilt
from skyquilt._options import overrides

QUIET = {"quiet": True}
BATCHES = {"train": {"batch_samples": 4096}, "context": {"batch_samples": 4096, "steps": 10}}


def fields_of(project):
    """Digests of the arrays of all checkpoints."""
    files = sorted((project / "checkpoints").glob("*.h5"))
    return harness.arrays_of(PROGRAM, *files)


class Options(unittest.TestCase):
    def test_arguments_become_the_options_of_the_program(self):
        found = overrides("run", {"steps": 3000, "time_budget": "1h30m", "memory": "2GiB", "blocks": "2x2", "train": {"levels": 10, "robust_like": True},
                                  "prepare.holdout": "every:4", "partition": {"altitudes": [60, 80.5]}, "threads": 2})
        self.assertEqual(found, [("train.levels", "10"), ("train.robust_like", "true"), ("prepare.holdout", "every:4"), ("partition.altitudes", "60,80.5"),
                                 ("train.steps", "3000"), ("run.time_budget_s", "5400.000000"), ("run.memory_gb", "2"), ("partition.blocks", "2x2"),
                                 ("run.threads", "2")])
        self.assertEqual(overrides("simulate", {"seed": 3}), [("simulate.seed", "3")])
        self.assertEqual(overrides("prepare", {"scale_bars": ["a,b,2.5", "c,d,3"]}), [("prepare.scale_bars", "a,b,2.5|c,d,3")])
        self.assertEqual(overrides("prepare", {"gcp": "gcp.txt"}), [("prepare.gcp", os.path.abspath("gcp.txt"))])

    def test_wrong_ones_are_refused(self):
        for wrong, says in (
            (lambda: skyquilt.train("nowhere", stepps=3), "Did you mean 'steps'"),
            (lambda: skyquilt.train("nowhere", train=3), "is a section"),
            (lambda: skyquilt.train("nowhere", steps={"a": 1}), "cannot have the value"),
            (lambda: skyquilt.train("nowhere", progress=3), "a function of a label"),
            (lambda: skyquilt.run("photos", "out", place="hamlet"), "not both"),
            (lambda: skyquilt.run(None, "out"), "not both"),
            (lambda: skyquilt.train("nowhere", time_budget="soon"), "soon"),
        ):
            with self.assertRaisesRegex(skyquilt.UsageError, says):
                wrong()
        with self.assertRaisesRegex(skyquilt.InputError, "no such project folder"):
            skyquilt.train("nowhere", **QUIET)


class Stages(InFolder):
    def test_training_is_told_interrupted_and_resumed_to_the_same_bits(self):
        whole = harness.small_project(PROGRAM, self.folder / "whole")
        PROGRAM.call("train", whole, *harness.replaced(TINY, "--steps", "200"))
        project = skyquilt.open(harness.small_project(PROGRAM, self.folder / "parts"))
        told, stopped = [], []

        def interrupt(label, share):
            told.append((label, share))
            if label == "blocks" and 0.1 < share < 0.9 and not stopped:
                stopped.append(label)
                os.kill(os.getpid(), signal.SIGINT)

        with self.assertRaises(KeyboardInterrupt):
            skyquilt.train(project, steps=200, **BATCHES, **QUIET, progress=interrupt)
        self.assertTrue(stopped, told)
        self.assertTrue(all(0.0 <= share <= 1.0 for _, share in told))
        # What the callback raises comes out, and the state is saved too.
        with self.assertRaisesRegex(LookupError, "enough"):
            skyquilt.train(project, steps=200, **BATCHES, **QUIET, progress=self._raise)
        skyquilt.train(project, steps=200, **BATCHES, **QUIET)
        self.assertEqual(fields_of(project.folder), fields_of(whole))
        # Nothing is left of the cancelled calls: the next stage runs to its end.
        skyquilt.merge(project, **QUIET)
        self.assertTrue((project.folder / "scene.h5").exists())

    @staticmethod
    def _raise(label, share):
        raise LookupError("enough")

    def test_simulations_are_those_of_the_program_and_logs_stay_apart(self):
        survey = harness.small_survey(PROGRAM)
        made = skyquilt.simulate("hamlet", self.folder / "hamlet", image_width=160, **QUIET)
        for name in ("sparse/0/images.bin", "sparse/0/points3D.bin", "truth/buildings.json"):
            self.assertEqual((made / name).read_bytes(), (survey / name).read_bytes(), name)
        one = skyquilt.prepare(made, self.folder / "one", verbose=True, holdout="every:5", progress=lambda label, share: None)
        other = skyquilt.prepare(made, self.folder / "other", holdout="every:5", progress=lambda label, share: None)
        logs = [(project.folder / "log.txt").read_text() for project in (one, other)]
        self.assertGreater(min(len(log) for log in logs), 200)
        self.assertNotIn(str(other.folder), logs[0])
        self.assertNotIn(str(one.folder), logs[1])
        self.assertEqual(one.survey.names, other.survey.names)
        self.assertEqual(int(one.survey.held_out.sum()), -(-len(one.survey) // 5))
        # Results of other options are refused, and restart replaces them.
        with self.assertRaisesRegex(skyquilt.UsageError, "holdout"):
            skyquilt.prepare(made, one.folder, holdout="every:4", **QUIET)
        again = skyquilt.prepare(made, one.folder, holdout="every:4", restart=True, **QUIET)
        with self.assertRaisesRegex(skyquilt.InputError, "no such"):
            skyquilt.prepare([made, self.folder / "nothing"], self.folder / "two", **QUIET)
        with self.assertRaisesRegex(skyquilt.UsageError, "twice"):
            skyquilt.prepare([made, made], self.folder / "two", **QUIET)
        self.assertEqual(int(again.survey.held_out.sum()), -(-len(again.survey) // 4))

    def test_one_stage_at_a_time(self):
        project = skyquilt.open(harness.small_project(PROGRAM, self.folder / "project"))
        refused = []

        def second(label, share):
            if refused:
                return
            try:
                skyquilt.merge(project, **QUIET)
            except skyquilt.UsageError as error:
                refused.append(str(error))

        at_work = threading.Thread(target=lambda: skyquilt.train(project, steps=20, **BATCHES, **QUIET, progress=second))
        at_work.start()
        at_work.join()
        self.assertRegex(refused[0], "another stage is at work")
        self.assertEqual(len(project.training["fields"]), 3)

    def test_ranks_and_tours_are_for_the_program(self):
        os.environ["OMPI_COMM_WORLD_SIZE"] = "2"
        self.addCleanup(os.environ.pop, "OMPI_COMM_WORLD_SIZE", None)
        with self.assertRaisesRegex(skyquilt.UsageError, "mpirun"):
            skyquilt.simulate("hamlet", self.folder / "survey", **QUIET)
        del os.environ["OMPI_COMM_WORLD_SIZE"]
        with self.assertRaisesRegex(skyquilt.UsageError, "no tours"):
            skyquilt.run(harness.small_survey(PROGRAM), self.folder / "out", tour={"auto": 2}, **QUIET)
        with self.assertRaisesRegex(skyquilt.InputError, "no such folder"):
            skyquilt.run(self.folder / "nothing", self.folder / "out", **QUIET)


class Runs(InFolder):
    def test_a_run_makes_scene_and_scores(self):
        """All of it, as small as it can be."""
        parts = []
        project = skyquilt.run(harness.small_survey(PROGRAM), self.folder / "out", steps=40, blocks="1x1", image_width=160, **BATCHES,
                               partition={"max_log2_table_size": 14}, products={"video_seconds": 0, "preview": False, "resolution_m": 2}, surface={"enabled": False},
                               buildings={"enabled": False}, evaluate={"max_photos": 1}, progress=lambda label, share: parts.append(label), **QUIET)
        self.assertGreater(len(set(parts)), 2)
        self.assertEqual(len(project.metrics["images"]), 1)
        with project.scene(threads=1) as scene:
            scored = project.metrics["images"][0]
            name = scored["name"]
            self.assertTrue(scene.render(project.views([name], width=80)[0]).opacity.mean() > 0.2)


if __name__ == "__main__":
    sys.exit(unittest.main())
