#!/usr/bin/env bash
# itk-wasm reads the faces of every OBJ two numbers in one: of 12 triangles it returns 12 cells whose corners are numbers in the billions.
# Version: @itk-wasm/mesh-io 1.7.1 (npm; Node 20).
# Seen, for a closed box of 8 vertices and 12 triangles, as OBJ and as ASCII STL, read by readMeshNode:
#   STL   cells: 12 times (2, 3, a, b, c): a triangle, 3 corners, vertices below 8; as it should be
#   OBJ   12 cells and 60 numbers are announced as well, but the first 30 hold two 32-bit numbers each (12884901892 = 3 * 2^32 + 4: 3
#         corners, a polygon) and the other 30 are 0
#   the mesh of the OBJ written again by writeMeshNode as OFF: "OFF 8 12", an empty face and corners like 8589934595
# No exception, and numberOfPoints, numberOfCells and the points are right. An OBJ's "f" lines are vertex numbers (Wavefront's
# "Object Files", "Polygonal geometry"); itk-wasm's Mesh documents "cells" as type, number of points, then their indices.
# Why it hurts: a viewer or a converter in the browser gets points and a number of cells that pass a check, and shows nothing or takes
# corners from beyond the vertices; the same surface as STL works, so the file is blamed.
# Seen on 2026-11-28. Needs Node 20 with npm. Exit 0: as described; else changed or (2, 3) not these versions.
set -euo pipefail
packages=(@itk-wasm/mesh-io@1.7.1)
# The same in every script for npm: exactly these packages in a temp folder, their install scripts not run.
dir=$(mktemp -d); trap 'rm -rf --one-file-system "$dir"' EXIT; cd "$dir"
npm install --prefix "$dir" --ignore-scripts --no-audit --no-fund "${packages[@]}" > log 2>&1 ||
  { tail -n 20 log; echo "cannot install ${packages[*]}"; exit 2; }
for p in "${packages[@]}"; do
  v=$(node -p "require('./node_modules/${p%@*}/package.json').version"); [ "$v" = "${p##*@}" ] || { echo "expected $p, found $v"; exit 3; }
done
cat > read.mjs <<'JS'
import fs from 'fs';
import { readMeshNode, writeMeshNode } from '@itk-wasm/mesh-io';
const corners = [[1, 2, 3], [21, 2, 3], [21, 12, 3], [1, 12, 3], [1, 2, 9], [21, 2, 9], [21, 12, 9], [1, 12, 9]];
const faces = [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], [0, 1, 5], [0, 5, 4], [1, 2, 6], [1, 6, 5], [2, 3, 7], [2, 7, 6], [3, 0, 4],
  [3, 4, 7]];
fs.writeFileSync('box.obj', corners.map((c) => `v ${c.join(' ')}\n`).join('') +
  faces.map((f) => `f ${f.map((i) => i + 1).join(' ')}\n`).join(''));
fs.writeFileSync('box.stl', 'solid box\n' + faces.map((f) => 'facet normal 0 0 0\nouter loop\n' +
  f.map((i) => `vertex ${corners[i].join(' ')}\n`).join('') + 'endloop\nendfacet\n').join('') + 'endsolid box\n');
for (const file of ['box.stl', 'box.obj']) {
  const mesh = await readMeshNode(file), cells = Array.from(mesh.cells, Number);
  let good = 0;
  for (let i = 0; i < 12; ++i) {
    const [type, count, ...ids] = cells.slice(5 * i, 5 * i + 5);
    good += (type === 2 || type === 4) && count === 3 && ids.every((id) => id >= 0 && id < 8);
  }
  console.log(`${file}: points ${mesh.numberOfPoints}, cells ${mesh.numberOfCells}, numbers ${cells.length}, triangles ${good}`);
  const last = cells.length - [...cells].reverse().findIndex((c) => c);
  console.log(`  first: ${cells.slice(0, 5).join(' ')}; the last that is not 0 is number ${last}`);
  if (file === 'box.obj') {
    const low = Number(BigInt(cells[0]) & 0xffffffffn), high = Number(BigInt(cells[0]) >> 32n);
    console.log(`  the first of them in 32-bit numbers: ${low} ${high}`);
  }
  await writeMeshNode(mesh, 'out.off');
  const lines = fs.readFileSync('out.off', 'utf8').split('\n').map((l) => l.trim().replace(/ +/g, ' '));
  console.log(`  written as OFF: ${lines.slice(0, 2).join(' ')}; first faces: ${lines.slice(10, 12).join('; ')}`);
}
process.exit(0);
JS
node read.mjs 2>&1 | tee seen
cat > wanted <<'T'
box.stl: points 8, cells 12, numbers 60, triangles 12
  first: 2 3 0 1 2; the last that is not 0 is number 60
  written as OFF: OFF 8 12 0; first faces: 3 0 1 2; 3 0 3 1
box.obj: points 8, cells 12, numbers 60, triangles 0
  first: 12884901892 8589934592 17179869185 3 8589934595; the last that is not 0 is number 30
  the first of them in 32-bit numbers: 4 3
  written as OFF: OFF 8 12 0; first faces: 0; 3 8589934595 12884901892 21474836484
T
diff wanted seen
echo "as described"
