#!/usr/bin/env bash
# itk-wasm and daikon turn the CT numbers of a MONOCHROME1 image upside down: bone of 700 HU becomes -701 HU, air 999.
# Version: @itk-wasm/dicom 7.6.4, daikon 1.2.46 (npm; Node 20); beside them dicom-parser 1.8.21, which gives the values that are stored.
# Seen, for two CT slices with -1000, -300, 0, 40 and 700 HU (signed, 16 bits, slope 1, intercept 0), once with
# PhotometricInterpretation MONOCHROME2, once with MONOCHROME1, else the same:
#   MONOCHROME2   all three give the HU that are stored
#   MONOCHROME1   readImageDicomFileSeries of itk-wasm gives 999, 299, -1, -41 and -701 (-1 - HU), daikon's getInterpretedData gives
#                 32767 - HU and 32767 at most: 32767, 32767, 32767, 32727 and 32067
# No exception, no message. DICOM PS3.3, C.7.6.3.1.2: MONOCHROME1 says that the least value is to be shown white "after any VOI gray
# scale transformations"; HU come of the modality transformation before it (PS3.4, N.2), and CT images may have either (C.8.2.1.1.2).
# Why it hurts: the way of display changes the quantity. Air is the densest thing then, and a threshold for bone takes all of it.
# Seen on 2026-11-28. Needs Node 20 with npm. Exit 0: as described; else changed or (2, 3) not these versions.
set -euo pipefail
packages=(@itk-wasm/dicom@7.6.4 daikon@1.2.46 dicom-parser@1.8.21)
# The same in every script for npm: exactly these packages in a temp folder, their install scripts not run.
dir=$(mktemp -d); trap 'rm -rf --one-file-system "$dir"' EXIT; cd "$dir"
npm install --prefix "$dir" --ignore-scripts --no-audit --no-fund "${packages[@]}" > log 2>&1 ||
  { tail -n 20 log; echo "cannot install ${packages[*]}"; exit 2; }
for p in "${packages[@]}"; do
  v=$(node -p "require('./node_modules/${p%@*}/package.json').version"); [ "$v" = "${p##*@}" ] || { echo "expected $p, found $v"; exit 3; }
done
cat > read.mjs <<'JS'
import fs from 'fs';
import path from 'path';
import { readImageDicomFileSeriesNode } from '@itk-wasm/dicom';
import daikon from 'daikon';
import parser from 'dicom-parser';
const hu = [-1000, -300, 0, 40, 700];
function element(group, tag, kind, value) { // explicit little endian
  const body = Buffer.isBuffer(value) ? value : Buffer.from(value.length % 2 ? value + (kind === 'UI' ? '\0' : ' ') : value, 'latin1');
  const long = kind === 'OW' || kind === 'OB', head = Buffer.alloc(long ? 12 : 8);
  head.writeUInt16LE(group, 0); head.writeUInt16LE(tag, 2); head.write(kind, 4, 'latin1');
  if (long) head.writeUInt32LE(body.length, 8); else head.writeUInt16LE(body.length, 6);
  return Buffer.concat([head, body]);
}
const us = (v) => { const b = Buffer.alloc(2); b.writeUInt16LE(v); return b; };
function slice(interpretation, n, k) {
  const uid = (s) => `2.25.8153.${n}.${s}`, pixels = Buffer.alloc(40);
  for (let i = 0; i < 20; ++i) pixels.writeInt16LE(hu[i % 5], 2 * i);
  const meta = Buffer.concat([element(2, 1, 'OB', Buffer.from([0, 1])), element(2, 2, 'UI', '1.2.840.10008.5.1.4.1.1.2'),
    element(2, 3, 'UI', uid(`1.${k}`)), element(2, 0x10, 'UI', '1.2.840.10008.1.2.1'), element(2, 0x12, 'UI', '2.25.8153')]);
  const size = Buffer.alloc(4); size.writeUInt32LE(meta.length);
  return Buffer.concat([Buffer.alloc(128), Buffer.from('DICM'), element(2, 0, 'UL', size), meta,
    element(8, 8, 'CS', 'ORIGINAL\\PRIMARY\\AXIAL'), element(8, 0x16, 'UI', '1.2.840.10008.5.1.4.1.1.2'),
    element(8, 0x18, 'UI', uid(`1.${k}`)), element(8, 0x20, 'DA', '20260101'), element(8, 0x30, 'TM', '120000'), element(8, 0x50, 'SH', ''),
    element(8, 0x60, 'CS', 'CT'),
    element(8, 0x70, 'LO', 'none'), element(8, 0x90, 'PN', ''), element(0x10, 0x10, 'PN', 'A^B'), element(0x10, 0x20, 'LO', '1'),
    element(0x10, 0x30, 'DA', ''), element(0x10, 0x40, 'CS', ''), element(0x18, 0x50, 'DS', '1'), element(0x18, 0x60, 'DS', '120'),
    element(0x18, 0x5100, 'CS', 'HFS'), element(0x20, 0xd, 'UI', uid(2)), element(0x20, 0xe, 'UI', uid(3)), element(0x20, 0x10, 'SH', '1'),
    element(0x20, 0x11, 'IS', '1'), element(0x20, 0x12, 'IS', '1'), element(0x20, 0x13, 'IS', `${k}`),
    element(0x20, 0x32, 'DS', `0\\0\\${k}`), element(0x20, 0x37, 'DS', '1\\0\\0\\0\\1\\0'), element(0x20, 0x52, 'UI', uid(4)),
    element(0x20, 0x60, 'CS', ''), element(0x20, 0x1040, 'LO', ''), element(0x28, 2, 'US', us(1)), element(0x28, 4, 'CS', interpretation),
    element(0x28, 0x10, 'US', us(4)), element(0x28, 0x11, 'US', us(5)), element(0x28, 0x30, 'DS', '0.5\\0.5'),
    element(0x28, 0x100, 'US', us(16)), element(0x28, 0x101, 'US', us(16)), element(0x28, 0x102, 'US', us(15)),
    element(0x28, 0x103, 'US', us(1)), element(0x28, 0x1052, 'DS', '0'), element(0x28, 0x1053, 'DS', '1'),
    element(0x28, 0x1054, 'LO', 'HU'), element(0x7fe0, 0x10, 'OW', pixels)]);
}
const said = [];
const show = (name, values) => process.stdout.write(`${name}: ${Array.from(values).slice(0, 5).map(Math.round).join(' ')}\n`);
for (const way of ['log', 'info', 'warn', 'error']) console[way] = (...words) => said.push(words.join(' '));
for (const [n, interpretation] of ['MONOCHROME2', 'MONOCHROME1'].entries()) {
  const files = [1, 2].map((k) => `${interpretation}-${k}.dcm`);
  files.forEach((file, k) => fs.writeFileSync(file, slice(interpretation, n + 1, k + 1)));
  const bytes = new Uint8Array(fs.readFileSync(files[0])), pixels = parser.parseDicom(bytes).elements.x7fe00010;
  show(`${interpretation}, stored (dicom-parser)`, new Int16Array(bytes.buffer.slice(pixels.dataOffset, pixels.dataOffset + 40)));
  const series = { inputImages: files.map((f) => path.resolve(f)), singleSortedSeries: false };
  show(`${interpretation}, itk-wasm`, (await readImageDicomFileSeriesNode(series)).outputImage.data);
  const image = daikon.Series.parseImage(new DataView(bytes.buffer)), values = image.getInterpretedData(true);
  show(`${interpretation}, daikon`, values.data ?? values);
}
process.stdout.write(`messages: ${said.length}\n`);
process.exit(0);
JS
node read.mjs 2> errors | tee seen
cat errors
cat > wanted <<'T'
MONOCHROME2, stored (dicom-parser): -1000 -300 0 40 700
MONOCHROME2, itk-wasm: -1000 -300 0 40 700
MONOCHROME2, daikon: -1000 -300 0 40 700
MONOCHROME1, stored (dicom-parser): -1000 -300 0 40 700
MONOCHROME1, itk-wasm: 999 299 -1 -41 -701
MONOCHROME1, daikon: 32767 32767 32767 32727 32067
messages: 0
T
diff wanted seen
echo "as described"
