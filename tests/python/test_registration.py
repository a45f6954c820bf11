"""Registration: marks, touched points, a tool's tip."""

import tempfile
import unittest
from pathlib import Path as FilePath

import numpy as np

import made_bone
import spinaltap


def turned(angle, axis):
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    cross = np.cross(np.eye(3), -axis)
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


ROTATION, SHIFT = turned(0.2, (1, 2, 3)), np.array([5.0, -4.0, 6.0])


def as_measured(ct_mm):
    return (np.asarray(ct_mm) - SHIFT) @ ROTATION  # the inverse of ROTATION p + SHIFT


class RegistrationByMarks(unittest.TestCase):
    MARKS = np.array([[0, 0, 0], [60, 5, 0], [10, 50, 8], [-30, 20, 40.0]])

    def test_gives_back_the_pose_and_a_file_keeps_it(self):
        found = spinaltap.register_fiducials(self.MARKS, as_measured(self.MARKS), fle_mm=0.5)
        np.testing.assert_allclose(found.rotation, ROTATION, atol=1e-9)
        np.testing.assert_allclose(found.to_ct(as_measured([[7, 8, 9]])), [[7, 8, 9]], atol=1e-9)
        with tempfile.TemporaryDirectory() as folder:
            file = FilePath(folder) / "registration.json"
            found.save(file)
            again = spinaltap.Registration.load(file)
        np.testing.assert_allclose(again.translation_mm, SHIFT, atol=1e-9)
        self.assertAlmostEqual(again.error_mm([9, 9, 99]), found.error_mm([9, 9, 99]))
        self.assertAlmostEqual(np.trace(found.error_covariance_mm2([9, 9, 99])), found.error_mm([9, 9, 99]) ** 2)

    def test_rejects_marks_on_a_line(self):
        line = np.outer(np.arange(4.0), [10, 0, 0])
        with self.assertRaises(spinaltap.Error):
            spinaltap.register_fiducials(line, line)


class RegistrationByTouch(unittest.TestCase):
    def test_lies_where_the_bone_lies_and_says_what_does_not_hold(self):
        vertices, _ = made_bone.bone().surface()
        touched = vertices[np.random.default_rng(1).integers(0, len(vertices), 60)].astype(float)
        found = spinaltap.register_surface(made_bone.bone(), as_measured(touched), noise_mm=0.05)
        self.assertEqual(len(found.residuals_mm), 60)
        self.assertLess(np.abs(made_bone.bone().distance(found.to_ct(as_measured(touched)))).max(), 0.3)
        patch = vertices[np.linalg.norm(vertices - vertices[0], axis=1) < 4].astype(float)
        self.assertTrue(spinaltap.register_surface(made_bone.bone(), patch[:200], noise_mm=0.3).warnings)


class PivotCalibration(unittest.TestCase):
    def test_finds_the_tip(self):
        tip, dimple = np.array([3.0, -2.0, 140.0]), np.array([-80.0, 40.0, -1200.0])
        poses = np.tile(np.eye(4), (40, 1, 1))
        for n, pose in enumerate(poses):
            pose[:3, :3] = turned(0.5 * n, (0, 0, 1)) @ turned(0.5, (1, 0, 0)) @ turned(0.2 * n, (0, 0, 1))
            pose[:3, 3] = dimple - pose[:3, :3] @ tip
        found = spinaltap.calibrate_pivot(poses)
        np.testing.assert_allclose(found.tip_mm, tip, atol=1e-6)
        self.assertEqual(found.warnings, [])
        with self.assertRaises(spinaltap.Error):
            spinaltap.calibrate_pivot(poses[:, :, :3])


if __name__ == "__main__":
    unittest.main()
