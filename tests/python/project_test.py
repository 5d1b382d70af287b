"""Projects and surveys as arrays and dicts, scores of pictures, and whether the stubs say what the module has."""
import ast
import csv
import inspect
import json
import pathlib
import re
import sys
import unittest

import numpy as np
from support import PROGRAM, InFolder, harness, pixels, scene_project

import skyquilt
from skyquilt import _skyquilt


def setUpModule():
    global PROJECT
    PROJECT = skyquilt.open(scene_project())


class Surveys(unittest.TestCase):
    def test_arrays_are_those_of_the_files(self):
        survey = PROJECT.survey
        document = json.loads((PROJECT.folder / "survey" / "survey.json").read_text())
        self.assertEqual(survey.document, document)
        self.assertEqual(survey.names, [photo["name"] for photo in document["photos"]])
        self.assertEqual(survey.rotation_wxyz.shape, (len(survey), 4))
        np.testing.assert_allclose(survey.translation_m, [photo["translation_m"] for photo in document["photos"]])
        np.testing.assert_array_equal(survey.held_out, [photo["is_test"] for photo in document["photos"]])
        self.assertEqual(survey.held_out.dtype, np.bool_)
        self.assertTrue(survey.held_out.any() and not survey.held_out.all())
        np.testing.assert_allclose(survey.gps[:, 1], [photo["gps"]["latitude_deg"] for photo in document["photos"]])
        np.testing.assert_allclose(survey.agl_m, [photo["agl_m"] for photo in document["photos"]])
        np.testing.assert_allclose(survey.f_number, [photo["f_number"] for photo in document["photos"]])
        self.assertEqual([camera.model for camera in survey.cameras], [camera["model"] for camera in document["cameras"]])
        self.assertEqual(survey.origin[1], document["origin"]["latitude_deg"])
        self.assertTrue(survey.photo_root.is_dir())

    def test_poses_are_rigid_and_cameras_stand_where_they_were_tagged(self):
        survey = PROJECT.survey
        rotations = survey.cam_from_enu[:, :3, :3]
        np.testing.assert_allclose(rotations @ rotations.transpose(0, 2, 1), np.tile(np.eye(3), (len(survey), 1, 1)), atol=1e-9)
        homogeneous = np.column_stack([survey.centers, np.ones(len(survey))])
        np.testing.assert_allclose(np.einsum("nij,nj->ni", survey.cam_from_enu, homogeneous)[:, :3], 0.0, atol=1e-9)
        with PROJECT.scene(threads=1) as scene:
            tagged = scene.to_enu(survey.gps, "wgs84")
        self.assertLess(np.median(np.linalg.norm(tagged - survey.centers, axis=1)[survey.gps_agrees]), 10.0)

    def test_points_are_views_of_one_list(self):
        points = PROJECT.survey.points
        header = (PROJECT.folder / "survey" / "points.ply").read_bytes()[:400].decode("ascii", "replace")
        self.assertEqual(len(points), int(re.search(r"element vertex (\d+)", header).group(1)))
        self.assertFalse(points.xyz.flags.owndata)
        self.assertEqual(points.xyz.strides[0], points.rgb.strides[0])
        self.assertEqual((points.xyz.dtype, points.rgb.dtype, points.track_length.dtype), (np.float64, np.uint8, np.int32))
        self.assertTrue(np.isfinite(points.xyz).all() and (points.error_px >= 0).all())

    def test_views_of_photos(self):
        survey = PROJECT.survey
        name = survey.names[int(np.argmax(survey.held_out))]
        full = survey.view(name)
        self.assertEqual(full, PROJECT.views([name])[0])
        half = PROJECT.views([name], width=80)[0]
        self.assertEqual((half.camera.width, half.rotation_wxyz), (80, full.rotation_wxyz))
        np.testing.assert_allclose(half.camera.matrix[0, 0] / full.camera.matrix[0, 0], 80 / full.camera.width)
        # Points lie in the photo where their colours are: axes, pixels and row order are as the documentation says.
        in_camera = (full.cam_from_enu @ np.column_stack([survey.points.xyz, np.ones(len(survey.points))]).T)[:3]
        column, row, _ = full.camera.matrix @ (in_camera / in_camera[2])
        inside = (in_camera[2] > 0) & (column > 1) & (row > 1) & (column < full.camera.width - 1) & (row < full.camera.height - 1)
        self.assertGreater(np.count_nonzero(inside), 50)
        photo = pixels(survey.photo_root / name).astype(np.float64)
        errors = [np.median(np.abs(picture[row[inside].astype(int), column[inside].astype(int)] - survey.points.rgb[inside]))
                  for picture in (photo, photo[::-1], photo[:, ::-1])]
        self.assertLess(2.0 * errors[0], min(errors[1:]), errors)
        with self.assertRaisesRegex(skyquilt.UsageError, "IMG_none"):
            survey.view("IMG_none.jpg")


class Files(InFolder):
    def test_documents(self):
        blocks = PROJECT.blocks
        self.assertEqual((blocks["type"], len(blocks["features"])), ("FeatureCollection", 2))
        self.assertEqual(PROJECT.cameras["type"], "FeatureCollection")
        self.assertEqual([field["name"] for field in PROJECT.training["fields"]], ["context", "r0c0", "r0c1"])
        curve = PROJECT.training_curve("context")
        self.assertTrue((np.diff(curve["step"]) > 0).all() and "psnr" in curve)

    def test_what_is_missing_names_the_way_to_make_it(self):
        for ask, stage in ((lambda: PROJECT.metrics, "evaluate"), (lambda: PROJECT.buildings, "buildings"),
                           (lambda: PROJECT.training_curve("block_r9c9"), "train")):
            with self.assertRaisesRegex(skyquilt.InputError, f"skyquilt.{stage}") as caught:
                ask()
            self.assertTrue(caught.exception.file.is_relative_to(PROJECT.folder))


class Buildings(InFolder):
    def test_features_are_the_rows_of_the_table_and_lie_where_it_says(self):
        harness.houses_project(PROGRAM, self.folder / "houses")
        project = skyquilt.buildings(self.folder / "houses", quiet=True)
        collection = project.buildings
        with (project.folder / "buildings" / "buildings.csv").open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertGreater(len(rows), 2)
        self.assertEqual(collection["type"], "FeatureCollection")
        self.assertTrue(collection["skyquilt:georeferenced"] and collection["skyquilt:metric"])
        self.assertEqual(len(collection["features"]), len(rows))
        for feature, row in zip(collection["features"], rows):
            properties = feature["properties"]
            self.assertEqual(list(properties), list(row))
            for name, text in row.items():
                value = properties[name]
                if value is None or isinstance(value, str):
                    self.assertEqual(value or "", text, name)
                else:
                    np.testing.assert_allclose(value, float(text), rtol=1e-6, atol=5e-3, err_msg=name)
            outer = np.array(feature["geometry"]["coordinates"][0])
            np.testing.assert_array_equal(outer[0], outer[-1])
            metres = (outer - outer[0]) * (111320.0 * np.cos(np.radians(outer[0, 1])), 111320.0)
            x, y = metres[:-1].T
            area = 0.5 * abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))
            self.assertLess(abs(area / properties["area_m2"] - 1.0), 0.05, feature["id"])
            middle = 0.5 * (outer.min(axis=0) + outer.max(axis=0))
            self.assertLess(np.abs((middle - (properties["longitude"], properties["latitude"])) * 111320.0).max(), 15.0)


class Scores(unittest.TestCase):
    def setUp(self):
        random = np.random.default_rng(5)
        self.a = random.uniform(0, 1, (40, 60, 3)).astype(np.float32)
        self.b = np.clip(self.a + random.normal(0, 0.1, self.a.shape), 0, 1).astype(np.float32)
        self.mask = random.uniform(size=(40, 60)) < 0.7

    def test_psnr(self):
        error = (self.a.astype(np.float64) - self.b) ** 2
        self.assertAlmostEqual(skyquilt.psnr(self.a, self.b), -10 * np.log10(error.mean()), places=6)
        self.assertAlmostEqual(skyquilt.psnr(self.a, self.b, self.mask), -10 * np.log10(error[self.mask].mean()), places=6)
        self.assertEqual(skyquilt.psnr(self.a, self.a), np.inf)
        self.assertTrue(np.isnan(skyquilt.psnr(self.a, self.b, np.zeros((40, 60)))))
        bytes_a = np.round(255 * self.a).astype(np.uint8)
        self.assertAlmostEqual(skyquilt.psnr(bytes_a, self.b), skyquilt.psnr(bytes_a.astype(np.float32) / 255, self.b), places=5)
        self.assertAlmostEqual(skyquilt.psnr(self.a[..., 0], self.b[..., 0]), -10 * np.log10(error[..., 0].mean()), places=6)
        # Arrays need not be contiguous.
        self.assertAlmostEqual(skyquilt.psnr(self.a[::2, ::-1], self.b[::2, ::-1]), -10 * np.log10(error[::2].mean()), places=6)

    def test_ssim_and_flip(self):
        for score, of_map, same in ((skyquilt.ssim, skyquilt.ssim_map, 1.0), (skyquilt.flip, skyquilt.flip_map, 0.0)):
            self.assertAlmostEqual(score(self.a, self.a), same, places=6)
            value = score(self.a, self.b, self.mask)
            self.assertTrue(0.02 < abs(value - same) < 1.0, value)
            each = of_map(self.a, self.b, self.mask)
            self.assertEqual((each.shape, each.dtype), ((40, 60), np.float32))
            self.assertAlmostEqual(float(np.nanmean(each, dtype=np.float64)), value, places=4)

    def test_wrong_shapes(self):
        for wrong, says in ((lambda: skyquilt.psnr(self.a, self.b[1:]), "the same"), (lambda: skyquilt.ssim(self.a, self.b, self.mask.T), "a mask"),
                            (lambda: skyquilt.flip(self.a[..., 0], self.b[..., 0]), "colours"), (lambda: skyquilt.psnr(3.0, 4.0), "H, W")):
            with self.assertRaisesRegex(skyquilt.UsageError, says):
                wrong()


class Interface(unittest.TestCase):
    def test_stubs_name_what_the_extension_has_and_nothing_else(self):
        stub = ast.parse((pathlib.Path(skyquilt.__file__).parent / "_skyquilt.pyi").read_text())
        said, had = {}, {}
        for node in stub.body:
            if isinstance(node, ast.FunctionDef):
                said[node.name] = [argument.arg for argument in node.args.args]
            elif isinstance(node, ast.ClassDef):
                for inner in node.body:
                    said[f"{node.name}.{inner.name}"] = [argument.arg for argument in inner.args.args]
            elif isinstance(node, ast.AnnAssign):
                said[node.target.id] = None

        def parameters(function):
            signature = re.match(r"\w+\((.*)\)", function.__doc__.splitlines()[0]).group(1)
            return re.findall(r"(?:^|, )(\w+):", signature)

        for name, value in vars(_skyquilt).items():
            if name.startswith("__"):
                continue
            if inspect.isclass(value):
                for inner, method in vars(value).items():
                    if inner == "__init__" or not inner.startswith("_"):
                        had[f"{name}.{inner}"] = parameters(method)
            else:
                had[name] = parameters(value) if callable(value) else None
        self.assertEqual(said, had)

    def test_everything_public_is_documented_and_annotated(self):
        self.assertTrue((pathlib.Path(skyquilt.__file__).parent / "py.typed").exists())
        for name in skyquilt.__all__:
            value = getattr(skyquilt, name)
            if name == "__version__":
                continue
            self.assertTrue(inspect.getdoc(value) and not inspect.getdoc(value).startswith(f"{name}("), name)
            functions = [value] if inspect.isfunction(value) else [
                member for inner, member in vars(value).items() if inspect.isfunction(member) and not inner.startswith("_")]
            for function in functions:
                if function.__qualname__.startswith(("PointColors", "InputError")):
                    continue
                signature = inspect.signature(function)
                self.assertTrue(inspect.getdoc(function) or inspect.isclass(value), f"{function.__qualname__} has no docstring")
                for parameter in signature.parameters.values():
                    self.assertTrue(parameter.name == "self" or parameter.annotation is not inspect.Parameter.empty,
                                    f"{function.__qualname__}: {parameter.name} has no annotation")
                self.assertIsNot(signature.return_annotation, inspect.Signature.empty, function.__qualname__)


if __name__ == "__main__":
    sys.exit(unittest.main())
