#!/usr/bin/env bash
# A finite median becomes NaN in Octave's quantile and prctile (silently) and in pandas' describe where larger values are infinite.
# Version: pandas 1.5.3 with numpy 1.24.2, Octave 7.3.0; beside them R 4.2.2, which gives all of them (Debian 12, amd64).
# Seen, for the column 1 2 3 4 inf inf inf, whose median is 4 (the fourth of seven) and whose quartiles are 2.5 (Octave: 2.25) and inf:
#   pandas    median() 4; quantile(0.5) and the "50%" of describe() NaN; quantile(0.75) and "75%" NaN
#   numpy     median 4; quantile 0.5 and 0.75 NaN; it warns, and so does pandas, of a subtraction in numpy's own files
#   Octave    median 4; quantile 0.5 and prctile 50 NaN, quantile 0.75 Inf; for 1 2 3 inf inf also quantile 0.9, which is inf; no warning
#   R         median 4, quantile 0.25, 0.5, 0.75: 2.5, 4, Inf
# All of them document a linear way between two order statistics; here it takes 0 times (inf - 4) or 0 times inf, although the place
# asked for falls on the finite value itself, and inf - inf between two infinite ones.
# Why it hurts: inf is the value of a distance to what is not there (a wall a bone has not got) and of a time to what never came. NaN is
# then read as "no data", dropped from a table or counted as missing, while more than half of the runs have a finite value.
# Seen on 2026-11-28. Needs Debian 12 (amd64) with root and apt. Exit 0: as described; else changed or (2, 3) not these versions.
set -euo pipefail
packages=(python3-pandas=1.5.3+dfsg-2 python3-numpy=1:1.24.2-1+deb12u1 octave=7.3.0-2 r-base-core=4.2.2.20221110-2)
# The same in every script: exactly these Debian packages in a root in a temp folder, from this machine's own apt sources (Python files
# not byte-compiled, to save time); inside COMMAND runs in that root's /work. Mounts lie in namespaces that end with the command.
dir=$(mktemp -d); root=$dir/root; trap 'rm -rf --one-file-system "$dir"' EXIT
make_root() {
  local sources=/etc/apt/sources.list.d/debian.sources; [ -e $sources ] || sources=/etc/apt/sources.list
  command -v mmdebstrap || { apt-get update && apt-get install -y mmdebstrap; } || return
  TMPDIR=$dir unshare --mount mmdebstrap --variant=essential --include="${packages[*]}" --aptopt='APT::Sandbox::User "root"' \
    --essential-hook='ln -s /bin/true "$1/usr/sbin/py3compile"' --dpkgopt=force-unsafe-io \
    --dpkgopt=path-exclude=/usr/{include,share/{doc,locale,man}}/'*' bookworm "$root" $sources && mkdir "$root/work"
}
inside() { unshare --mount-proc="$root/proc" chroot "$root" env -i -C /work PATH=/usr/bin:/bin HOME=/work LC_ALL=C.UTF-8 "$@"; }
make_root > "$dir/log" 2>&1 || { tail -n 20 "$dir/log"; echo "cannot install ${packages[*]}"; exit 2; }
for p in "${packages[@]}"; do
  v=$(inside dpkg-query -W -f='${Version}' "${p%%=*}"); [ "$v" = "${p#*=}" ] || { echo "expected $p, found $v"; exit 3; }
done
cd "$root/work"
cat > figures.py <<'PY'
import io, sys
import numpy as np
import pandas as pd
column = pd.read_csv(io.StringIO("clearance_mm\n1\n2\n3\n4\ninf\ninf\ninf\n")).clearance_mm
print("pandas median", column.median())
print("pandas quantile", *column.quantile([0.25, 0.5, 0.75]))
print("pandas describe", *column.describe()[["25%", "50%", "75%"]])
sys.stderr.write("numpy from here\n")
print("numpy median", np.median(column), "quantile", *np.quantile(column, [0.25, 0.5, 0.75]))
PY
cat > figures.m <<'M'
x = [1; 2; 3; 4; Inf; Inf; Inf];
printf("Octave median %g quantile %g %g %g prctile %g\n", median(x), quantile(x, [0.25; 0.5; 0.75]), prctile(x, 50));
printf("Octave, 1 2 3 Inf Inf: quantile %g %g\n", quantile([1; 2; 3; Inf; Inf], [0.5; 0.9]));
M
cat > figures.R <<'R'
x <- c(1, 2, 3, 4, Inf, Inf, Inf)
cat("R median", median(x), "quantile", quantile(x, c(0.25, 0.5, 0.75)))
cat("\n")
R
{
  inside python3 figures.py 2> python.err
  inside octave-cli --no-gui --quiet --norc figures.m 2> octave.err || true
  inside Rscript --vanilla figures.R 2> r.err
  count() { grep -ciE "$1" "$2" || true; }
  sed '/numpy from here/,$d' python.err > pandas.err; sed '1,/numpy from here/d' python.err > numpy.err
  echo "warnings: pandas $(count RuntimeWarning pandas.err), numpy $(count RuntimeWarning numpy.err)," \
    "Octave $(count warning octave.err), R $(count warning r.err)"
} | tee seen
cat > wanted <<'T'
pandas median 4.0
pandas quantile 2.5 nan nan
pandas describe 2.5 nan nan
numpy median 4.0 quantile 2.5 nan nan
Octave median 4 quantile 2.25 NaN Inf prctile NaN
Octave, 1 2 3 Inf Inf: quantile NaN NaN
R median 4 quantile 2.5 4 Inf
warnings: pandas 4, numpy 2, Octave 0, R 0
T
diff wanted seen
echo "as described"
