"""Tables as pandas has them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._core import EVENT_KINDS, STATES

_GRADES = np.array(list("ABCDE"))


def _split(name: str) -> list[str]:
    """The columns of a vector, as CSV files have them: tip_mm becomes tip_x_mm, tip_y_mm and tip_z_mm."""
    stem, _, unit = name.partition("_")
    return [f"{stem}_{axis}_{unit}" if unit else f"{stem}_{axis}" for axis in "xyz"]


def to_frame(table: NDArray[Any]) -> Any:
    """A pandas DataFrame of cycles, events or a study's rows: vectors in three columns, states, kinds and grades by
    name. Needs pandas, which nothing else here does."""
    import pandas  # type: ignore  # its kind has another name from mypy 1.7 on

    names = table.dtype.names
    if names is None:
        raise TypeError("expected a table of cycles, of events or of a study, found an array without columns")
    columns: dict[str, Any] = {}
    for name in names:
        values = table[name]
        if values.ndim == 2:
            columns.update(zip(_split(name), values.T))
        elif name == "state":
            columns[name] = np.array(STATES)[values]
        elif name == "kind":
            columns[name] = np.array(EVENT_KINDS)[values]
        elif name == "grade":
            columns[name] = _GRADES[values.astype(int)]
        elif name in ("run", "seed"):
            columns[name] = values.astype(np.int64)
        else:
            columns[name] = values
    return pandas.DataFrame(columns)
