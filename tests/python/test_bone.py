"""Bones: from files and CTs, and what they are asked."""

import os
import signal
import tempfile
import threading
import time
import unittest
from pathlib import Path as FilePath

import numpy as np

import made_bone
import spinaltap


class BoneFromFile(unittest.TestCase):
    def test_is_negative_inside_and_positive_outside(self):
        middle = 0.5 * (made_bone.path().entry_mm + made_bone.path().target_mm)
        inside, outside = made_bone.bone().distance([middle, made_bone.path().entry_mm - 5 * made_bone.path().direction])
        self.assertLess(inside, 0)
        self.assertGreater(outside, 0)

    def test_has_unit_normals_on_its_surface(self):
        vertices, triangles = made_bone.bone().surface()
        self.assertEqual(vertices.dtype, np.float32)
        self.assertLess(triangles.max(), len(vertices))
        normals = made_bone.bone().normals(vertices[::1000])
        lengths = np.linalg.norm(normals, axis=1)
        # Zero half-way between the walls of a thin plate.
        self.assertTrue(np.all((np.abs(lengths - 1) < 1e-6) | (lengths == 0)))
        self.assertGreater(np.mean(lengths > 0), 0.99)

    def test_has_its_surface_within_a_voxel_of_distance_0(self):
        vertices, _ = made_bone.bone().surface()
        self.assertLess(np.abs(made_bone.bone().distance(vertices)).max(), made_bone.bone().voxel_mm)

    def test_encloses_its_surface(self):
        low, high = made_bone.bone().bounds_mm
        vertices, _ = made_bone.bone().surface()
        slack = made_bone.bone().voxel_mm
        self.assertTrue(np.all(vertices >= low - slack) and np.all(vertices <= high + slack))

    def test_is_the_same_after_saving(self):
        with tempfile.TemporaryDirectory() as folder:
            file = FilePath(folder) / "bone.vdb"
            made_bone.bone().save(file)
            self.assertEqual(spinaltap.Bone.load(str(file)).hash, made_bone.bone().hash)

    def test_says_what_is_wrong_with_an_array(self):
        with self.assertRaisesRegex(spinaltap.Error, r"shape \(n, 3\), found \(2, 4\)"):
            made_bone.bone().distance(np.zeros((2, 4)))

    def test_says_which_file_is_not_there(self):
        with self.assertRaisesRegex(spinaltap.Error, "nothing_here.vdb"):
            spinaltap.Bone.load("nothing_here.vdb")
        self.assertTrue(issubclass(spinaltap.Error, RuntimeError))

    def test_has_pedicles_of_the_phantoms_size(self):
        marks = made_bone.bone().landmarks()
        # The phantom's own measures; what the landmarks promise on phantoms is 0.5 mm.
        self.assertAlmostEqual(marks["left_pedicle"]["width_mm"], 9.0, delta=0.5)
        self.assertAlmostEqual(marks["left_pedicle"]["height_mm"], 14.5, delta=0.5)

    def test_suggests_paths_of_grade_a(self):
        found = made_bone.bone().suggest()
        self.assertEqual([one.side for one in found], ["left", "right"])
        for one in found:
            self.assertIsNotNone(one.path, one.why_none)
            self.assertEqual(made_bone.bone().grade(one.path).letter, "A")

    def test_tells_how_a_screw_holds(self):
        path = made_bone.bone().suggest()[0].path
        fixation = made_bone.bone().grade(path).fixation
        self.assertLess(fixation.p05_pullout_n, fixation.pullout_n)
        self.assertLess(fixation.pullout_n, fixation.p95_pullout_n)
        self.assertEqual(len(fixation.depth_mm), len(fixation.torque_n_mm))
        self.assertAlmostEqual(max(fixation.torque_n_mm), fixation.max_torque_n_mm)
        self.assertGreater(fixation.stiffness_n_mm, 0.0)
        self.assertTrue(0.0 <= fixation.cortical_share <= 1.0)
        self.assertAlmostEqual(path.screw.core_diameter_mm / path.screw.diameter_mm, 0.65, delta=0.01)
        bare = spinaltap.Path(path.entry_mm, path.target_mm)
        self.assertIsNone(made_bone.bone().grade(bare).fixation)
        with self.assertRaises(spinaltap.Error):
            spinaltap.Screw(6.5, 45.0, core_diameter_mm=7.0)
        self.assertEqual(spinaltap.Screw(6.5, 45.0, pitch_mm=2.0).pitch_mm, 2.0)


class BoneFromCt(unittest.TestCase):
    def test_lies_where_the_phantom_lies(self):
        heard = []
        bone = spinaltap.Bone.from_ct(made_bone.CT, voxel_mm=0.5, accept_warnings=True,
                                      progress=lambda stage, share: heard.append((stage, share)))
        # A CT of 1 mm slices, and boxes of whole voxels of 0.5 mm.
        self.assertLess(np.abs(bone.bounds_mm - made_bone.bone().bounds_mm).max(), 1.5)
        self.assertGreater(len({stage for stage, _ in heard}), 3)
        self.assertTrue(all(0 <= share <= 1 for _, share in heard))

    def test_hands_on_what_progress_raises(self):
        def reject(stage, share):
            raise ValueError("no more")

        with self.assertRaisesRegex(ValueError, "no more"):
            spinaltap.Bone.from_ct(made_bone.CT, progress=reject)

    def test_stops_on_ctrl_c(self):
        # A shell's background job is born without it.
        self.addCleanup(signal.signal, signal.SIGINT, signal.signal(signal.SIGINT, signal.default_int_handler))
        threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        begin = time.monotonic()
        with self.assertRaises(KeyboardInterrupt):
            for _ in range(100):
                spinaltap.Bone.from_ct(made_bone.CT, accept_warnings=True)
        self.assertLess(time.monotonic() - begin, 30)

    def test_lets_other_threads_of_python_go_on(self):
        beats = []
        done = threading.Event()

        def beat():
            while not done.wait(0.01):
                beats.append(time.monotonic())

        thread = threading.Thread(target=beat)
        thread.start()
        spinaltap.Bone.from_ct(made_bone.CT, voxel_mm=0.5, accept_warnings=True)
        done.set()
        thread.join()
        self.assertGreater(len(beats), 10)


if __name__ == "__main__":
    unittest.main()
