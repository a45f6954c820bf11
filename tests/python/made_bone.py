"""What the tests drill: the phantom, made once, in the folder that SPINALTAP_PYTHON_TEST_DATA names."""

import functools
import os
from pathlib import Path as FilePath

import spinaltap

FOLDER = FilePath(os.environ["SPINALTAP_PYTHON_TEST_DATA"])
CT = FOLDER / "ct"


@functools.cache
def bone() -> spinaltap.Bone:
    """The phantom's own solid, baked."""
    return spinaltap.Bone.load(FOLDER / "ground_truth.vdb")


@functools.cache
def path() -> spinaltap.Path:
    """Through the middle of the left pedicle."""
    return spinaltap.read_plan(FOLDER / "plan.json")[0]


def session(**options: object) -> spinaltap.Session:
    """A new one, of coarse points and, as they take a second, without clearances."""
    return spinaltap.Session(bone(), path(), **{"spacing_mm": 0.2, "clearances": False, **options})
