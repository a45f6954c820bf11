"""Studies: the same rows whole, in shards and merged."""

import json
import tempfile
import unittest
from pathlib import Path as FilePath

import numpy as np

import made_bone
import spinaltap

SPEC = {
    "format": "spinaltap-study",
    "version": 2,
    "name": "A few",
    "bone": str(made_bone.FOLDER / "ground_truth.vdb"),
    "plan": str(made_bone.FOLDER / "plan.json"),
    "path": "left",
    "volume": {"spacing_mm": 0.3},
    "operator": {"kind": "feed", "feed_mm_s": 10.0, "step_mm": 0.05},
    "design": {
        "runs": 7,
        "sampling": "latin-hypercube",
        "seed": 3,
        "factors": {"entry_left_mm": {"normal": {"mean": 0.0, "deviation": 2.0}}},
    },
}


class Study(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = FilePath(folder.name)
        (self.folder / "spec.json").write_text(json.dumps(SPEC))
        self.study = spinaltap.Study.load(self.folder / "spec.json")

    def test_gives_a_row_a_run(self):
        rows = self.study.run()
        self.assertEqual(len(rows), len(self.study))
        np.testing.assert_array_equal(rows["run"], np.arange(7))
        self.assertTrue(np.all(rows["contact"] == 1))
        self.assertGreater(np.ptp(rows["entry_left_mm"]), 1.0)

    def test_is_the_same_in_shards_and_merged(self):
        rows = self.study.run()
        self.assertEqual(self.study.run(shard=2, shards=3).tobytes(), rows[len(rows) // 3 : len(rows) * 2 // 3].tobytes())
        folders = [self.folder / str(n) for n in (1, 2)]
        for n, folder in enumerate(folders):
            self.study.run_into(folder, shard=n + 1, shards=2)
        # Bytes: what is not a number does not equal itself.
        self.assertEqual(spinaltap.merge(folders).tobytes(), rows.tobytes())
        self.assertEqual(self.study.run_into(folders[0], shard=1, shards=2), 0)

    def test_rejects_a_shard_that_is_none(self):
        with self.assertRaisesRegex(spinaltap.Error, "shard from 1 to 2"):
            self.study.run(shard=3, shards=2)


if __name__ == "__main__":
    unittest.main()
