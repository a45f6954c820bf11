#!/usr/bin/env bash
# NiiVue reads the vertices of a binary PLY from fixed places, not by their properties' names: the mesh it shows is another, silently.
# Version: @niivue/niivue 0.69.0 (npm; Node 20).
# Seen, for a closed box of 20 x 10 x 6 mm (volume 1200) as 8 vertices and 12 triangles, binary_little_endian:
#   float x y z, then float value     as it should be: volume 1200, from 1,2,3 to 21,12,9
#   float value, then float x y z     volume 800, from -2.5,1,2 to 4.5,21,12: value is taken for x, x for y, y for z
#   float z y x                       volume -1200, from 3,2,1 to 9,12,21: turned inside out, x and z exchanged
#   float nx ny nz, then float x y z  volume 0: all vertices are their normals
#   the same four in ascii            as they should be
# No exception, no warning. A PLY header names its properties and lays down their order, which is free ("The PLY Polygon File Format",
# G. Turk: readers are to find the properties they know by name and to pass over others).
# Why it hurts: a surface with a value a vertex (distance, CT number, thickness) in front of its coordinates looks like a bone of another
# shape or as its mirror image, and a check by eye that began with the ascii file passes.
# Seen on 2026-11-28. Needs Node 20 with npm. Exit 0: as described; else changed or (2, 3) not these versions.
set -euo pipefail
packages=(@niivue/niivue@0.69.0)
# The same in every script for npm: exactly these packages in a temp folder, their install scripts not run.
dir=$(mktemp -d); trap 'rm -rf --one-file-system "$dir"' EXIT; cd "$dir"
npm install --prefix "$dir" --ignore-scripts --no-audit --no-fund "${packages[@]}" > log 2>&1 ||
  { tail -n 20 log; echo "cannot install ${packages[*]}"; exit 2; }
for p in "${packages[@]}"; do
  v=$(node -p "require('./node_modules/${p%@*}/package.json').version"); [ "$v" = "${p##*@}" ] || { echo "expected $p, found $v"; exit 3; }
done
cat > read.mjs <<'JS'
import { NVMeshLoaders } from '@niivue/niivue';
const corners = [[1, 2, 3], [21, 2, 3], [21, 12, 3], [1, 12, 3], [1, 2, 9], [21, 2, 9], [21, 12, 9], [1, 12, 9]];
const faces = [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], [0, 1, 5], [0, 5, 4], [1, 2, 6], [1, 6, 5], [2, 3, 7], [2, 7, 6], [3, 0, 4],
  [3, 4, 7]];
const rows = corners.map(([x, y, z], i) => ({ x, y, z, nx: 0.6, ny: 0.8, nz: 0, value: i - 2.5 }));
function ply(format, names) {
  const head = `ply\nformat ${format} 1.0\nelement vertex 8\n${names.map((n) => `property float ${n}\n`).join('')}` +
    'element face 12\nproperty list uchar int vertex_indices\nend_header\n';
  if (format === 'ascii') {
    return Buffer.from(head + rows.map((r) => names.map((n) => r[n]).join(' ') + '\n').join('') +
      faces.map((f) => `3 ${f.join(' ')}\n`).join(''));
  }
  const floats = Buffer.alloc(32 * names.length), list = Buffer.alloc(12 * 13);
  rows.forEach((r, i) => names.forEach((n, j) => floats.writeFloatLE(r[n], 4 * (i * names.length + j))));
  faces.forEach((f, i) => { list[13 * i] = 3; f.forEach((c, j) => list.writeInt32LE(c, 13 * i + 1 + 4 * j)); });
  return Buffer.concat([Buffer.from(head), floats, list]);
}
const said = [];
for (const way of ['log', 'info', 'warn', 'error']) console[way] = (...words) => said.push(words.join(' '));
for (const names of ['x y z value', 'value x y z', 'z y x', 'nx ny nz x y z']) {
  for (const format of ['binary_little_endian', 'ascii']) {
    const file = ply(format, names.split(' '));
    const mesh = await NVMeshLoaders.readPLY(new Uint8Array(file).buffer);
    const p = mesh.positions, low = [0, 1, 2].map((k) => Math.min(...p.filter((_, i) => i % 3 === k)));
    const high = [0, 1, 2].map((k) => Math.max(...p.filter((_, i) => i % 3 === k)));
    let volume = 0;
    for (let t = 0; t < mesh.indices.length; t += 3) {
      const [a, b, c] = [0, 1, 2].map((k) => p.slice(3 * mesh.indices[t + k], 3 * mesh.indices[t + k] + 3));
      volume += (a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])) / 6;
    }
    const line = (v) => v.map((x) => +x.toFixed(3)).join(',');
    process.stdout.write(`${names}, ${format}: volume ${Math.round(volume)}, from ${line(low)} to ${line(high)}\n`);
  }
}
process.stdout.write(`messages: ${said.length}\n`);
process.exit(0);
JS
node read.mjs | tee seen
cat > wanted <<'T'
x y z value, binary_little_endian: volume 1200, from 1,2,3 to 21,12,9
x y z value, ascii: volume 1200, from 1,2,3 to 21,12,9
value x y z, binary_little_endian: volume 800, from -2.5,1,2 to 4.5,21,12
value x y z, ascii: volume 1200, from 1,2,3 to 21,12,9
z y x, binary_little_endian: volume -1200, from 3,2,1 to 9,12,21
z y x, ascii: volume 1200, from 1,2,3 to 21,12,9
nx ny nz x y z, binary_little_endian: volume 0, from 0.6,0.8,0 to 0.6,0.8,0
nx ny nz x y z, ascii: volume 1200, from 1,2,3 to 21,12,9
messages: 0
T
diff wanted seen
echo "as described"
