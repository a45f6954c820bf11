#!/usr/bin/env bash
# OpenSCAD takes every mesh of a 3MF once, where it was drawn: transforms, components, build list and unit are ignored, silently.
# Version: openscad 2021.01-6; beside it assimp 5.2.5, which reads all but the unit as it should (Debian 12, amd64).
# Seen, for a "bone" of 20 x 10 x 6 mm (volume 1200, x 1 .. 21) and a "screw" of 2 x 2 x 15 mm (volume 60, drawn at x 40 .. 42):
#   both as items of the build            OpenSCAD, as STL: volume 1260, x 1 .. 42, z 3 .. 18; as it should be
#   an assembly: the bone and the screw   the same numbers: one screw, beside the bone. Should be volume 1320, x 1 .. 21, z 3 .. 25: two
#   twice as components, moved to it      screws, above the bone
#   the bone as item, the screw in none   the same numbers: with the screw. Should be volume 1200, x 1 .. 21
#   the bone as item, scaled by 2         volume 1200, x 1 .. 21; should be 9600, x 2 .. 42
#   the bone as item, unit="inch"         volume 1200, x 1 .. 21; written as 3MF again, these numbers are millimetres (assimp has them, too)
# No warning, exit code 0. 3MF Core Specification (draft 1.2.4), 3.4.3 and 3.4.3.1: what no item refers to must not be output, and an item's
# transform must be applied; 4.2: components are placed by their transforms; 3.1: the unit of <model> must be used. OpenSCAD's man page has
# nothing on it. Nested objects and transforms came into its sources later (openscad pull request 5527, of December 2024, not the unit).
# Why it hurts: OpenSCAD is a way to cut a drill guide to an imported bone. Programs for printing write parts about their own origin and
# place them by transforms: vertebra, screws and guide then lie elsewhere, a repeated screw is there once, and a discarded part is back.
# Seen on 2026-11-30. Needs Debian 12 (amd64) with root and apt. Exit 0: as described; else changed or (2, 3) not these versions.
set -euo pipefail
packages=(openscad=2021.01-6 assimp-utils=5.2.5~ds0-1+b1 python3=3.11.2-1+b1)
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
import zipfile
quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
def box(number, name, corner, size):
    points = [[a + s * (i >> axis & 1) for axis, (a, s) in enumerate(zip(corner, size))] for i in range(8)]
    return (f'<object id="{number}" type="model" name="{name}"><mesh><vertices>'
            + "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in points) + "</vertices><triangles>"
            + "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in triangles) + "</triangles></mesh></object>")
bone, screw = box(1, "bone", (1, 2, 3), (20, 10, 6)), box(2, "screw", (40, 2, 3), (2, 2, 15))
moved = lambda x, z: f'transform="1 0 0 0 1 0 0 0 1 {x} 0 {z}"'
parts = f'<component objectid="1"/><component objectid="2" {moved(-37, 7)}/><component objectid="2" {moved(-25, 7)}/>'
assembly = f'<object id="3" type="model" name="assembly"><components>{parts}</components></object>'
item = lambda number, more="": f'<item objectid="{number}" {more}/>'
models = {
    "both": ("millimeter", bone + screw, item(1) + item(2)),
    "assembly": ("millimeter", bone + screw + assembly, item(3)),
    "unlisted": ("millimeter", bone + screw, item(1)),
    "scaled": ("millimeter", bone, item(1, 'transform="2 0 0 0 2 0 0 0 2 0 0 0"')),
    "inch": ("inch", bone, item(1)),
}
start = '<?xml version="1.0" encoding="UTF-8"?>\n'
package, model_type = "http://schemas.openxmlformats.org/package/2006/", "application/vnd.ms-package.3dmanufacturing-3dmodel+xml"
for name, (unit, resources, build) in models.items():
    with zipfile.ZipFile(name + ".3mf", "w", zipfile.ZIP_DEFLATED) as z:
        z.writestr("[Content_Types].xml", f'{start}<Types xmlns="{package}content-types"><Default Extension="rels" ContentType='
                   '"application/vnd.openxmlformats-package.relationships+xml"/>'
                   f'<Default Extension="model" ContentType="{model_type}"/></Types>')
        z.writestr("_rels/.rels", f'{start}<Relationships xmlns="{package}relationships"><Relationship Id="r1" Target="/3D/3dmodel.model" '
                   'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>')
        z.writestr("3D/3dmodel.model", f'{start}<model unit="{unit}" xml:lang="en-US" xmlns='
                   '"http://schemas.microsoft.com/3dmanufacturing/core/2015/02">'
                   f'<resources>{resources}</resources><build>{build}</build></model>')
PY
cat > measure.py <<'PY'
import sys
v = [[float(n) for n in l.split()[1:]] for l in open(sys.argv[1]) if l.split()[:1] == ["vertex"]]
def six(a, b, c):
    return (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]))
volume = sum(six(*v[i:i + 3]) for i in range(0, len(v), 3)) / 6
x, y, z = ([p[i] for p in v] for i in range(3))
print(f"{len(v) // 3} triangles, volume {volume:.2f}, x {min(x):g} .. {max(x):g}, z {min(z):g} .. {max(z):g}")
PY
for name in both assembly unlisted scaled inch; do
  inside assimp export $name.3mf assimp.stl > log
  echo "import(\"$name.3mf\");" > model.scad
  code=0; inside openscad -o openscad.stl model.scad > messages 2>&1 || code=$?
  echo "$name, assimp: $(inside python3 measure.py assimp.stl)"
  echo "$name, OpenSCAD: $(inside python3 measure.py openscad.stl); exit code $code, $(grep -ciE 'warn|error' messages || true) warnings"
done | tee seen
inside openscad -o again.3mf model.scad > log 2>&1
inside python3 - <<'PY' | tee -a seen
import re, zipfile
text = zipfile.ZipFile("again.3mf").read("3D/3dmodel.model").decode()
x = [float(value) for value in re.findall(r'<vertex x="([^"]+)"', text)]
print(f"inch, again as 3MF: {re.search('unit=.*?[ >]', text)[0].strip()}, x {min(x):g} .. {max(x):g}")
PY
cat > wanted <<'T'
both, assimp: 24 triangles, volume 1260.00, x 1 .. 42, z 3 .. 18
both, OpenSCAD: 24 triangles, volume 1260.00, x 1 .. 42, z 3 .. 18; exit code 0, 0 warnings
assembly, assimp: 36 triangles, volume 1320.00, x 1 .. 21, z 3 .. 25
assembly, OpenSCAD: 24 triangles, volume 1260.00, x 1 .. 42, z 3 .. 18; exit code 0, 0 warnings
unlisted, assimp: 12 triangles, volume 1200.00, x 1 .. 21, z 3 .. 9
unlisted, OpenSCAD: 24 triangles, volume 1260.00, x 1 .. 42, z 3 .. 18; exit code 0, 0 warnings
scaled, assimp: 12 triangles, volume 9600.00, x 2 .. 42, z 6 .. 18
scaled, OpenSCAD: 12 triangles, volume 1200.00, x 1 .. 21, z 3 .. 9; exit code 0, 0 warnings
inch, assimp: 12 triangles, volume 1200.00, x 1 .. 21, z 3 .. 9
inch, OpenSCAD: 12 triangles, volume 1200.00, x 1 .. 21, z 3 .. 9; exit code 0, 0 warnings
inch, again as 3MF: unit="millimeter", x 1 .. 21
T
diff wanted seen
echo "as described"
