#!/usr/bin/env bash
# plastimatch leaves CLOSEDPLANAR_XOR contours out of a structure set, and fills inner contours in label maps even with --xor-contours.
# Version: plastimatch 1.9.4 (Debian 12, amd64): plastimatch convert --input SET.dcm --referenced-ct FOLDER --output-labelmap MAP.nii ...
# Seen, for a ring of 576 voxels around a hole of 192, on three slices, and a small square (CLOSED_PLANAR) of 12 beside it:
#   the ring's contours         label map        label map, --xor-contours   --output-ss-img of that same run
#   CLOSED_PLANAR, a keyhole    ring             ring                        ring
#   CLOSED_PLANAR, two          ring and hole    ring and hole               ring
#   CLOSEDPLANAR_XOR, two       nothing          nothing                     nothing
# Exit code 0, nothing on stderr, no "warning" or "error". For each XOR contour a line "Skipping geometric type: [CLOSEDPLANAR_XOR]" is
# among the usual lines on stdout; the list of names has the ring as -1, and the square gets the label that the ring has else: 1, not 2.
# DICOM PS3.3, C.8.8.6.3 has two forms for holes: keyholes, and CLOSEDPLANAR_XOR (it is in 2024c; 2018e has keyholes alone). That plain
# contours are added up is documented (--xor-contours: "overlapping contours should be xor'd instead of or'd"), the rest was not found so.
# Why it hurts: a bone with XOR contours is missing, and its label another bone's; with two plain ones its canal is bone, also for who gave
# the option, and compared --output-ss-img. Known in part: another program's public notes on 1.9.4 have the sum, and XOR contours dropped.
# Seen on 2026-11-29. Needs Debian 12 (amd64) with root and apt. Exit 0: as described; else changed or (2, 3) not these versions.
set -euo pipefail
packages=(plastimatch=1.9.4+dfsg.2-0+deb12u1 python3-pydicom=2.3.1-1)
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
cat > write.py <<'PY'
import os
from pydicom.dataset import Dataset, FileMetaDataset
from pydicom.uid import ExplicitVRLittleEndian
ct, rtstruct, study = "1.2.840.10008.5.1.4.1.1.2", "1.2.840.10008.5.1.4.1.1.481.3", "1.2.840.10008.3.1.2.3.1"
uid = lambda *parts: "2.25.8152." + ".".join(str(p) for p in parts)
def item(**values):
    d = Dataset()
    for name, value in values.items():
        setattr(d, name, value)
    return d
def start(sop_class, instance, series, modality):
    d = Dataset(); d.file_meta = FileMetaDataset(); d.is_little_endian = True; d.is_implicit_VR = False
    d.SOPClassUID = d.file_meta.MediaStorageSOPClassUID = sop_class
    d.SOPInstanceUID = d.file_meta.MediaStorageSOPInstanceUID = instance
    d.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian; d.file_meta.ImplementationClassUID = "2.25.8152"
    d.StudyInstanceUID, d.SeriesInstanceUID, d.FrameOfReferenceUID = uid(1), series, uid(2)
    d.Modality = modality; d.Manufacturer = "none"; d.PatientName = "A^B"; d.PatientID = "1"
    d.PatientBirthDate = d.PatientSex = d.AccessionNumber = d.ReferringPhysicianName = d.PositionReferenceIndicator = ""
    d.StudyDate = "20260101"; d.StudyTime = "120000"; d.StudyID = d.SeriesNumber = d.InstanceNumber = "1"
    return d
os.makedirs("ct")
for k in range(5):
    d = start(ct, uid(3, k + 1), uid(4), "CT"); d.ImageType = ["ORIGINAL", "PRIMARY", "AXIAL"]
    d.SeriesDate = d.ContentDate = "20260101"; d.SeriesTime = d.ContentTime = "120000"; d.AcquisitionNumber = "1"; d.KVP = "120"
    d.Laterality = ""; d.InstanceNumber = str(k + 1); d.PatientPosition = "HFS"; d.SliceThickness = "2"; d.PixelSpacing = ["1", "1"]
    d.ImageOrientationPatient = ["1", "0", "0", "0", "1", "0"]; d.ImagePositionPatient = ["0", "0", str(2 * k)]
    d.SamplesPerPixel = 1; d.PhotometricInterpretation = "MONOCHROME2"; d.Rows = d.Columns = 32
    d.BitsAllocated, d.BitsStored, d.HighBit, d.PixelRepresentation = 16, 16, 15, 1
    d.RescaleIntercept, d.RescaleSlope, d.RescaleType = "0", "1", "HU"
    d.PixelData = bytes(2 * 32 * 32); d["PixelData"].VR = "OW"
    d.save_as(f"ct/{k}.dcm", write_like_original=False)
# All lines lie a quarter of a voxel beside centres: 16 x 16 of them are in the outer square, 8 x 8 in the inner one, 2 x 2 in the small.
square = lambda a, b: [(a, a), (b, a), (b, b), (a, b)]
outer, inner, small = square(7.75, 23.75), square(11.75, 19.75), square(2.75, 4.75)
a, b, c, d = 7.75, 11.75, 15.25, 19.75  # the channel, of no width, lies at y = c
keyhole = outer + [(a, c), (b, c), (b, d), (d, d), (d, b), (b, b), (b, c), (a, c)]
rings = {"keyhole": ("CLOSED_PLANAR", [keyhole]), "two": ("CLOSED_PLANAR", [outer, inner]), "xor": ("CLOSEDPLANAR_XOR", [outer, inner])}
image = lambda k: item(ReferencedSOPClassUID=ct, ReferencedSOPInstanceUID=uid(3, k + 1))
for number, (form, ring) in enumerate(rings.items()):
    d = start(rtstruct, uid(5, number + 1), uid(6, number + 1), "RTSTRUCT")
    d.OperatorsName = ""; d.StructureSetLabel = form; d.StructureSetDate, d.StructureSetTime = "20260101", "120000"
    series = item(SeriesInstanceUID=uid(4), ContourImageSequence=[image(k) for k in range(5)])
    studies = [item(ReferencedSOPClassUID=study, ReferencedSOPInstanceUID=uid(1), RTReferencedSeriesSequence=[series])]
    d.ReferencedFrameOfReferenceSequence = [item(FrameOfReferenceUID=uid(2), RTReferencedStudySequence=studies)]
    d.StructureSetROISequence, d.ROIContourSequence, d.RTROIObservationsSequence = [], [], []
    for roi, (name, (kind, lines)) in enumerate({"ring": ring, "square": ("CLOSED_PLANAR", [small])}.items(), 1):
        d.StructureSetROISequence.append(item(ROINumber=roi, ReferencedFrameOfReferenceUID=uid(2), ROIName=name,
            ROIGenerationAlgorithm="AUTOMATIC"))
        d.ROIContourSequence.append(item(ReferencedROINumber=roi, ROIDisplayColor=[255, 0, 0], ContourSequence=[
            item(ContourImageSequence=[image(k)], ContourGeometricType=kind, NumberOfContourPoints=len(points),
                ContourData=[str(v) for x, y in points for v in (x, y, 2 * k)]) for k in (1, 2, 3) for points in lines]))
        d.RTROIObservationsSequence.append(item(ObservationNumber=roi, ReferencedROINumber=roi, RTROIInterpretedType="ORGAN",
            ROIInterpreter=""))
    d.save_as(f"{form}.dcm", write_like_original=False)
PY
cat > count.py <<'PY'
import array, struct, sys
data = open(sys.argv[1], "rb").read()  # a NIfTI-1 file
size, kind, offset = struct.unpack("<3h", data[42:48]), *struct.unpack("<h", data[70:72]), *struct.unpack("<f", data[108:112])
values = array.array({2: "B", 768: "I"}[kind], data[int(offset):])  # of --output-ss-img the first of two bytes: a bit a structure
assert size == (32, 32, 5) and not any(values[32 * 32 * 5:])
def found(low, high, but=()):
    places = [(x, y) for y in range(low, high) for x in range(low, high) if x not in but or y not in but]
    there = [values[x + 32 * (y + 32 * z)] for z in (1, 2, 3) for x, y in places]
    return f"{sum(v != 0 for v in there)} of {len(there)}" + "".join(f" as {v}" for v in sorted(set(there) - {0}))
print(f"ring {found(8, 24, range(12, 20))}, hole {found(12, 20)}, square {found(3, 5)}, all {sum(v != 0 for v in values)}")
PY
inside python3 write.py
for form in keyhole two xor; do
  for option in "" --xor-contours; do
    rm -f map.nii bits.nii list; code=0
    inside plastimatch convert --input $form.dcm --referenced-ct ct --output-labelmap map.nii --output-ss-img bits.nii \
      --output-ss-list list $option > log 2> errors || code=$?
    echo "$form${option:+ $option}: exit code $code, stderr $(wc -c < errors) bytes, warnings $(grep -ciE 'warn|error' log || true)," \
      "skipped $(grep -cFx 'Skipping geometric type: [CLOSEDPLANAR_XOR]' log || true), list $(cut -d '|' -f 1,3 list | xargs)"
    for file in map bits; do echo "  $file: $(inside python3 count.py $file.nii)"; done
  done
done | tee seen
cat > wanted <<'T'
keyhole: exit code 0, stderr 0 bytes, warnings 0, skipped 0, list 0|ring 1|square
  map: ring 576 of 576 as 1, hole 0 of 192, square 12 of 12 as 2, all 588
  bits: ring 576 of 576 as 1, hole 0 of 192, square 12 of 12 as 2, all 588
keyhole --xor-contours: exit code 0, stderr 0 bytes, warnings 0, skipped 0, list 0|ring 1|square
  map: ring 576 of 576 as 1, hole 0 of 192, square 12 of 12 as 2, all 588
  bits: ring 576 of 576 as 1, hole 0 of 192, square 12 of 12 as 2, all 588
two: exit code 0, stderr 0 bytes, warnings 0, skipped 0, list 0|ring 1|square
  map: ring 576 of 576 as 1, hole 192 of 192 as 1, square 12 of 12 as 2, all 780
  bits: ring 576 of 576 as 1, hole 192 of 192 as 1, square 12 of 12 as 2, all 780
two --xor-contours: exit code 0, stderr 0 bytes, warnings 0, skipped 0, list 0|ring 1|square
  map: ring 576 of 576 as 1, hole 192 of 192 as 1, square 12 of 12 as 2, all 780
  bits: ring 576 of 576 as 1, hole 0 of 192, square 12 of 12 as 2, all 588
xor: exit code 0, stderr 0 bytes, warnings 0, skipped 6, list -1|ring 0|square
  map: ring 0 of 576, hole 0 of 192, square 12 of 12 as 1, all 12
  bits: ring 0 of 576, hole 0 of 192, square 12 of 12 as 1, all 12
xor --xor-contours: exit code 0, stderr 0 bytes, warnings 0, skipped 6, list -1|ring 0|square
  map: ring 0 of 576, hole 0 of 192, square 12 of 12 as 1, all 12
  bits: ring 0 of 576, hole 0 of 192, square 12 of 12 as 1, all 12
T
diff wanted seen
echo "as described"
