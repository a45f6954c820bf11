"""What cameras see, as arrays."""

import tempfile
import unittest
from pathlib import Path as FilePath

import made_bone
import numpy as np

import spinaltap


def camera(width: int = 160, height: int = 120) -> spinaltap.Camera:
    """Down the left pedicle's path, a little from the side."""
    path = made_bone.path()
    eye_mm = path.entry_mm - 120.0 * path.direction + np.array([30.0, 0.0, 40.0])
    return spinaltap.Camera.look_at(eye_mm, path.entry_mm, field_of_view_deg=30.0, width=width, height=height)


class Views(unittest.TestCase):
    def test_depths_project_onto_the_baked_surface(self):
        view = made_bone.bone().view(camera())
        self.assertEqual(view.depth_mm.shape, (120, 160))
        is_bone = view.mask == spinaltap.SEEN.index("bone")
        self.assertGreater(is_bone.sum(), 5000)
        v, u = np.nonzero(is_bone)
        matrix, pose, depth_mm = view.camera.matrix, view.camera.to_patient, view.depth_mm[is_bone].astype(float)
        rays = np.linalg.inv(matrix) @ np.stack([u, v, np.ones_like(u)])
        points_mm = (pose[:3, :3] @ (rays * depth_mm)).T + pose[:3, 3]
        self.assertLess(np.abs(made_bone.bone().distance(points_mm)).mean(), 0.05)
        np.testing.assert_allclose(view.points_mm()[is_bone], points_mm, atol=1e-9)
        self.assertTrue(np.isnan(view.points_mm()[view.mask == 0]).all())
        np.testing.assert_allclose(np.linalg.norm(view.normals[is_bone], axis=1), 1.0, atol=1e-5)
        towards = points_mm - view.camera.eye_mm
        self.assertTrue((np.einsum("nk,nk->n", towards, view.normals[is_bone]) < 1e-3).all())

    def test_arrays_show_memory_that_outlives_the_view(self):
        depth_mm = made_bone.bone().view(camera(40, 30)).depth_mm
        self.assertFalse(depth_mm.flags.owndata)
        self.assertFalse(depth_mm.flags.writeable)
        self.assertGreater(depth_mm.max(), 50.0)

    def test_a_record_keeps_frames_of_a_drilling(self):
        session = made_bone.session()
        seen = camera()
        with tempfile.TemporaryDirectory() as folder:
            file = FilePath(folder) / "run.h5"
            session.record(file, frames=(160, 120))
            poses = spinaltap.PlannedMotion(made_bone.path(), feed_mm_s=20.0).poses()
            session.run(poses[:500])
            view = session.record_view(seen)
            session.end_record()
            self.assertEqual(spinaltap.read_record(file).frame_count, 1)
            (frame,) = spinaltap.read_frames(file)
        self.assertEqual(frame.cycle, 499)
        self.assertTrue((view.mask == spinaltap.SEEN.index("bit")).any())
        np.testing.assert_array_equal(frame.view.depth_mm, view.depth_mm)
        np.testing.assert_array_equal(frame.view.normals, view.normals)
        np.testing.assert_array_equal(frame.view.mask, view.mask)
        np.testing.assert_array_equal(frame.view.camera.to_patient, seen.to_patient)

    def test_the_hole_is_deeper_than_the_bone_was(self):
        session = made_bone.session()
        poses = spinaltap.PlannedMotion(made_bone.path(), feed_mm_s=20.0).poses()
        session.run(poses[:500])
        session.end_hole()
        seen = camera()
        before, after = made_bone.bone().view(seen), session.view(seen)
        wall = after.mask == spinaltap.SEEN.index("wall")
        self.assertGreater(wall.sum(), 20)
        self.assertTrue((after.depth_mm[wall] > before.depth_mm[wall]).all())
        np.testing.assert_array_equal(after.depth_mm[after.mask == 1], before.depth_mm[after.mask == 1])

    def test_what_is_no_camera_is_an_error(self):
        for mistake in ({"width": 0}, {"fx": float("nan")}, {"to_patient": np.diag([1.0, 1.0, -1.0, 1.0])}):
            with self.subTest(mistake), self.assertRaisesRegex(spinaltap.Error, "expected"):
                spinaltap.Camera(**mistake)
        with self.assertRaisesRegex(spinaltap.Error, "4, 4"):
            spinaltap.Camera(to_patient=np.eye(3))
        with self.assertRaises(spinaltap.Error):
            made_bone.session().record_view(camera())


if __name__ == "__main__":
    unittest.main()
