"""One hand, one record's hash: the C interface from C and from ctypes, C++, Python and the program."""

import ctypes
import os
import subprocess
import tempfile
import unittest
from pathlib import Path as FilePath

import numpy as np

import made_bone
import spinaltap

BONE, PLAN = made_bone.FOLDER / "ground_truth.vdb", made_bone.FOLDER / "plan.json"
BURR = spinaltap.Bit(2.0, 40.0, 1.0, shape="round-burr")


def hand():
    """Tips and axes, (n, 6): into the pedicle, aside as well, with the spindle off for a while; and whether it turns."""
    path = made_bone.path()
    along = np.asarray(path.target_mm) - path.entry_mm
    along /= np.linalg.norm(along)
    time_s = 0.001 * np.arange(2000)
    aside = np.cross(along, [0.0, 0.0, 1.0])
    tips = path.entry_mm + np.outer(6.0 * time_s - 3.0, along) + np.outer(0.3 * np.sin(60.0 * time_s), aside)
    axes = along + np.outer(0.02 * np.sin(7.0 * time_s), aside)
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    return np.hstack([tips, axes]), (time_s < 0.7) | (time_s > 0.75)


class Struct(ctypes.Structure):
    """With its size first."""

    def __init__(self, **values):
        super().__init__(struct_bytes=ctypes.sizeof(type(self)), **values)


class Error(Struct):
    _fields_ = [("struct_bytes", ctypes.c_uint32), ("code", ctypes.c_int32), ("text", ctypes.c_char * 1024)]


class Tool(Struct):
    _fields_ = [("struct_bytes", ctypes.c_uint32), ("shape", ctypes.c_int32)] + [
        (name, ctypes.c_double) for name in ("diameter_mm", "length_mm", "tip_length_mm", "tip_diameter_mm",
                                             "shank_diameter_mm", "thickness_mm", "stroke_mm")]


class Options(Struct):
    _fields_ = [("struct_bytes", ctypes.c_uint32)] + [
        (name, ctypes.c_int32) for name in ("has_clearances", "follows_path", "has_device", "uses_voxels",
                                            "stop_on_breach")] + [
        (name, ctypes.c_double) for name in ("spacing_mm", "radius_mm", "lead_in_mm", "rpm", "stop_thrust_n",
                                             "stop_clearance_mm")] + [
        ("progress", ctypes.c_void_p), ("user", ctypes.c_void_p)]


class Input(Struct):
    _fields_ = [("struct_bytes", ctypes.c_uint32), ("spindle_on", ctypes.c_int32), ("dt_s", ctypes.c_double),
                ("tip_mm", ctypes.c_double * 3), ("axis", ctypes.c_double * 3), ("side", ctypes.c_double * 3)]


def hash_by_ctypes(record):
    library = ctypes.CDLL(os.environ["SPINALTAP_LIBRARY"])
    error = Error()

    def call(name, *arguments):
        function = getattr(library, "spinaltap_" + name)
        if function(*arguments, ctypes.byref(error)) != 0:
            raise RuntimeError(error.text.decode())

    bone, session = ctypes.c_void_p(), ctypes.c_void_p()
    call("bone_load", str(BONE).encode(), ctypes.byref(bone))
    options = Options()
    library.spinaltap_session_options_default(ctypes.byref(options))
    options.has_clearances, options.spacing_mm = 0, 0.3
    call("session_new", ctypes.byref(bone), 1, None, ctypes.byref(options), ctypes.byref(session))
    library.spinaltap_bone_free(bone)
    call("session_record", session, str(record).encode())
    tool = Tool()
    library.spinaltap_tool_default(ctypes.byref(tool))
    tool.shape, tool.diameter_mm, tool.length_mm, tool.tip_length_mm = 1, 2.0, 40.0, 1.0
    poses, spindle_on = hand()
    one = Input(dt_s=0.001)
    for n, pose in enumerate(poses):
        if n == len(poses) // 2:
            call("session_set_tool", session, ctypes.byref(tool))
        one.tip_mm, one.axis, one.spindle_on = tuple(pose[:3]), tuple(pose[3:]), int(spindle_on[n])
        assert library.spinaltap_session_step(session, ctypes.byref(one), None) == 0
    call("session_end_record", session)
    said = ctypes.create_string_buffer(17)
    call("record_hash", str(record).encode(), said)
    library.spinaltap_session_free(session)
    return said.value.decode()


def hash_by_python(record):
    session = spinaltap.Session(made_bone.bone(), clearances=False, spacing_mm=0.3)
    session.record(record)
    poses, spindle_on = hand()
    half = len(poses) // 2
    session.run(poses[:half], spindle_on=spindle_on[:half])
    session.set_tool(BURR)
    session.run(poses[half:], spindle_on=spindle_on[half:])
    session.end_record()
    return spinaltap.read_record(record).hash


class OneHand(unittest.TestCase):
    def test_gives_one_hash_in_c_cpp_python_and_ctypes(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = FilePath(folder)
            poses, spindle_on = hand()
            with open(folder / "hand.txt", "w") as file:
                for pose, is_on in zip(poses, spindle_on):
                    file.write(" ".join(f"{number:.17g}" for number in (0.001, *pose)) + f" {int(is_on)}\n")
            hashes = [hash_by_python(folder / "python.h5"), hash_by_ctypes(folder / "ctypes.h5")]
            for program in ("SPINALTAP_HAND_C", "SPINALTAP_HAND_CPP"):
                command = [os.environ[program], str(BONE), str(PLAN), str(folder / "hand.txt"),
                           str(folder / f"{program}.h5")]
                said = subprocess.run(command, capture_output=True, text=True)
                self.assertEqual(said.returncode, 0, said.stderr)
                hashes.append(said.stdout.strip())
            self.assertEqual(hashes, [hashes[0]] * 4)
            record = spinaltap.read_record(folder / "python.h5")
            self.assertGreater(record.cycles["removed_points"].sum(), 500)
            changes = record.events[record.events["kind"] == spinaltap.EVENT_KINDS.index("tool change")]
            self.assertEqual(changes["cycle"].tolist(), [1000])
            self.assertTrue(spinaltap.replay(folder / "python.h5", made_bone.bone()).is_same)


    def test_gives_one_hash_in_python_and_the_program(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = FilePath(folder)
            poses, spindle_on = hand()
            with open(folder / "hand.csv", "w") as file:
                file.write("time_s,x_mm,y_mm,z_mm,axis_x,axis_y,axis_z,spindle_on\n")
                for n, (pose, is_on) in enumerate(zip(poses, spindle_on)):
                    file.write(",".join(f"{number:.17g}" for number in (0.001 * n, *pose)) + f",{int(is_on)}\n")
            command = [os.environ["SPINALTAP_PROGRAM"], "drill", str(BONE), str(PLAN), "--operator", "hand.csv",
                       "--no-pictures", "--record", "program.h5", "-o", "out"]
            said = subprocess.run(command, cwd=folder, capture_output=True, text=True)
            self.assertEqual(said.returncode, 0, said.stderr)
            drilled = spinaltap.read_record(folder / "program.h5")
            self.assertEqual(len(drilled.cycles), len(poses))
            session = spinaltap.Session(made_bone.bone(), made_bone.path())
            session.record(folder / "python.h5")
            session.run(drilled.cycles["tip_mm"], drilled.cycles["axis"], drilled.cycles["dt_s"],
                        drilled.cycles["spindle_on"] != 0)
            session.end_record()
            self.assertEqual(spinaltap.read_record(folder / "python.h5").hash, drilled.hash)


if __name__ == "__main__":
    unittest.main()
