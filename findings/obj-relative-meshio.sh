#!/usr/bin/env bash
# meshio reads relative vertex numbers of an OBJ one too low and from the end of the file: two boxes become a tangle of volume 0, silently.
# Version: meshio-tools, python3-meshio 7.0.0-3 (meshio 5.0.0); beside it assimp 5.2.5, which reads them as it should (Debian 12, amd64).
# Seen, for two closed boxes of 20 x 10 x 6 mm, 20 mm apart, each as "o NAME", 8 lines "v", 12 lines "f" (volume 2400, area 1520):
#   f 1 3 4 (absolute numbers)          meshio convert to STL: volume 2400, area 1520; as it should be
#   f -8 -6 -5 (the same, relative)     volume 0, area 2561.37, from x = 21 instead of 1; no message, exit code 0
#   the same to OFF                     faces "3 -9 -7 -6": numbers that no OFF may have
#   assimp export of either             volume 2400, area 1520
# Wavefront's "Object Files", "Referencing vertex data": -1 is the last vertex defined before the "f" line, -2 the one before it. meshio
# subtracts 1 from every number, which makes -8 to -9; numpy then counts from the end of all the file's vertices.
# Why it hurts: some exporters that write part after part (bone, nerve, disc) use these numbers; the points and the number of faces
# are right, so a check of them passes. One box alone raises an IndexError (-9 of 8) on the way to STL; two do not.
# Seen on 2026-11-29. Needs Debian 12 (amd64) with root and apt. Exit 0: as described; else changed or (2, 3) not these versions.
set -euo pipefail
packages=(python3-meshio=7.0.0-3 meshio-tools=7.0.0-3 python3-numpy=1:1.24.2-1+deb12u1 assimp-utils=5.2.5~ds0-1+b1)
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
inside python3 - <<'PY'
corners = [(1 + 20 * (i & 1), 2 + 10 * (i >> 1 & 1), 3 + 6 * (i >> 2)) for i in range(8)]
quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
for form in ("absolute", "relative"):
    with open(form + ".obj", "w") as f:
        for part, name in enumerate(("bone", "nerve")):
            first = 8 * part + 1 if form == "absolute" else -8
            f.write(f"o {name}\n" + "".join(f"v {x + 40 * part} {y} {z}\n" for x, y, z in corners))
            f.writelines(f"f {a + first} {b + first} {c + first}\n" for a, b, c in triangles)
PY
cat > measure.py <<'PY'
import sys
import numpy as np
data = open(sys.argv[1], "rb").read()
if len(data) == 84 + 50 * int.from_bytes(data[80:84], "little"):
    t = np.frombuffer(data[84:], [("v", "<f4", (4, 3)), ("a", "<u2")])["v"][:, 1:].astype(float)
else:
    t = np.array([l.split()[1:] for l in data.decode().splitlines() if l.split()[:1] == ["vertex"]], float).reshape(-1, 3, 3)
n = np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
print(f"{len(t)} triangles, volume {abs((t[:, 0] * n).sum() / 6):.2f}, area {np.linalg.norm(n, axis=1).sum() / 2:.2f},",
      f"x from {t[..., 0].min():g} to {t[..., 0].max():g}")
PY
for form in absolute relative; do
  inside assimp export $form.obj assimp.stl > log
  code=0; inside meshio convert $form.obj meshio.stl > messages 2>&1 || code=$?
  echo "$form, assimp: $(inside python3 measure.py assimp.stl)"
  echo "$form, meshio: $(inside python3 measure.py meshio.stl); exit code $code, $(wc -l < messages) messages"
  inside meshio convert $form.obj meshio.off > log; echo "$form, meshio, OFF: $(grep -m 1 '^3 ' meshio.off)"
done | tee seen
cat > wanted <<'T'
absolute, assimp: 24 triangles, volume 2400.00, area 1520.00, x from 1 to 61
absolute, meshio: 24 triangles, volume 2400.00, area 1520.00, x from 1 to 61; exit code 0, 0 messages
absolute, meshio, OFF: 3 0 2 3
relative, assimp: 24 triangles, volume 2400.00, area 1520.00, x from 1 to 61
relative, meshio: 24 triangles, volume 0.00, area 2561.37, x from 21 to 61; exit code 0, 0 messages
relative, meshio, OFF: 3 -9 -7 -6
T
diff wanted seen
echo "as described"
