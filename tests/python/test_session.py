"""Sessions: step, run, drill, records, undo, what is left of the bone."""

import csv
import tempfile
import threading
import unittest
from pathlib import Path as FilePath

import numpy as np

import made_bone
import spinaltap
import spinaltap.env


def poses(feed_mm_s=20.0):
    return spinaltap.PlannedMotion(made_bone.path(), feed_mm_s=feed_mm_s).poses()


class WhichBone(unittest.TestCase):
    def test_is_named_by_paths_and_held_to(self):
        path = made_bone.path()
        self.assertEqual(path.ct_hash, made_bone.bone().ct_hash)
        with tempfile.TemporaryDirectory() as folder:
            file = FilePath(folder) / "plan.json"
            text = (made_bone.FOLDER / "plan.json").read_text().replace(path.ct_hash, "0" * 16)
            file.write_text(text)
            other = spinaltap.read_plan(file)[0]
        self.assertEqual(other.ct_hash, "0" * 16)
        with self.assertRaisesRegex(spinaltap.Error, path.ct_hash):
            spinaltap.Session(made_bone.bone(), other, spacing_mm=0.4, clearances=False)
        with self.assertRaisesRegex(spinaltap.Error, path.ct_hash):
            made_bone.bone().grade(other)
        spinaltap.Session(made_bone.bone(), other, spacing_mm=0.4, clearances=False, other_ct=True)
        self.assertEqual(other.for_bone(made_bone.bone()).ct_hash, path.ct_hash)

    def test_is_told_from_where_paths_lie(self):
        path = made_bone.path()
        self.assertEqual(made_bone.bone().path_warnings(path), [])
        flip = np.array([-1.0, -1.0, 1.0])
        ras = spinaltap.Path(path.entry_mm * flip, path.target_mm * flip)
        self.assertRegex(made_bone.bone().path_warnings(ras)[0], "RAS")
        swapped = spinaltap.Path(path.target_mm, path.entry_mm)
        self.assertRegex(made_bone.bone().path_warnings(swapped)[0], "swapped")


class Bit(unittest.TestCase):
    def test_is_of_any_outline(self):
        head = spinaltap.Bit.read("match-head")
        self.assertEqual(head.shape, "profile")
        self.assertEqual((head.diameter_mm, head.length_mm, head.tip_length_mm), (3.0, 60.0, 1.5))
        self.assertEqual(head.outline[:2], [(0.0, 0.0, False), (1.5, 1.5, True)])
        self.assertEqual(spinaltap.Bit.profile(head.outline).outline, head.outline)
        self.assertEqual(spinaltap.Bit.profile([(0, 1), (40, 1)]).outline, [(0.0, 1.0, False), (40.0, 1.0, False)])
        self.assertEqual(spinaltap.Bit().outline, [])
        planned = made_bone.path()
        with tempfile.TemporaryDirectory() as folder:
            file = FilePath(folder) / "plan.json"
            spinaltap.write_plan([spinaltap.Path(planned.entry_mm, planned.target_mm, head)], file)
            self.assertEqual(spinaltap.read_plan(file)[0].bit.outline, head.outline)

    def test_says_what_is_wrong_with_an_outline(self):
        with self.assertRaisesRegex(spinaltap.Error, "place 2"):
            spinaltap.Bit.profile([(0, 1), (-3, 1)])
        with self.assertRaisesRegex(spinaltap.Error, r"\(back_mm, radius_mm\)"):
            spinaltap.Bit.profile([(0, 1), (3,)])
        with self.assertRaisesRegex(spinaltap.Error, "wide"):
            spinaltap.Bit.profile([(0, "wide"), (3, 1)])
        with self.assertRaisesRegex(spinaltap.Error, "match-head"):
            spinaltap.Bit.read("spoon")


class Plate(unittest.TestCase):
    def planned(self, **options):
        """A blade on the way of the path, its width along the body's height."""
        saw = spinaltap.Bit.plate(9.0, 1.0, 40.0, **options)
        return spinaltap.Path(made_bone.path().entry_mm, made_bone.path().target_mm, saw)

    def test_is_a_bit_with_sizes_of_its_own(self):
        saw = spinaltap.Bit.plate(12, 0.8, 40, stroke_mm=4.0, width_along=[0.0, 3.0, 4.0])
        self.assertEqual((saw.shape, saw.diameter_mm, saw.thickness_mm), ("plate", 12.0, 0.8))
        self.assertEqual((saw.length_mm, saw.stroke_mm), (40.0, 4.0))
        np.testing.assert_allclose(saw.width_along, [0.0, 0.6, 0.8], rtol=1e-15)
        self.assertEqual(spinaltap.Bit().thickness_mm, 0.0)
        with tempfile.TemporaryDirectory() as folder:
            file = FilePath(folder) / "plan.json"
            spinaltap.write_plan([self.planned(stroke_mm=2.0)], file)
            read = spinaltap.read_plan(file)[0].bit
            self.assertEqual((read.diameter_mm, read.thickness_mm, read.stroke_mm), (9.0, 1.0, 2.0))
        for bad, words in [
            (lambda: spinaltap.Bit.plate(1, 2, 40), "thickness"),
            (lambda: spinaltap.Bit.plate(4, 1, 40, stroke_mm=5), "stroke"),
            (lambda: spinaltap.Bit.plate(4, 1, 40, width_along=[0, 0, 0]), "not zero"),
            (lambda: spinaltap.Bit(shape="plate"), "thickness"),
        ]:
            with self.assertRaisesRegex(spinaltap.Error, words):
                bad()

    def test_is_told_which_way_it_is_turned(self):
        path = self.planned()
        axis = path.direction
        up = np.array([0.0, 0.0, 1.0]) - axis[2] * axis
        up /= np.linalg.norm(up)
        along = spinaltap.PlannedMotion(path, feed_mm_s=50.0).poses()

        def session():
            return spinaltap.Session(made_bone.bone(), path, spacing_mm=0.2, clearances=False)

        self.assertEqual(session().engine, "voxel")
        whole = session().run(along)
        self.assertGreater(whole["removed_points"].sum(), 1000)
        np.testing.assert_array_equal(whole["side"], np.zeros((len(along), 3)))
        # Said as it is held anyway, in one array for all and one each: the same voxels.
        for sides in (up, np.tile(up, (len(along), 1))):
            said = session().run(along, sides=sides)
            np.testing.assert_array_equal(said["side"], np.tile(up, (len(along), 1)))
            np.testing.assert_array_equal(said["removed_points"], whole["removed_points"])
        # Half a turn is no other box; a quarter is.
        np.testing.assert_array_equal(session().run(along, sides=-up)["removed_points"], whole["removed_points"])
        turned = session().run(along, sides=np.cross(axis, up))
        self.assertNotEqual(turned["removed_points"].sum(), whole["removed_points"].sum())
        stepped = session()
        for pose, row in zip(along, turned):
            cycle = stepped.step(pose[:3], pose[3:], side=np.cross(axis, up))
            self.assertEqual(cycle.removed_points, row["removed_points"])
            np.testing.assert_array_equal(cycle.side, row["side"])
        # Along the axis it is none.
        bad = session()
        bad.step(along[0, :3], axis, side=axis)
        self.assertEqual([spinaltap.EVENT_KINDS[kind] for kind in bad.events["kind"]], ["invalid pose"])
        with self.assertRaisesRegex(spinaltap.Error, "one side, or one for each"):
            session().run(along, sides=np.zeros((3, 3)))
        with self.assertRaisesRegex(spinaltap.Error, "side as 3 numbers"):
            session().step(along[0, :3], axis, side=[1.0, 0.0])

    def test_is_recorded_with_its_sides_and_replayed(self):
        path = self.planned()
        axis = path.direction
        across = np.cross(axis, [0.0, 0.0, 1.0])
        across /= np.linalg.norm(across)
        along = spinaltap.PlannedMotion(path, feed_mm_s=50.0).poses()
        angles = np.linspace(0.0, 0.5, len(along))[:, None]
        sides = np.cos(angles) * across + np.sin(angles) * np.cross(axis, across)
        session = spinaltap.Session(made_bone.bone(), path, spacing_mm=0.2, clearances=False)
        with tempfile.TemporaryDirectory() as folder:
            file = FilePath(folder) / "cut.h5"
            session.record(file)
            rows = session.run(along, sides=sides)
            session.end_record()
            record = spinaltap.read_record(file)
            np.testing.assert_array_equal(record.cycles, rows)
            np.testing.assert_array_equal(record.cycles["side"], sides)
            again = spinaltap.replay(file, made_bone.bone())
            self.assertTrue(again.is_same, again.difference)
            record.write_csv(FilePath(folder) / "cut.csv")
            with open(FilePath(folder) / "cut.csv", newline="") as text:
                head, *body = csv.reader(text)
            self.assertEqual(head[-3:], ["side_x", "side_y", "side_z"])
            np.testing.assert_array_equal(np.array(body[7][-3:], dtype=float), sides[7])

    def test_is_rejected_by_what_is_made_for_tools_that_turn(self):
        path = self.planned()
        with self.assertRaisesRegex(spinaltap.Error, "a plate"):
            spinaltap.Session(made_bone.bone(), path, engine="ring", clearances=False)
        with self.assertRaisesRegex(spinaltap.Error, "a grade, found a plate"):
            made_bone.bone().grade(path)
        with self.assertRaisesRegex(spinaltap.Error, "drilling, found a plate"):
            spinaltap.env.DrillEnv(made_bone.bone(), path)


class CurvedPath(unittest.TestCase):
    def test_is_drilled_and_graded_along_its_curve(self):
        planned = made_bone.path()
        # As far from both ends: halfway along the curve too.
        across = np.cross(planned.direction, [0, 0, 1])
        via = (planned.entry_mm + planned.target_mm) / 2 + 1.5 * across / np.linalg.norm(across)
        path = spinaltap.Path(planned.entry_mm, planned.target_mm, via_mm=[via])
        self.assertEqual(path.bit.shape, "round-burr")
        self.assertEqual([place.tolist() for place in path.via_mm], [via.tolist()])
        chord_mm = float(np.linalg.norm(planned.target_mm - planned.entry_mm))
        by_two_lines_mm = 2 * float(np.hypot(chord_mm / 2, 1.5))
        self.assertTrue(chord_mm < path.length_mm < 1.1 * by_two_lines_mm)
        with tempfile.TemporaryDirectory() as folder:
            file = FilePath(folder) / "plan.json"
            spinaltap.write_plan([path], file)
            self.assertEqual(spinaltap.read_plan(file)[0].via_mm[0].tolist(), via.tolist())
        with self.assertRaisesRegex(spinaltap.Error, "short enough for its bends"):
            spinaltap.Path(planned.entry_mm, planned.target_mm, spinaltap.Bit(), via_mm=[via])
        session = spinaltap.Session(made_bone.bone(), path, spacing_mm=0.2, clearances=False)
        axis = path.direction
        self.assertAlmostEqual(session.step(path.entry_mm, axis).depth_mm, 0.0, places=6)
        self.assertAlmostEqual(session.step(via, axis).depth_mm, path.length_mm / 2, places=6)
        self.assertAlmostEqual(session.step(path.target_mm, axis).depth_mm, path.length_mm, places=6)


class Session(unittest.TestCase):
    def test_gives_the_same_bits_by_steps_and_by_arrays(self):
        rows = made_bone.session(clearances=True).run(poses())
        session = made_bone.session(clearances=True)
        for pose, row in zip(poses(), rows):
            cycle = session.step(pose[:3], pose[3:])
            self.assertEqual(cycle.thrust_n, row["thrust_n"])
            self.assertEqual(cycle.removed_points, row["removed_points"])
            self.assertEqual(cycle.clearance_outer_mm, row["clearance_outer_mm"])
            np.testing.assert_array_equal(cycle.force_n, row["force_n"])
        self.assertGreater(rows["thrust_n"].max(), 1.0)
        self.assertEqual(cycle.index, len(rows) - 1)

    def test_takes_poses_as_one_array_or_two(self):
        whole = made_bone.session().run(poses())
        tips, axis = poses()[:, :3], made_bone.path().direction
        np.testing.assert_array_equal(made_bone.session().run(tips, poses()[:, 3:]), whole)
        np.testing.assert_allclose(made_bone.session().run(tips, axis)["thrust_n"], whole["thrust_n"], atol=1e-6)
        np.testing.assert_array_equal(made_bone.session().run(poses(), dt_s=np.full(len(tips), 0.001)), whole)

    def test_rejects_arrays_that_do_not_fit(self):
        session = made_bone.session()
        with self.assertRaisesRegex(spinaltap.Error, r"found \(4, 5\)"):
            session.run(np.zeros((4, 5)))
        with self.assertRaisesRegex(spinaltap.Error, "one for each of 4 tips"):
            session.run(np.zeros((4, 3)), np.zeros((3, 3)))
        with self.assertRaisesRegex(spinaltap.Error, "dt_s"):
            session.run(np.zeros((4, 6)), dt_s=[0.1, 0.2])
        with self.assertRaisesRegex(spinaltap.Error, "tip_mm as 3 numbers"):
            session.step([1.0, 2.0], [0.0, 0.0, 1.0])

    def test_shows_memory_that_outlives_the_session(self):
        rows = made_bone.session().run(poses())
        self.assertFalse(rows.flags.owndata)
        self.assertEqual(rows.dtype, spinaltap.CYCLE)
        self.assertEqual(rows["cycle"][-1], len(poses()) - 1)

    def test_removes_what_a_cylinder_holds(self):
        session = made_bone.session(spacing_mm=0.1)
        drilled = [session.step(pose[:3], pose[3:]) for pose in poses()]
        # Where the whole bit is in bone. Points stand for what is around them, half a spacing on each side.
        inside = [cycle for cycle in drilled if 12.0 < cycle.depth_mm <= 32.0]
        volume_mm3 = sum(cycle.removed_mm3 for cycle in inside)
        area_mm2 = np.pi * (0.5 * made_bone.path().bit.diameter_mm) ** 2
        rim = 0.05 / 1.5
        self.assertGreater(volume_mm3 / (20.0 * area_mm2), (1 - rim) ** 2)
        self.assertLess(volume_mm3 / (20.0 * area_mm2), (1 + rim) ** 2 + 1e-3)

    def test_notes_events_by_name(self):
        session = made_bone.session()
        session.run(poses())
        kinds = [spinaltap.EVENT_KINDS[kind] for kind in session.events["kind"]]
        self.assertIn("contact", kinds)
        self.assertIn("state", kinds)
        session.step([np.nan, 0, 0], [0, 0, 1])
        self.assertIn("invalid pose", [spinaltap.EVENT_KINDS[kind] for kind in session.events["kind"]])

    def test_tells_of_no_path_where_the_tool_leaves_it(self):
        session = made_bone.session(follows_path=False)
        self.assertEqual(session.engine, "voxel")
        milled, drilled = session.run(poses()), made_bone.session(engine="voxel").run(poses())
        self.assertEqual([spinaltap.EVENT_KINDS[kind] for kind in session.events["kind"]], ["contact"])
        self.assertEqual(milled["state"].max(), 0)
        self.assertGreater(drilled["state"].max(), 0)
        np.testing.assert_array_equal(milled["force_n"], drilled["force_n"])

    def test_drills_by_operators(self):
        planned = made_bone.session().drill(spinaltap.PlannedMotion(made_bone.path(), feed_mm_s=20.0))
        np.testing.assert_array_equal(planned, made_bone.session().run(poses()))
        pushed = made_bone.session().drill(spinaltap.ForceControlled(made_bone.path(), push_n=80.0))
        # Through the cortex, where 80 N hold the bit back, into bone that does not: feed is not even.
        self.assertGreater(pushed["depth_mm"].max(), 5.0)
        feeds = np.diff(pushed["depth_mm"]) / 0.001
        self.assertGreater(feeds.max(), 2 * np.median(feeds[feeds > 0]))

    def test_stops_where_it_is_told(self):
        session = made_bone.session(stop_thrust_n=5.0)
        rows = session.drill(spinaltap.PlannedMotion(made_bone.path()))
        self.assertTrue(session.is_stopped)
        self.assertGreaterEqual(rows["thrust_n"][-1], 5.0)
        self.assertLess(rows["thrust_n"][:-1].max(), 5.0)

    def test_undoes_what_was_drilled(self):
        session = made_bone.session()
        rows = session.run(poses())
        self.assertTrue(session.undo())
        np.testing.assert_array_equal(session.run(poses()), rows)

    def test_undoes_what_was_milled_of_voxels(self):
        ends = np.array([made_bone.path().entry_mm, made_bone.path().target_mm])
        region = [ends.min(axis=0) - 5.0, ends.max(axis=0) + 5.0]
        for chosen in ({"engine": "voxel"}, {"region_mm": region}):
            session = made_bone.session(**chosen)
            whole = session.surface_changes()
            rows = session.run(poses())
            self.assertGreater(rows["removed_points"].sum(), 0)
            session.end_hole()
            again = session.run(poses())
            self.assertEqual(again["removed_points"].sum(), 0)
            self.assertTrue(session.undo())
            self.assertTrue(session.undo())
            self.assertFalse(session.undo())
            np.testing.assert_array_equal(session.run(poses()), rows)
            self.assertTrue(session.undo())
            self.assertEqual(session.drilled().hash, made_bone.bone().hash)
            shown = {block: surface for block, surface in session.surface_changes()}
            for block, surface in whole:
                if block in shown:
                    np.testing.assert_array_equal(shown[block]["triangles"], surface["triangles"])

    def test_drills_through_several_bones(self):
        # What a first session left of the bone stands for another bone beside it: it takes nothing from the whole one.
        first = made_bone.session()
        first.run(poses())
        rest = first.drilled()
        session = made_bone.session(also=[rest])
        self.assertEqual(session.engine, "voxel")
        with tempfile.TemporaryDirectory() as folder:
            file = FilePath(folder) / "run.h5"
            session.record(file)
            rows = session.run(poses())
            session.end_record()
            np.testing.assert_array_equal(made_bone.session(engine="voxel").run(poses())["thrust_n"], rows["thrust_n"])
            again = spinaltap.replay(file, made_bone.bone(), also=[rest])
            self.assertTrue(again.is_same, again.difference)
            with self.assertRaisesRegex(spinaltap.Error, "expected the 2 bones"):
                spinaltap.replay(file, made_bone.bone())
        self.assertEqual(len(session.drilled_bones()), 2)
        self.assertEqual(session.drilled_bones()[0].hash, session.drilled().hash)
        self.assertGreater(len(session.surface_changes(1)), 0)
        with self.assertRaisesRegex(spinaltap.Error, "below 2"):
            session.surface_changes(2)
        with self.assertRaisesRegex(spinaltap.Error, "several bones"):
            made_bone.session(also=[rest], engine="ring")

    def test_leaves_a_hole_in_the_bone(self):
        session = made_bone.session()
        session.run(poses())
        middle = 0.5 * (made_bone.path().entry_mm + made_bone.path().target_mm)
        self.assertLess(made_bone.bone().distance(middle)[0], 0)
        # In the middle of a hole of 1.5 mm radius, or further than the band.
        self.assertGreater(session.drilled().distance(middle)[0], 0.5)

    def test_tells_which_blocks_of_the_surface_changed(self):
        session = made_bone.session()
        first = session.surface_changes()
        self.assertEqual(session.surface_changes(), [])
        session.run(poses())
        changed = session.surface_changes()
        self.assertTrue(0 < len(changed) < len(first))
        block, surface = first[0]
        self.assertEqual(len(block), 3)
        self.assertLess(surface["triangles"].max(), len(surface["vertices_mm"]))
        self.assertFalse(surface["vertices_mm"].flags.writeable)

    def test_rejects_two_threads_at_once(self):
        session = made_bone.session()
        many = np.repeat(poses(), 100, axis=0)
        thread = threading.Thread(target=lambda: session.run(many))
        thread.start()
        rejected = False
        while thread.is_alive() and not rejected:
            try:
                session.step(many[0, :3], many[0, 3:])
            except spinaltap.Error as error:
                rejected = "one thread at a time" in str(error)
        thread.join()
        self.assertTrue(rejected)

    def test_drills_voxels_of_the_whole_bone(self):
        by_points, by_voxels = made_bone.session().run(poses()), made_bone.session(engine="voxel").run(poses())
        self.assertGreater(by_voxels["removed_points"].sum(), 100)
        self.assertAlmostEqual(by_voxels["thrust_n"].max() / by_points["thrust_n"].max(), 1.0, delta=0.15)
        again = made_bone.session(engine="voxel").run(poses())
        np.testing.assert_array_equal(again, by_voxels)

    def test_drills_voxels_of_a_region(self):
        whole, corners = made_bone.session(engine="voxel"), made_bone.bone().bounds_mm
        self.assertEqual(whole.engine, "voxel")
        self.assertEqual(made_bone.session().engine, "ring")
        part = made_bone.session(region_mm=corners)
        self.assertEqual(part.engine, "voxel")
        np.testing.assert_array_equal(part.run(poses()), whole.run(poses()))
        for bad, words in [(corners[::-1], "second corner"), (corners[:1], "two corners"), (corners + 900, "with bone")]:
            with self.assertRaisesRegex(spinaltap.Error, words):
                made_bone.session(region_mm=bad)
        with self.assertRaisesRegex(spinaltap.Error, "found ring"):
            made_bone.session(region_mm=corners, engine="ring")


class Record(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = FilePath(folder.name)
        self.file = self.folder / "run.h5"
        session = made_bone.session()
        session.record(self.file)
        self.rows = session.run(poses())
        session.end_record()
        self.record = spinaltap.read_record(self.file)

    def test_holds_what_run_gave(self):
        np.testing.assert_array_equal(self.record.cycles, self.rows)
        self.assertTrue(self.record.is_whole)
        self.assertEqual(self.record.lost, 0)

    def test_is_replayed_bit_for_bit(self):
        replay = spinaltap.replay(self.file, made_bone.bone(), engine="reference")
        self.assertTrue(replay.is_same, replay.difference)
        self.assertEqual(replay.cycles, len(self.rows))

    def test_has_the_columns_of_its_csv(self):
        self.record.write_csv(self.folder / "run.csv")
        with open(self.folder / "run.csv", newline="") as file:
            head = next(csv.reader(file))
        names = []
        for name in spinaltap.CYCLE.names:
            stem, _, unit = name.partition("_")
            is_vector = bool(spinaltap.CYCLE[name].shape)
            if name in ("side", "temperature_c", "max_temperature_c"):  # of plates, and where there is heat
                continue
            names += [f"{stem}_{axis}" + ("_" + unit if unit else "") for axis in "xyz"] if is_vector else [name]
        self.assertEqual(names, head)

    def test_has_temperatures_where_its_session_has_heat(self):
        file = self.folder / "warm.h5"
        session = made_bone.session(heat=True)
        session.record(file)
        rows = session.run(poses())
        session.end_record()
        self.assertGreater(rows["max_temperature_c"][-1], 37.0)
        self.assertEqual(session.last.max_temperature_c, rows["max_temperature_c"][-1])
        self.assertGreaterEqual(session.last.max_temperature_c, session.last.temperature_c)
        self.assertGreater(session.last.max_temperature_depth_mm, 0.0)
        np.testing.assert_array_equal(rows["thrust_n"], self.rows["thrust_n"])
        self.assertTrue(np.isnan(made_bone.session().last.temperature_c))
        self.assertTrue(spinaltap.replay(file, made_bone.bone()).is_same)
        wet = made_bone.session(heat=True, irrigation=True).run(poses())
        self.assertLess(wet["max_temperature_c"][-1], rows["max_temperature_c"][-1])
        with self.assertRaisesRegex(spinaltap.Error, "heat=True"):
            made_bone.session(irrigation=True)

    def test_is_solved_for_heat(self):
        heat = spinaltap.solve_heat(self.file, made_bone.bone())
        self.assertGreater(heat.hottest_c, 37.0)
        self.assertEqual(heat.distances[0], (0.0, heat.hottest_c))
        self.assertLess(heat.distances[-1][1], heat.hottest_c)
        self.assertEqual(heat.above_47c_60s_mm3, 0.0)
        self.assertEqual(heat.hottest_mm.shape, (3,))
        self.assertLess(spinaltap.solve_heat(self.file, made_bone.bone(), irrigation=True).hottest_c, heat.hottest_c)
        heat.save(self.folder / "heat.vdb")
        self.assertTrue((self.folder / "heat.vdb").exists())

    def test_becomes_a_frame(self):
        try:
            import pandas  # noqa: F401
        except ImportError:
            self.skipTest("pandas is not here")
        frame = spinaltap.to_frame(self.record.cycles)
        self.assertEqual(len(frame), len(self.rows))
        self.assertEqual(frame["state"].iloc[0], "initial")
        self.assertIn("tip_x_mm", frame.columns)

    def test_is_not_replaced(self):
        with self.assertRaisesRegex(spinaltap.Error, "run.h5"):
            made_bone.session().record(self.file)



class ToolsAndPaths(unittest.TestCase):
    def test_changes_its_tool_and_goes_without_a_path(self):
        burr = spinaltap.Bit(4.0, 40.0, 2.0, shape="round-burr", shank_diameter_mm=2.0)
        session = spinaltap.Session(made_bone.bone(), bit=burr, clearances=False, spacing_mm=0.4)
        self.assertEqual(session.chosen, "voxels of 0.4 mm of the whole bone, for no path")
        self.assertEqual(session.engine, "voxel")
        self.assertEqual(session.tool.diameter_mm, 4.0)
        path = made_bone.path()
        along = (path.target_mm - path.entry_mm) / np.linalg.norm(path.target_mm - path.entry_mm)
        tips = path.entry_mm + np.outer(np.linspace(-3.0, 3.0, 300), along)
        first = session.run(tips, along)
        self.assertGreater(first["removed_points"].sum(), 100)
        session.set_tool(spinaltap.Bit(6.0, 40.0, 3.0, shape="round-burr", shank_diameter_mm=2.0))
        second = session.run(tips, along)
        self.assertGreater(second["removed_points"].sum(), 100)
        self.assertEqual(second["cycle"][-1], 599)
        kinds = [spinaltap.EVENT_KINDS[event["kind"]] for event in session.events]
        self.assertEqual(kinds.count("tool change"), 1)
        self.assertEqual(session.motion_off_mm, 0.0)
        self.assertTrue(session.undo())
        self.assertFalse(session.undo())
        with self.assertRaisesRegex(spinaltap.Error, "tool of the path"):
            spinaltap.Session(made_bone.bone(), path, bit=burr, clearances=False)


class Errors(unittest.TestCase):
    def test_are_what_python_people_expect(self):
        with self.assertRaises(FileNotFoundError) as missing:
            spinaltap.Bone.load("no/such/bone.vdb")
        self.assertIsInstance(missing.exception, spinaltap.FileError)
        self.assertIsInstance(missing.exception, spinaltap.Error)
        self.assertEqual(missing.exception.kind, "file")
        self.assertIn("no such file", str(missing.exception))
        with self.assertRaises(ValueError) as wrong:
            spinaltap.Bit(-1.0)
        self.assertEqual(wrong.exception.kind, "input")
        aside = spinaltap.Path([900.0, 0.0, 0.0], [900.0, 0.0, 40.0])
        with self.assertRaises(spinaltap.GeometryError) as beside:
            spinaltap.Session(made_bone.bone(), aside, clearances=False)
        self.assertIsInstance(beside.exception, ValueError)
        self.assertIsInstance(beside.exception, RuntimeError)
        with self.assertRaises(OSError):
            made_bone.bone().save("/proc/no/bone.vdb")


if __name__ == "__main__":
    unittest.main()
