"""Scenes: pictures as the program renders them, points against rays, frames, threads, lifetimes."""
import copy
import gc
import json
import os
import pathlib
import pickle
import resource
import signal
import subprocess
import sys
import threading
import time
import unittest
import weakref

import numpy as np
from support import PRELOADED, PROGRAM, InFolder, pixels, scene_project

import skyquilt

NEAR = {"position_enu": (0.0, -25.0, 35.0), "yaw": 0.0, "pitch": -50.0}


def setUpModule():
    global PROJECT, SCENE
    PROJECT = skyquilt.open(scene_project())
    SCENE = PROJECT.scene()


def tearDownModule():
    SCENE.close()


class Pictures(InFolder):
    def test_photos_are_those_of_the_program(self):
        PROGRAM.call("render", PROJECT.folder, "--test", "--width", 120, "--normals", "density", "-o", self.folder)
        views = PROJECT.views(width=120)
        self.assertGreater(len(views), 1)
        for view in views[:2]:
            picture = SCENE.render(view, normals="density")
            np.testing.assert_array_equal(picture.rgb8, pixels(self.folder / f"{view.name}.png"))
            self.assertEqual(picture.depth.tobytes(), pixels(self.folder / f"{view.name}_depth.tiff").tobytes())
            known = np.isfinite(picture.normals)
            coded = np.where(known, np.round(32768.0 + 32767.0 * np.where(known, picture.normals, 0.0).astype(np.float64)), 0)
            self.assertLessEqual(np.abs(coded - pixels(self.folder / f"{view.name}_normals.png")).max(), 1)

    def test_paths_are_those_of_the_program(self):
        path = {"views": [NEAR, {**NEAR, "position_enu": (10.0, -25.0, 30.0), "fov": 40.0}], "frames_between": 1}
        file = self.folder / "path.json"
        file.write_text(json.dumps(path))
        PROGRAM.call("render", PROJECT.folder / "scene.h5", "--path", file, "--width", 96, "-o", self.folder, "--exposure", "0.5")
        pictures = SCENE.render(file, width=96, exposure=0.5)
        self.assertEqual(len(pictures), 3)
        for given in (path, [view for view in SCENE.views(file, width=96)]):
            size = {} if isinstance(given, list) else {"width": 96}
            for picture, same in zip(pictures, SCENE.render(given, **size, exposure=0.5), strict=True):
                np.testing.assert_array_equal(picture.color, same.color)
        for picture in pictures:
            np.testing.assert_array_equal(picture.rgb8, pixels(self.folder / "path" / f"{picture.view.name}.png"))

    def test_poses_of_all_kinds_agree(self):
        first = SCENE.render(NEAR, width=64, height=48, fov=50.0)
        self.assertEqual(first.color.shape, (48, 64, 3))
        self.assertEqual(first.depth.shape, (48, 64))
        matrix = first.view.cam_from_enu
        np.testing.assert_allclose(first.view.center, NEAR["position_enu"], atol=1e-9)
        np.testing.assert_allclose(matrix[:3, :3] @ matrix[:3, :3].T, np.eye(3), atol=1e-12)
        # North is ahead: the camera looks along +y and down by 50 degrees; its x axis is east.
        np.testing.assert_allclose(matrix[0, :3], [1, 0, 0], atol=1e-12)
        np.testing.assert_allclose(matrix[2, :3], [0, np.cos(np.radians(50)), -np.sin(np.radians(50))], atol=1e-12)
        second = SCENE.render(matrix, width=64, height=48, fov=50.0)
        np.testing.assert_allclose(first.color, second.color, atol=2e-3)
        target = first.view.center + 10.0 * matrix[2, :3]
        third = SCENE.render(skyquilt.View.looking_at(first.view.center, target, first.view.camera))
        np.testing.assert_allclose(first.color, third.color, atol=2e-3)
        longitude, latitude, height = SCENE.from_enu(NEAR["position_enu"], "wgs84")
        fourth = SCENE.render({"longitude": longitude, "latitude": latitude, "height": np.float64(height), "pitch": -50}, 64, 48, fov=50.0)
        np.testing.assert_allclose(first.color, fourth.color, atol=2e-3)
        self.assertEqual([len(SCENE.render(np.stack([matrix, matrix]), width=8, height=8)), len(SCENE.render([NEAR], width=8))], [2, 1])

    def test_the_point_under_a_pixel_is_where_its_ray_ends(self):
        picture = SCENE.render(NEAR, width=64, height=48)
        row, column = 30, 20
        inverse = np.linalg.inv(picture.view.camera.matrix)
        in_camera = inverse @ [column + 0.5, row + 0.5, 1.0]
        direction = picture.view.cam_from_enu[:3, :3].T @ (in_camera / np.linalg.norm(in_camera))
        pitch = 1.0 / picture.view.camera.params[0]
        ray = SCENE.cast([picture.view.center], [3.0 * direction], pitch=pitch, background=True)
        self.assertAlmostEqual(float(ray.depth[0]), float(picture.depth[row, column]), delta=0.05)
        np.testing.assert_allclose(ray.color[0], picture.color[row, column], atol=0.02)
        self.assertLess(ray.depth_front[0], ray.depth_back[0])

    def test_threads_give_the_same_bits(self):
        with PROJECT.scene(threads=1) as alone:
            one, other = (scene.render(NEAR, 64, normals="depth") for scene in (alone, SCENE))
            for name in ("color", "depth", "opacity", "normals", "rgb8"):
                self.assertEqual(getattr(one, name).tobytes(), getattr(other, name).tobytes(), name)
            points = np.random.default_rng(1).uniform(SCENE.info["min_enu"], SCENE.info["max_enu"], (5000, 3))
            self.assertEqual(alone.query(points).color.tobytes(), SCENE.query(points).color.tobytes())


class Points(unittest.TestCase):
    def setUp(self):
        random = np.random.default_rng(7)
        low, high = np.array(SCENE.info["min_enu"]), np.array(SCENE.info["max_enu"])
        # Places near the surface, of which the most are in cells that are not free, also beyond the blocks, where the context is.
        plan = random.uniform(low[:2] - 20.0, high[:2] + 20.0, (4000, 2))
        heights = SCENE.cast(np.column_stack([plan, np.full(4000, high[2])]), np.tile([0.0, 0.0, -1.0], (4000, 1)))
        self.points = np.column_stack([plan, high[2] - heights.depth + random.normal(0, 0.3, 4000)])
        self.points = self.points[np.isfinite(self.points).all(axis=1)]

    def test_density_and_colour_are_those_of_a_sample_of_a_ray(self):
        """A ray without width takes its first sample half a step after its start. So a ray that starts there and ends before the next one has the
        optical depth density * step, and the colour of this place."""
        steps = {block["properties"]["name"]: block["properties"]["finest_voxel_m"] for block in PROJECT.blocks["features"]}
        for block in SCENE.info["blocks"]:
            # Where no other field has a part, and rays start inside the block. tests/core/scene/point_query_test.cpp has the places where fields are blended.
            step = steps[block["name"]]
            margin = np.array([block["margin_m"], block["margin_m"], step])
            inside = ((self.points > block["min_enu"] + margin) & (self.points < block["max_enu"] - margin)).all(axis=1)
            self._compare(self.points[inside], step, 1.0)

    def test_the_context_answers_beyond_the_blocks(self):
        low, high = np.array(SCENE.info["min_enu"])[:2], np.array(SCENE.info["max_enu"])[:2]
        margin = max(block["margin_m"] for block in SCENE.info["blocks"])
        random = np.random.default_rng(9)
        heights = (SCENE.info["min_enu"][2], SCENE.info["max_enu"][2])
        points = np.column_stack([random.uniform(low - 4 * margin, high + 4 * margin, (20000, 2)), random.uniform(*heights, 20000)])
        points = points[((points[:, :2] < low - margin) | (points[:, :2] > high + margin)).any(axis=1)]
        points = points[SCENE.query(points).density > 0.0][:1000]
        self.assertGreater(len(points), 20)
        # Its step is not in a file: the shortest ray that meets something is half of one long.
        short, long = 0.0, 8.0
        for _ in range(40):
            middle = 0.5 * (short + long)
            met = SCENE.cast(points, np.tile([0.0, 0.0, -1.0], (len(points), 1)), far_m=middle).opacity.any()
            short, long = (short, middle) if met else (middle, long)
        # Steps are longer where space is contracted, which the C++ test allows for.
        self._compare(points, 2.0 * long, 0.5)

    def _compare(self, points, step, share):
        directions = np.random.default_rng(3).normal(size=points.shape)
        directions[:, 2] = -np.abs(directions[:, 2])
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        rays = SCENE.cast(points - 0.5 * step * directions, directions, far_m=step)
        asked = SCENE.query(points, directions=directions)
        clear = (rays.opacity > 1e-3) & (rays.opacity < 0.98)
        self.assertGreater(np.count_nonzero(clear), 10)
        depth = -np.log1p(-rays.opacity[clear].astype(np.float64))
        self.assertGreaterEqual(np.mean(np.abs(asked.density[clear] * step - depth) < 2e-3 * depth), share)
        np.testing.assert_allclose(asked.density[clear] * step, depth, rtol=2e-3 if share == 1.0 else 0.3)
        same = np.abs(asked.color[clear] - rays.color[clear] / rays.opacity[clear, np.newaxis]).max(axis=1) < 2e-3
        self.assertGreaterEqual(np.mean(same), share)
        # Free space for one is free space for the other, but for places at the border of a cell.
        self.assertLess(np.mean((asked.density == 0.0) != (rays.opacity == 0.0)), 0.01 + (1.0 - share))
        self.assertTrue(np.isfinite(asked.color[asked.density > 0]).all() and np.isnan(asked.color[asked.density == 0]).all())

    def test_frames_agree(self):
        in_enu = SCENE.query(self.points)
        for frame in ("utm", "wgs84"):
            places = SCENE.from_enu(self.points, frame)
            np.testing.assert_allclose(SCENE.to_enu(places, frame), self.points, atol=1e-6)
            asked = SCENE.query(places, frame)
            np.testing.assert_allclose(np.log1p(asked.density), np.log1p(in_enu.density), atol=0.02)
        longitude, latitude, height = SCENE.info["origin"]
        np.testing.assert_allclose(SCENE.to_enu((longitude, latitude, height), "wgs84"), (0, 0, 0), atol=1e-8)

    def test_shapes(self):
        grid = self.points[:24].reshape(2, 3, 4, 3)
        asked = SCENE.query(grid)
        self.assertEqual((asked.density.shape, asked.color.shape), ((2, 3, 4), (2, 3, 4, 3)))
        np.testing.assert_array_equal(asked.density.reshape(-1), SCENE.query(self.points[:24]).density)
        one = SCENE.query(self.points[0], colors=False)
        self.assertEqual((one.density.shape, one.color.shape), ((), (3,)))
        self.assertTrue(np.isnan(one.color).all())
        none = SCENE.query(np.empty((0, 3)))
        self.assertEqual(none.density.shape, (0,))
        lost = SCENE.query([(np.nan, 0, 0), (0, np.inf, 0), (0, 0, 1e6)])
        np.testing.assert_array_equal(lost.density, [np.nan, np.nan, 0.0])

    def test_speed(self):
        """By the processor's time, so that it does not depend on what runs beside."""
        with PROJECT.scene(threads=1) as alone:
            many = np.tile(self.points, (40, 1))
            alone.query(many[:1000])
            rates = {}
            for colors in (False, True):
                began = time.process_time()
                asked = alone.query(many, colors=colors)
                rates[colors] = len(many) / (time.process_time() - began)
        print(f"one core: {rates[False] / 1e6:.2f} million densities or {rates[True] / 1e6:.2f} million densities and colours per second; "
              f"{100 * np.count_nonzero(asked.density) / len(many):.0f} % of the points in cells that are not free")
        self.assertGreater(rates[True], 0.0 if PRELOADED else 1e5)

    def test_heights_are_those_of_rays_straight_down(self):
        plan = self.points[:200, :2]
        low, high = np.array(SCENE.info["min_enu"]), np.array(SCENE.info["max_enu"])
        inside = plan[((plan > low[:2]) & (plan < high[:2])).all(axis=1)]
        heights = SCENE.heights(inside, width_m=0.1)
        self.assertGreater(np.count_nonzero(np.isfinite(heights)), 20)
        self.assertTrue(np.isnan(SCENE.heights((high[0] + 1.0, 0.0))))
        utm = SCENE.from_enu(np.column_stack([inside, np.where(np.isfinite(heights), heights, 0.0)]), "utm")
        in_utm = SCENE.heights(utm[:, :2], "utm", width_m=0.1)
        both = np.isfinite(heights) & np.isfinite(in_utm)
        self.assertLess(np.median(np.abs(in_utm[both] - utm[both, 2])), 0.05)
        longitude_latitude = SCENE.from_enu(np.column_stack([inside, np.zeros(len(inside))]), "wgs84")[:, :2]
        np.testing.assert_allclose(SCENE.heights(longitude_latitude, "wgs84", width_m=0.1)[both], in_utm[both], atol=0.2)


class SurfaceModel(InFolder):
    def test_heights_are_those_of_the_map(self):
        PROGRAM.call("render", PROJECT.folder, "--dsm", "--resolution", "1", "-o", self.folder)
        dsm = pixels(self.folder / "dsm.tif")[:, :, 0]
        west, cell, _, north, _, _ = json.loads(subprocess.check_output(["gdalinfo", "-json", str(self.folder / "dsm.tif")]))["geoTransform"]
        rows, columns = np.mgrid[0 : dsm.shape[0], 0 : dsm.shape[1]]
        places = np.stack([west + cell * (columns + 0.5), north - cell * (rows + 0.5)], axis=2)
        heights = SCENE.heights(places, "utm", width_m=cell)
        both = np.isfinite(heights) & np.isfinite(dsm) & (dsm > -1000)
        self.assertGreater(np.count_nonzero(both), 100)
        self.assertLess(np.median(np.abs(heights[both] - dsm[both])), 2e-3)


class Lifetimes(unittest.TestCase):
    def test_arrays_outlive_their_scene(self):
        scene = PROJECT.scene(threads=1)
        gone = weakref.ref(scene)
        picture = scene.render(NEAR, 32)
        points = scene.query([(0.0, 0.0, 0.0)])
        expected = picture.color.tobytes()
        depth = picture.depth
        self.assertFalse(picture.color.flags.owndata)
        self.assertEqual(picture.color.strides[1], picture.depth.strides[1])  # views of one list, not copies
        color = picture.color
        del scene, picture
        gc.collect()
        self.assertIsNone(gone())
        self.assertEqual(color.tobytes(), expected)
        self.assertTrue(np.isfinite(depth).any() and np.isfinite(points.density).all())

    def test_closed_scenes_say_so(self):
        scene = PROJECT.scene(threads=1)
        picture = scene.render(NEAR, 16)
        with scene:
            pass
        with self.assertRaisesRegex(skyquilt.UsageError, "closed"):
            scene.render(NEAR, 16)
        self.assertTrue(np.isfinite(picture.color).all())

    def test_memory_is_given_back(self):
        def used():
            return int(pathlib.Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize()

        def ask():
            with PROJECT.scene(threads=1) as scene:
                scene.render(NEAR, 48, normals="depth")
                scene.query(np.zeros((1000, 3)))
            gc.collect()

        for _ in range(4):
            ask()
        before = used()
        for _ in range(12):
            ask()
        self.assertLess(used() - before, 12e6 if not PRELOADED else 1e9)  # the scene alone takes more each time

    def test_pickles_and_copies_are_refused(self):
        for attempt in (pickle.dumps, copy.copy, copy.deepcopy):
            with self.assertRaisesRegex(TypeError, "cannot be pickled.*open it"):
                attempt(SCENE)
        self.assertEqual(pickle.loads(pickle.dumps(SCENE.render(NEAR, 16))).color.shape, (8, 16, 3))

    def test_a_forked_process_opens_its_own(self):
        child = os.fork()
        if child == 0:
            status = 1
            try:
                SCENE.render(NEAR, 16)
            except skyquilt.UsageError as error:
                status = 0 if "forked" in str(error) else 2
            os._exit(status)
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 0)


class Threads(unittest.TestCase):
    def test_python_runs_while_a_scene_is_rendered(self):
        counted, ended = [0], threading.Event()

        def count():
            while not ended.is_set():
                counted[0] += 1
                time.sleep(0.001)

        counter = threading.Thread(target=count)
        counter.start()
        before = counted[0]
        began = time.perf_counter()
        SCENE.render(NEAR, 640)
        seconds, steps = time.perf_counter() - began, counted[0] - before
        ended.set()
        counter.join()
        self.assertGreater(steps, 5 if seconds > 0.1 else 0)

    def test_several_scenes_answer_at_once(self):
        expected = SCENE.render(NEAR, 96).color.tobytes()
        scenes = [PROJECT.scene(threads=1) for _ in range(2)]
        answers = []
        threads = [threading.Thread(target=lambda of=scene: answers.append(of.render(NEAR, 96).color.tobytes())) for scene in (*scenes, *scenes)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(answers, [expected] * 4)

    def test_ctrl_c_ends_a_rendering(self):
        for _ in range(2):  # and the next one works as before
            timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
            timer.start()
            began = time.perf_counter()
            with self.assertRaises(KeyboardInterrupt):
                SCENE.render(NEAR, 2400)
            self.assertLess(time.perf_counter() - began, 20.0)
            timer.join()
        self.assertEqual(SCENE.render(NEAR, 16).color.shape, (8, 16, 3))


class Refusals(InFolder):
    def test_files(self):
        with self.assertRaisesRegex(skyquilt.InputError, "missing.h5") as caught:
            skyquilt.open(self.folder / "missing.h5")
        self.assertIsInstance(caught.exception, ValueError)
        self.assertEqual(caught.exception.file, self.folder / "missing.h5")
        (self.folder / "broken.h5").write_text("no scene")
        with self.assertRaises(skyquilt.InputError):
            skyquilt.Scene(self.folder / "broken.h5")
        with self.assertRaisesRegex(skyquilt.InputError, "not a skyquilt project"):
            skyquilt.open(self.folder)

    def test_arguments(self):
        for wrong, says in (
            (lambda: SCENE.query([(0, 0, 0)], "mercator"), "'enu', 'utm' or 'wgs84'"),
            (lambda: SCENE.query([(0, 0)]), r"\(\.\.\., 3\)"),
            (lambda: SCENE.query(["a"]), "not numbers"),
            (lambda: SCENE.query([(0, 0, 0)] * 3, directions=[(0, 0, 1)] * 2), "3 points and 2 directions"),
            (lambda: SCENE.query([(0, 0, 0)], directions=(0, 0, 0)), "direction 0 is zero"),
            (lambda: SCENE.heights([(0, 0, 0)]), r"\(\.\.\., 2\)"),
            (lambda: SCENE.cast([(0, 0, 0)], [(0, 0, 0)]), "direction 0 is zero"),
            (lambda: SCENE.cast([(0, np.nan, 0)], [(0, 0, 1)]), "origin of ray 0"),
            (lambda: SCENE.cast([(0, 0, 0)], [(0, 0, 1)] * 2), "1 origins and 2 directions"),
            (lambda: SCENE.render({"position_enu": (0, 0, 9), "pich": 3}), "pitch"),
            (lambda: SCENE.render({"position_enu": (0, 0, 9), "yaw": object()}), "cannot hold"),
            (lambda: SCENE.render(5), "a pose or a path is needed"),
            (lambda: SCENE.render(self.folder / "no.json"), "no such file"),
            (lambda: SCENE.render(NEAR, 0), "must be positive"),
            (lambda: SCENE.render(NEAR, 16, exposure="brighter"), "exposure"),
            (lambda: SCENE.render(NEAR, 16, normals="predicted"), "normal head"),
            (lambda: SCENE.render(np.eye(3)), r"\(3, 4\) or \(4, 4\)"),
            (lambda: SCENE.render(2.0 * np.eye(4)), "rotation"),
            (lambda: SCENE.render(PROJECT.views(width=16)[0], width=32), "its own camera"),
            (lambda: skyquilt.Camera.pinhole(10, 10, 180), "field of view"),
            (lambda: PROJECT.views(["IMG_none.jpg"]), "IMG_none"),
            (lambda: skyquilt.Scene(PROJECT.folder / "scene.h5", threads=-1), "threads"),
        ):
            with self.assertRaisesRegex((skyquilt.UsageError, skyquilt.InputError), says):
                wrong()


if __name__ == "__main__":
    sys.exit(unittest.main())
