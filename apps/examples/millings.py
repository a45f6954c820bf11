"""Millings of a lumbar vertebra, placed by its landmarks: python3 millings.py bone.vdb FOLDER

Writes laminectomy.json, facet_removal.json and decortication.json, and a plan beside each with the burr and the line that
forces are logged along: spinaltap drill bone.vdb FOLDER/laminectomy_plan.json --engine voxel --operator
FOLDER/laminectomy.json -o OUT. For research and training: where an operation would mill is a surgeon's to say."""
import json
import pathlib
import sys

import numpy as np
import spinaltap

BURR = {"diameter_mm": 4.0, "length_mm": 70.0, "tip_length_mm": 1.0, "shape": "round-burr", "shank_diameter_mm": 2.0}


def main(bone_file, folder):
    marks = spinaltap.Bone.load(bone_file).landmarks()
    axes, origin = marks["axes"], marks["origin_mm"]  # columns: the vertebra's left, back and top
    canal = marks["canal"]
    half = 0.5 * canal["width_mm"]
    roof = (axes.T @ (canal["centre_mm"] - origin))[1] + 0.5 * canal["depth_mm"]  # of the canal, in the middle
    height = marks["body"]["height_mm"]

    def patch(left, right, top, bottom, back):
        """The corners of a rectangle as it is seen from behind; mm in the vertebra's own frame."""
        corners = [(left, back, top), (right, back, top), (right, back, bottom), (left, back, bottom)]
        return [(origin + axes @ np.array(corner)).tolist() for corner in corners]

    millings = {
        # The roof of the canal between the facets, the spinous process with it, until the canal lies open.
        "laminectomy": dict(outline=patch(half - 4.0, 4.0 - half, 0.4 * height, -1.1 * height, roof),
                            depth="floor", depth_mm=0.25 * canal["depth_mm"], layer_mm=1.0, apart_mm=1.5),
        # The left inferior articular process.
        "facet_removal": dict(outline=patch(half + 6.0, half - 4.0, -0.6 * height, -1.3 * height, roof),
                              depth="floor", depth_mm=2.0, layer_mm=0.8, apart_mm=1.2),
        # A millimetre and a half off the left lamina's back, a bed for a graft.
        "decortication": dict(outline=patch(half + 1.0, 6.5, -0.1 * height, -0.6 * height, roof),
                              depth="below surface", depth_mm=1.5, layer_mm=0.5, apart_mm=1.0),
    }
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    into = -axes[:, 1]
    for name, milling in millings.items():
        head = {"version": 2, "frame": "LPS", "unit": "mm"}
        milling = {"format": "spinaltap-milling", **head, "name": name, "into": into.tolist(), "way": "raster",
                   "feed_mm_s": 20.0, **milling}
        (folder / f"{name}.json").write_text(json.dumps(milling, indent=2) + "\n")
        middle = np.mean(milling["outline"], axis=0)
        path = {"name": name, "entry_mm": (middle - 20.0 * into).tolist(), "target_mm": (middle + 5.0 * into).tolist(),
                "bit": BURR}
        plan = {"format": "spinaltap-plan", **head, "paths": [path]}
        (folder / f"{name}_plan.json").write_text(json.dumps(plan, indent=2) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
