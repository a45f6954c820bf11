"""What readers of CSV make of numbers in their shortest exact text: how many come back other, and by how many units in
the last place. Prints a line for each reader that is there.

    python3 tests/benchmark/csv_readers.py
"""

import random
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

COUNT = 50_000
PYTHON = f"{sys.executable} -c '"
R = "Rscript -e '"
READERS = {
    "gawk": "gawk 'NR>1{printf \"%.17g\\n\",$1+0}' n.csv",
    "mawk": "mawk 'NR>1{printf \"%.17g\\n\",$1+0}' n.csv",
    "sqlite3 .import": "printf '.mode csv\ncreate table t(v real);\n.import --skip 1 n.csv t\n"
    "select printf(\"%%!.26g\",v) from t;\n' | sqlite3 :memory:",
    "numpy.loadtxt": PYTHON + 'import numpy as n;print(*map(repr,map(float,n.loadtxt("n.csv",skiprows=1))))\'',
    "pandas.read_csv": PYTHON + 'import pandas as p;print(*map(repr,map(float,p.read_csv("n.csv").v)))\'',
    "pandas.read_csv, round_trip": PYTHON
    + 'import pandas as p;print(*map(repr,map(float,p.read_csv("n.csv",float_precision="round_trip").v)))\'',
    "R read.csv": R + 'cat(sprintf("%.17g",read.csv("n.csv")$v))\'',
    "R data.table::fread": R + 'cat(sprintf("%.17g",data.table::fread("n.csv")$v))\'',
    "R readr::read_csv": R + 'cat(sprintf("%.17g",readr::read_csv("n.csv",show_col_types=FALSE)$v))\'',
    "Octave csvread": "octave-cli --eval 'printf(\"%.17g\\n\",csvread(\"n.csv\",1,0))'",
    "Octave textscan": "octave-cli --eval 'c=textscan(fopen(\"n.csv\"),\"%f\",\"headerlines\",1);printf(\"%.17g\\n\",c{1})'",
}


def bits(number: float) -> int:
    return int(struct.unpack("<q", struct.pack("<d", number))[0])


def numbers() -> list[float]:
    draw = random.Random(1)
    return [
        draw.gauss(0, 100) if draw.random() < 0.5 else draw.uniform(-1, 1) * 10 ** draw.uniform(-8, 8)
        for _ in range(COUNT)
    ]


def main() -> None:
    given = numbers()
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "n.csv").write_text("v\n" + "\n".join(map(repr, given)) + "\n")
        for name, command in READERS.items():
            done = subprocess.run(command, shell=True, cwd=folder, capture_output=True, text=True, check=False)
            read = done.stdout.split()
            if len(read) != COUNT:
                print(f"{name}: not there")
                continue
            off = [abs(bits(float(text)) - bits(number)) for text, number in zip(read, given)]
            print(f"{name}: {100 * sum(map(bool, off)) / COUNT:.3g} % are other, by up to {max(off)} in the last place")


main()
