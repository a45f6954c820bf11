#!/usr/bin/env bash
# three.js and vtk.js read a surface as VTK 9 writes it (legacy .vtk, version 5.1, ASCII) into other faces, without a word about the file.
# Version: three 0.187.0, @kitware/vtk.js 37.4.3 (npm; Node 20); the files are written and read back by Debian 12's python3-vtk9 9.1.0.
# Seen, for a closed box of 20 x 10 x 6 mm, 8 points and 12 triangles, written by vtkPolyDataWriter:
#   SetFileVersion(42)           VTK, three's VTKLoader and vtk.js' vtkPolyDataReader: 12 triangles, volume 1200
#   as VTK 9.1 writes it (5.1)   VTK: the same
#                                three: 27 triangles, 25 of them with corners beyond the 8 points, 2 of the box (volume 120)
#                                vtk.js: 8 cells, none of them a triangle of these points
# No exception; three says only that its loader is deprecated, for either file. Version 5.1 has one line "OFFSETS" and the corners of all
# faces under "CONNECTIVITY"; both take these numbers for the "3 a b c" of 4.2 and do not look at the version in the first line.
# vtk.js has a request for 5.1 (vtk-js issue 2076), which does not say that the result is wrong rather than an error.
# Why it hurts: VTK has written 5.1 unasked since VTK 9; the points and the bounding box are right, so a viewer in the
# browser shows a torn surface, or none, and any volume, normal or collision from it is of another body.
# Seen on 2026-11-29. Needs Debian 12 (amd64) with root and apt, Node 20 with npm. Exit 0: as described; else changed or (2, 3) not these.
set -euo pipefail
packages=(python3-vtk9=9.1.0+really9.1.0+dfsg2-5+deb12u1)
modules=(three@0.187.0 @kitware/vtk.js@37.4.3)
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
# For npm: exactly these packages in the same folder, their install scripts not run.
npm install --prefix "$PWD" --ignore-scripts --legacy-peer-deps --no-audit --no-fund "${modules[@]}" > log 2>&1 ||
  { tail -n 20 log; echo "cannot install ${modules[*]}"; exit 2; }
for p in "${modules[@]}"; do
  v=$(node -p "require('./node_modules/${p%@*}/package.json').version"); [ "$v" = "${p##*@}" ] || { echo "expected $p, found $v"; exit 3; }
done
cat > box.py <<'PY'
import vtk
box = vtk.vtkPolyData(); points = vtk.vtkPoints(); faces = vtk.vtkCellArray()
for i in range(8):
    points.InsertNextPoint(1 + 20 * (i & 1), 2 + 10 * (i >> 1 & 1), 3 + 6 * (i >> 2))
for a, b, c, d in ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)):
    for triangle in ((a, b, c), (a, c, d)):
        faces.InsertNextCell(3, triangle)
box.SetPoints(points); box.SetPolys(faces)
for name, version in (("4.2", 42), ("5.1", None)):
    writer = vtk.vtkPolyDataWriter(); writer.SetInputData(box); writer.SetFileName(name + ".vtk")
    if version:
        writer.SetFileVersion(version)
    writer.Write()
    reader = vtk.vtkPolyDataReader(); reader.SetFileName(name + ".vtk"); reader.Update()
    mass = vtk.vtkMassProperties(); mass.SetInputConnection(reader.GetOutputPort())
    print(f"{name}, VTK: {reader.GetOutput().GetNumberOfPolys()} faces, volume {mass.GetVolume():g};",
          open(name + ".vtk").readline().strip())
PY
cat > read.mjs <<'JS'
import fs from 'fs';
import { VTKLoader } from 'three/examples/jsm/loaders/VTKLoader.js';
import vtkPolyDataReader from '@kitware/vtk.js/IO/Legacy/PolyDataReader.js';
const show = (who, points, faces) => {
  const good = faces.filter((f) => f.length === 3 && f.every((i) => i < points.length / 3));
  const volume = good.map((f) => f.map((i) => points.slice(3 * i, 3 * i + 3))).reduce((sum, [a, b, c]) => sum +
    (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])) / 6, 0);
  console.log(`${who}: ${points.length / 3} points, ${faces.length} faces, ${good.length} of them triangles of these points;`,
    `volume ${+Math.abs(volume).toPrecision(6)}`);
};
for (const version of ['4.2', '5.1']) {
  const data = fs.readFileSync(`${version}.vtk`);
  const geometry = new VTKLoader().parse(data.buffer.slice(data.byteOffset, data.byteOffset + data.length));
  const index = Array.from(geometry.index.array), triangles = [];
  for (let i = 0; i < index.length; i += 3) triangles.push(index.slice(i, i + 3));
  show(`${version}, three`, Array.from(geometry.attributes.position.array), triangles);
  const reader = vtkPolyDataReader.newInstance();
  reader.parseAsText(data.toString('latin1'));
  const mesh = reader.getOutputData(), cells = Array.from(mesh.getPolys().getData()), faces = [];
  for (let i = 0; i < cells.length; i += cells[i] + 1) faces.push(cells.slice(i + 1, i + 1 + cells[i]));
  show(`${version}, vtk.js`, Array.from(mesh.getPoints().getData()), faces);
}
JS
{
  inside python3 box.py
  code=0; node read.mjs 2> messages || code=$?
  echo "exit code $code, messages: $(grep -cv deprecated messages || true)"
} | tee seen
cat > wanted <<'T'
4.2, VTK: 12 faces, volume 1200; # vtk DataFile Version 4.2
5.1, VTK: 12 faces, volume 1200; # vtk DataFile Version 5.1
4.2, three: 8 points, 12 faces, 12 of them triangles of these points; volume 1200
4.2, vtk.js: 8 points, 12 faces, 12 of them triangles of these points; volume 1200
5.1, three: 8 points, 27 faces, 2 of them triangles of these points; volume 120
5.1, vtk.js: 8 points, 8 faces, 0 of them triangles of these points; volume 0
exit code 0, messages: 0
T
diff wanted seen
echo "as described"
