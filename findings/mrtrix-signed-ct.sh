#!/usr/bin/env bash
# MRtrix's mrconvert takes a CT's signed values for unsigned ones (-300 HU becomes 65236) and exchanges its row and column spacing.
# Version: mrtrix3 3.0.3 (Debian 12, amd64); beside it dcm2niix 1.0.20220720, which reads these files as it should.
# Seen, for 3 CT slices of 6 columns 0.5 mm apart (i) and 4 rows 0.75 mm apart (j), PixelRepresentation 1, 16 of 16 bits, HU -300 .. 92:
#   dcm2niix     values -300 .. 92, 0.5 mm from column to column, 0.75 mm from row to row
#   mrconvert    values 0 .. 65478, 0.75 mm from column to column, 0.5 mm from row to row; mrinfo says "unsigned 16 bit integer"
#   the same stored unsigned (PixelRepresentation 0, RescaleIntercept -1024): mrconvert's values are right, its spacings are not
# No warning, exit code 0. DICOM PS3.3, C.7.6.3.1: PixelRepresentation 1 is two's complement; 10.7.1.3: the first value of PixelSpacing is
# the distance between rows (down), the second that between columns.
# Why it hurts: padding of -2000 and all air and fat become denser than any bone; slices whose pixels are not square (reformatted ones)
# get another shape, here 3 x 3 mm as 4.5 x 2 mm. Square pixels with unsigned values, the common case, are right.
# Seen on 2026-11-28. Needs Debian 12 (amd64) with root and apt. Exit 0: as described; else changed or (2, 3) not these versions.
set -euo pipefail
packages=(mrtrix3=3.0.3-3+b1 dcm2niix=1.0.20220720-1+deb12u1 python3-pydicom=2.3.1-1 python3-numpy=1:1.24.2-1+deb12u1)
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
import numpy as np
from pydicom.dataset import Dataset, FileMetaDataset
from pydicom.uid import ExplicitVRLittleEndian
k, j, i = np.mgrid[0:3, 0:4, 0:6]
hu = -300 + 4 * i + 24 * j + 150 * k
for number, (form, signed, intercept) in enumerate((("signed", 1, 0), ("unsigned", 0, -1024))):
    os.makedirs(form)
    for k in range(3):
        uid = lambda *parts: "2.25.8152." + ".".join(str(p) for p in (number + 1,) + parts)
        d = Dataset(); d.file_meta = FileMetaDataset(); d.is_little_endian = True; d.is_implicit_VR = False
        d.SOPClassUID = d.file_meta.MediaStorageSOPClassUID = "1.2.840.10008.5.1.4.1.1.2"
        d.SOPInstanceUID = d.file_meta.MediaStorageSOPInstanceUID = uid(1, k + 1)
        d.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian; d.file_meta.ImplementationClassUID = "2.25.8152"
        d.StudyInstanceUID, d.SeriesInstanceUID, d.FrameOfReferenceUID = uid(2), uid(3), uid(4)
        d.ImageType = ["ORIGINAL", "PRIMARY", "AXIAL"]; d.Modality = "CT"; d.Manufacturer = "none"; d.PatientName = "A^B"; d.PatientID = "1"
        d.PatientBirthDate = d.PatientSex = d.AccessionNumber = d.ReferringPhysicianName = d.PositionReferenceIndicator = d.Laterality = ""
        d.StudyDate = d.SeriesDate = d.ContentDate = "20260101"; d.StudyTime = d.SeriesTime = d.ContentTime = "120000"
        d.StudyID = d.SeriesNumber = d.AcquisitionNumber = "1"; d.InstanceNumber = str(k + 1); d.PatientPosition = "HFS"; d.KVP = "120"
        d.SliceThickness = "1"; d.PixelSpacing = ["0.75", "0.5"]; d.ImageOrientationPatient = ["1", "0", "0", "0", "1", "0"]
        d.ImagePositionPatient = ["0", "0", str(k)]; d.SamplesPerPixel = 1; d.PhotometricInterpretation = "MONOCHROME2"
        d.Rows, d.Columns, d.BitsAllocated, d.BitsStored, d.HighBit, d.PixelRepresentation = 4, 6, 16, 16, 15, signed
        d.RescaleIntercept, d.RescaleSlope, d.RescaleType = str(intercept), "1", "HU"
        d.PixelData = ((hu[k] - intercept) & 0xFFFF).astype("<u2").tobytes(); d["PixelData"].VR = "OW"
        d.save_as(f"{form}/{k}.dcm", write_like_original=False)
PY
cat > read.py <<'PY'
import sys
import numpy as np
data = open(sys.argv[1], "rb").read()  # a NIfTI-1 file
kind = int.from_bytes(data[70:72], "little"); start, slope, offset = np.frombuffer(data[108:120], "<f4")
values = np.frombuffer(data[int(start):], {4: "<i2", 512: "<u2", 16: "<f4"}[kind]) * (slope or 1) + offset
across, down = np.frombuffer(data[80:88], "<f4"); columns, rows = np.frombuffer(data[42:46], "<i2")
print(f"{columns} columns {across:g} mm apart, {rows} rows {down:g} mm apart, values {values.min():g} .. {values.max():g}")
PY
inside python3 write.py
for form in signed unsigned; do
  inside dcm2niix -b n -z n -f "$form" -o . $form > log && echo "$form, dcm2niix: $(inside python3 read.py $form.nii)"
  inside mrconvert $form $form-m.nii 2> errors && echo "$form, mrconvert: $(inside python3 read.py $form-m.nii)"
  echo "$form, mrinfo: $(inside mrinfo -quiet -datatype $form)"; grep -i warning errors || true
done | tee seen
cat > wanted <<'T'
signed, dcm2niix: 6 columns 0.5 mm apart, 4 rows 0.75 mm apart, values -300 .. 92
signed, mrconvert: 6 columns 0.75 mm apart, 4 rows 0.5 mm apart, values 0 .. 65478
signed, mrinfo: UInt16LE
unsigned, dcm2niix: 6 columns 0.5 mm apart, 4 rows 0.75 mm apart, values -300 .. 92
unsigned, mrconvert: 6 columns 0.75 mm apart, 4 rows 0.5 mm apart, values -300 .. 92
unsigned, mrinfo: UInt16LE
T
diff wanted seen
echo "as described"
