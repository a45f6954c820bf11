"""The examples of the guides, as they stand there."""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path as FilePath

import spinaltap

ROOT = FilePath(__file__).resolve().parents[2]
EXAMPLE = ROOT / "apps" / "examples" / "bake_and_drill.py"
ENVIRONMENT = ROOT / "apps" / "examples" / "environment.py"
DATA = FilePath(os.environ["SPINALTAP_PYTHON_TEST_DATA"])


class Example(unittest.TestCase):
    def test_goes_from_a_ct_to_forces_at_every_step(self):
        ct = DATA / "ct"
        said = subprocess.run([sys.executable, str(EXAMPLE), str(ct)], check=True, capture_output=True, text=True)
        lines = [line for line in said.stdout.splitlines() if "thrust" in line]
        # A way of some 45 mm at 1 mm/s and 1 kHz.
        self.assertGreater(len(lines), 30_000)
        self.assertGreater(max(float(line.split("thrust")[1].split()[0]) for line in lines), 10.0)

    def test_is_15_lines_long_and_in_the_guide(self):
        text = EXAMPLE.read_text()
        self.assertLessEqual(len(text.splitlines()), 15)
        self.assertIn("```python\n" + text + "```", (ROOT / "docs" / "python.md").read_text())


def learned(seed):
    """What the environment's example prints."""
    command = [sys.executable, str(ENVIRONMENT), str(DATA / "ground_truth.vdb"), str(DATA / "plan.json"), str(seed)]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


class Environment(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.text = learned(5)
        pattern = r"^(\S.*?)  +mean reward +(\S+)  breaches (\d+) of (\d+)  depths (.+) mm$"
        cls.rows = {
            name: (float(reward), int(breaches), int(count), [float(depth) for depth in depths.split()])
            for name, reward, breaches, count, depths in re.findall(pattern, cls.text, re.MULTILINE)
        }

    def test_greedy_actions_reach_the_target_without_a_breach(self):
        length_mm = spinaltap.read_plan(DATA / "plan.json")[0].length_mm
        reward, breaches, count, depths = self.rows["greedy"]
        self.assertEqual((breaches, count), (0, 4))
        for depth in depths:
            # A cycle goes 3 micrometres.
            self.assertAlmostEqual(depth, length_mm, delta=0.011)
        # Each mm from 2 before the entry, and the target; what a clearance below 1 mm costs is less than a mm's worth.
        self.assertLessEqual(reward, length_mm + 2.0 + 10.0 + 0.005)
        self.assertGreater(reward, length_mm + 2.0 + 10.0 - 1.0)

    def test_greedy_actions_beat_random_ones(self):
        self.assertGreater(self.rows["greedy"][0], self.rows["random"][0] + 10.0)

    def test_many_at_once_are_as_alone(self):
        self.assertEqual(self.rows["greedy, all at once"], self.rows["greedy"])

    def test_the_same_seed_gives_the_same_text(self):
        self.assertEqual(learned(5), self.text)
        self.assertNotEqual(learned(6).splitlines()[1], self.text.splitlines()[1])

    def test_stands_in_the_guide(self):
        self.assertIn("```python\n" + ENVIRONMENT.read_text() + "```", (ROOT / "docs" / "learning.md").read_text())


class WrongPython(unittest.TestCase):
    def test_is_named_with_the_one_that_it_was_built_for(self):
        with tempfile.TemporaryDirectory() as folder:
            package = FilePath(folder) / "spinaltap"
            package.mkdir()
            shutil.copy(ROOT / "apps" / "python" / "spinaltap" / "__init__.py", package)
            other = "_core.cpython-399-x86_64-linux-gnu.so"
            (package / other).touch()
            said = subprocess.run(
                [sys.executable, "-c", "import spinaltap"],
                env={**os.environ, "PYTHONPATH": folder}, cwd=folder, capture_output=True, text=True,
            )
        self.assertNotEqual(said.returncode, 0)
        self.assertIn(f"built for another Python: found {other}", said.stderr)
        self.assertIn(sys.executable, said.stderr.splitlines()[-1])


if __name__ == "__main__":
    unittest.main()
