"""SpinalTap: from a CT of a vertebra to a bone that can be drilled at haptic rate.

    bone = spinaltap.Bone.from_ct("ct_folder")
    path = spinaltap.read_plan("plan.json")[0]
    session = spinaltap.Session(bone, path)
    cycle = session.step(tip_mm, axis, dt_s=0.001)
    cycle.force_n

Positions are patient LPS, mm, of shape (n, 3). Long calls leave Python's lock, take progress(stage, fraction), and end
with KeyboardInterrupt on Ctrl-C. Mistakes raise Error, which says what was expected and what was found; its subclasses
say what it is about, and are also what Python people expect: FileNotFoundError, ValueError, OSError.
docs/python.md is the guide.
"""

import sys as _sys
from importlib.machinery import EXTENSION_SUFFIXES as _SUFFIXES
from pathlib import Path as _FilePath

try:
    from . import _core
except ImportError as _error:
    _built = sorted(path.name for path in _FilePath(__file__).parent.glob("_core*.so"))
    if any(name == "_core" + suffix for name in _built for suffix in _SUFFIXES):
        raise  # it is for this Python, and lacks something else
    raise ImportError(
        f"spinaltap was built for another Python: found {', '.join(_built) or 'no _core'}, expected "
        f"_core{_SUFFIXES[0]} for {_sys.executable}. ./run python builds it for /usr/bin/python3: begin with that"
    ) from _error
from ._core import (
    CYCLE,
    EVENT,
    EVENT_KINDS,
    SEEN,
    STATES,
    STUDY,
    Bit,
    Bone,
    Camera,
    Cycle,
    DiskError,
    Error,
    FileError,
    Fixation,
    ForceControlled,
    Frame,
    GeometryError,
    Grade,
    InputError,
    InternalError,
    Operator,
    Path,
    PivotCalibration,
    PlannedMotion,
    Record,
    Registration,
    Replay,
    Screw,
    Session,
    SolvedHeat,
    Study,
    Suggestion,
    UnsupportedError,
    View,
    __version__,
    calibrate_pivot,
    merge,
    read_frames,
    read_plan,
    read_record,
    register_fiducials,
    register_surface,
    replay,
    set_data_folder,
    set_threads,
    solve_heat,
    write_plan,
)
from .frames import to_frame

__all__ = [
    "CYCLE",
    "EVENT",
    "EVENT_KINDS",
    "SEEN",
    "STATES",
    "STUDY",
    "Bit",
    "Bone",
    "Camera",
    "Cycle",
    "DiskError",
    "Error",
    "FileError",
    "Fixation",
    "ForceControlled",
    "Frame",
    "GeometryError",
    "Grade",
    "InputError",
    "InternalError",
    "Operator",
    "Path",
    "PivotCalibration",
    "PlannedMotion",
    "Record",
    "Registration",
    "Replay",
    "Screw",
    "Session",
    "SolvedHeat",
    "Study",
    "Suggestion",
    "UnsupportedError",
    "View",
    "__version__",
    "calibrate_pivot",
    "merge",
    "read_frames",
    "read_plan",
    "read_record",
    "register_fiducials",
    "register_surface",
    "replay",
    "set_data_folder",
    "set_threads",
    "solve_heat",
    "to_frame",
    "write_plan",
]

# The shipped files: of a build tree, build/share beside build/python; of an installed package, share beside lib.
_folder = _FilePath(__file__).absolute().parent
for _up in (1, 3):
    if len(_folder.parents) > _up and (_folder.parents[_up] / "share" / "spinaltap").is_dir():
        _core._add_data_folder(_folder.parents[_up] / "share" / "spinaltap")
