"""The example of the guide, as it stands there."""

import os
import subprocess
import sys
import unittest
from pathlib import Path as FilePath

ROOT = FilePath(__file__).resolve().parents[2]
EXAMPLE = ROOT / "apps" / "examples" / "bake_and_drill.py"


class Example(unittest.TestCase):
    def test_goes_from_a_ct_to_forces_at_every_step(self):
        ct = FilePath(os.environ["SPINALTAP_PYTHON_TEST_DATA"]) / "ct"
        said = subprocess.run([sys.executable, str(EXAMPLE), str(ct)], check=True, capture_output=True, text=True)
        lines = [line for line in said.stdout.splitlines() if "thrust" in line]
        # A way of some 45 mm at 1 mm/s and 1 kHz.
        self.assertGreater(len(lines), 30_000)
        self.assertGreater(max(float(line.split("thrust")[1].split()[0]) for line in lines), 10.0)

    def test_is_15_lines_long_and_in_the_guide(self):
        text = EXAMPLE.read_text()
        self.assertLessEqual(len(text.splitlines()), 15)
        self.assertIn("```python\n" + text + "```", (ROOT / "docs" / "python.md").read_text())


if __name__ == "__main__":
    unittest.main()
