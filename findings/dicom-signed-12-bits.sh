#!/usr/bin/env bash
# Signed CT numbers in 12 of 16 bits lose their sign in dcm2niix, pydicom and plastimatch: -300 HU is read as 3796 HU, silently.
# Version: dcm2niix 1.0.20220720, pydicom 2.3.1, plastimatch 1.9.4; beside them GDCM 3.0.21, which reads all as it should be (Debian 12).
# Seen, for CT slices with -1000, -300, 0, 40 and 700 HU, PixelRepresentation 1, BitsAllocated 16, BitsStored 12, HighBit 11, slope 1:
#   the four bits above the sign      0                    1 of negative values     other (0xA)
#   GDCM                              right                right                    right
#   dcm2niix                          3096, 3796, 0 ...    3096, 3796, 0 ...        3096, 3796, 0 ...
#   pydicom's pixel_array, plastimatch  3096, 3796, 0 ...  right                    numbers near -21000
# No exception, no message on it, exit code 0. DICOM PS3.5, 8.1.1: a sample cell's sign bit is its high bit (bit 11 here), and what lies
# in bits that are not stored is not to be relied on (annex D shows such cells).
# Why it hurts: air and fat become denser than any cortical bone, 0 and more stay right; a threshold at 200 HU then makes a bone of all
# air, lung and fat. A phantom without negative values, or a scanner with unsigned values, never shows it.
# Seen on 2026-11-28. Needs Debian 12 (amd64) with root and apt. Exit 0: as described; else changed or (2, 3) not these versions.
set -euo pipefail
packages=(dcm2niix=1.0.20220720-1+deb12u1 plastimatch=1.9.4+dfsg.2-0+deb12u1 python3-pydicom=2.3.1-1 python3-gdcm=3.0.21-1
  python3-numpy=1:1.24.2-1+deb12u1)
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
import os, sys
import numpy as np
from pydicom.dataset import Dataset, FileMetaDataset
from pydicom.uid import ExplicitVRLittleEndian
hu = np.tile(np.array([-1000, -300, 0, 40, 700]), (4, 1))
forms = {"zero": hu & 0xFFF, "copied": hu & 0xFFFF, "other": (hu & 0xFFF) | 0xA000}
for number, (form, stored) in enumerate(forms.items()):
    os.makedirs(form)
    for k in range(3):
        uid = lambda *parts: "2.25.8151." + ".".join(str(p) for p in (number + 1,) + parts)
        d = Dataset(); d.file_meta = FileMetaDataset(); d.is_little_endian = True; d.is_implicit_VR = False
        d.SOPClassUID = d.file_meta.MediaStorageSOPClassUID = "1.2.840.10008.5.1.4.1.1.2"
        d.SOPInstanceUID = d.file_meta.MediaStorageSOPInstanceUID = uid(1, k + 1)
        d.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian; d.file_meta.ImplementationClassUID = "2.25.8151"
        d.StudyInstanceUID, d.SeriesInstanceUID, d.FrameOfReferenceUID = uid(2), uid(3), uid(4)
        d.ImageType = ["ORIGINAL", "PRIMARY", "AXIAL"]; d.Modality = "CT"; d.Manufacturer = "none"; d.PatientName = "A^B"; d.PatientID = "1"
        d.PatientBirthDate = d.PatientSex = d.AccessionNumber = d.ReferringPhysicianName = d.PositionReferenceIndicator = d.Laterality = ""
        d.StudyDate = d.SeriesDate = d.ContentDate = "20260101"; d.StudyTime = d.SeriesTime = d.ContentTime = "120000"
        d.StudyID = d.SeriesNumber = d.AcquisitionNumber = "1"; d.InstanceNumber = str(k + 1); d.PatientPosition = "HFS"; d.KVP = "120"
        d.SliceThickness = "1"; d.PixelSpacing = ["0.5", "0.5"]; d.ImageOrientationPatient = ["1", "0", "0", "0", "1", "0"]
        d.ImagePositionPatient = ["0", "0", str(k)]; d.SamplesPerPixel = 1; d.PhotometricInterpretation = "MONOCHROME2"
        d.Rows, d.Columns, d.BitsAllocated, d.BitsStored, d.HighBit, d.PixelRepresentation = 4, 5, 16, 12, 11, 1
        d.RescaleIntercept, d.RescaleSlope, d.RescaleType = "0", "1", "HU"
        d.PixelData = stored.astype("<u2").tobytes(); d["PixelData"].VR = "OW"
        d.save_as(f"{form}/{k}.dcm", write_like_original=False)
PY
cat > read.py <<'PY'
import sys
import numpy as np
how, path = sys.argv[1:]
if how == "pydicom":
    import pydicom
    values = pydicom.dcmread(path + "/0.dcm").pixel_array
elif how == "gdcm":
    import gdcm
    reader = gdcm.ImageReader(); reader.SetFileName(path + "/0.dcm"); assert reader.Read()
    values = np.frombuffer(reader.GetImage().GetBuffer().encode("utf-8", "surrogateescape"), "<i2")
else:  # a NIfTI-1 file
    data = open(path, "rb").read(); kind = int.from_bytes(data[70:72], "little"); start, slope, offset = np.frombuffer(data[108:120], "<f4")
    values = np.frombuffer(data[int(start):], {4: "<i2", 8: "<i4", 16: "<f4", 512: "<u2"}[kind]) * (slope or 1) + offset
print(" ".join(str(int(v)) for v in sorted(set(values.reshape(-1).tolist()))))
PY
inside python3 write.py
for form in zero copied other; do
  echo "$form, GDCM: $(inside python3 read.py gdcm $form)"
  inside dcm2niix -b n -z n -f "$form" -o . $form > "$form.txt" && echo "$form, dcm2niix: $(inside python3 read.py nifti $form.nii)"
  grep -iE 'sign|bits|range|error' "$form.txt" || true
  echo "$form, pydicom: $(inside python3 read.py pydicom $form)"
  inside plastimatch convert --input $form --output-img $form-p.nii > "$form-p.txt" 2>&1 &&
    echo "$form, plastimatch: $(inside python3 read.py nifti $form-p.nii)"
  grep -iE 'warn|bits|range|error' "$form-p.txt" || true
done | tee seen
cat > wanted <<'T'
zero, GDCM: -1000 -300 0 40 700
zero, dcm2niix: 0 40 700 3096 3796
zero, pydicom: 0 40 700 3096 3796
zero, plastimatch: 0 40 700 3096 3796
copied, GDCM: -1000 -300 0 40 700
copied, dcm2niix: 0 40 700 3096 3796
copied, pydicom: -1000 -300 0 40 700
copied, plastimatch: -1000 -300 0 40 700
other, GDCM: -1000 -300 0 40 700
other, dcm2niix: 0 40 700 3096 3796
other, pydicom: -24576 -24536 -23876 -21480 -20780
other, plastimatch: -24576 -24536 -23876 -21480 -20780
T
diff wanted seen
echo "as described"
