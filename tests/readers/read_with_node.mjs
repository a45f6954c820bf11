// read_with_node.mjs SEG.dcm OUT.json: what OHIF's dcmjs and itk-wasm (dcmqi, DCMTK) find in a DICOM segmentation, as
// numbers of voxels by segment and slice.
import { readFileSync, writeFileSync } from "node:fs";
import dcmjs from "dcmjs";
import { readSegmentationNode } from "@itk-wasm/dicom";

const path = process.argv[2];
const bytes = readFileSync(path);
const found = { dcmjs: {}, itk: {} };

const dicom = dcmjs.data.DicomMessage.readFile(
  bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength),
);
const data = dcmjs.data.DicomMetaDictionary.naturalizeDataset(dicom.dict);
const list = (x) => (Array.isArray(x) ? x : [x]);
const pixels = dcmjs.data.BitArray.unpack(list(data.PixelData)[0]);
const size = data.Rows * data.Columns;
const labels = {};
for (const s of list(data.SegmentSequence)) labels[s.SegmentNumber] = s.SegmentLabel;
list(data.PerFrameFunctionalGroupsSequence).forEach((group, n) => {
  const label = labels[list(group.SegmentIdentificationSequence)[0].ReferencedSegmentNumber];
  const z = list(group.PlanePositionSequence)[0].ImagePositionPatient.map(Number);
  let count = 0;
  let sum = 0;
  for (let p = 0; p < size; ++p) {
    if (pixels[n * size + p] === 0) continue;
    count += 1;
    sum += p; // tells where in the slice they lie
  }
  (found.dcmjs[label] ??= []).push([z, count, sum]);
});

try {
  const { segImage, metaInfo } = await readSegmentationNode(path);
  const meta = metaInfo?.data ?? metaInfo;
  const names = {};
  for (const group of meta.segmentAttributes)
    for (const s of group) names[s.labelID] = s.SegmentLabel ?? s.SegmentDescription;
  const counts = {};
  for (const value of segImage.data) if (value !== 0) counts[value] = (counts[value] ?? 0) + 1;
  found.itk = { size: segImage.size, origin: segImage.origin, spacing: segImage.spacing, names, counts };
  // All voxels, so that each can be compared.
  found.itk.voxels = [];
  segImage.data.forEach((value, at) => {
    if (value !== 0) found.itk.voxels.push([at, value]);
  });
} catch (error) {
  found.itk = { error: error instanceof Error ? error.message : JSON.stringify(error) };
}
writeFileSync(process.argv[3], JSON.stringify(found));
