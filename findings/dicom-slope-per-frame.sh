#!/usr/bin/env bash
# Of an enhanced CT whose frames have their own RescaleSlope, dcm2niix takes the last one for all frames and GDCM the first one, silently.
# Version: dcm2niix 1.0.20220720, GDCM 3.0.21 (python3-gdcm); beside them vtk-dicom 0.8.14, which reads it as it should (Debian 12).
# Seen, for an enhanced CT of 4 frames, -200 .. 295 HU in each, stored as HU * 1, 2, 4, 5 with RescaleSlope 1, 0.5, 0.25, 0.2:
#   vtk-dicom's dicomtonifti   -200 .. 295 in all frames
#   dcm2niix                   -40 .. 59, -80 .. 118, -160 .. 236, -200 .. 295: all frames times 0.2
#   GDCM, GetSlope()           1 for the whole: -200 .. 295, -400 .. 590, -800 .. 1180, -1000 .. 1475
#   the same as 4 files        dcm2niix and GDCM give -200 .. 295 in all four (dcm2niix as floats)
# No warning on it, exit code 0. DICOM PS3.3, C.8.15.3.10 (CT pixel value transformation) and C.7.6.16: what is not the same for all frames
# stands in the functional groups of each frame, so that each may have its own slope and intercept.
# Why it hurts: soft tissue of one slice has the CT numbers of bone in another, or bone those of fat; steps from slice to slice look like
# metal or end plates. The classic series of the same scanner, one file a slice, is right in the same two programs.
# Seen on 2026-11-28. Needs Debian 12 (amd64) with root and apt. Exit 0: as described; else changed or (2, 3) not these versions.
set -euo pipefail
packages=(dcm2niix=1.0.20220720-1+deb12u1 python3-gdcm=3.0.21-1 vtk-dicom-tools=0.8.14-3.1 python3-pydicom=2.3.1-1
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
import os
import numpy as np
from pydicom.dataset import Dataset, FileMetaDataset
from pydicom.sequence import Sequence
from pydicom.uid import ExplicitVRLittleEndian
hu = -200 + 5 * np.arange(100).reshape(10, 10)
factors = (1, 2, 4, 5)
def item(**elements):
    d = Dataset()
    for name, value in elements.items():
        setattr(d, name, value)
    return d
def image(uid, sop_class):
    d = Dataset(); d.file_meta = FileMetaDataset(); d.is_little_endian = True; d.is_implicit_VR = False
    d.SOPClassUID = d.file_meta.MediaStorageSOPClassUID = sop_class
    d.SOPInstanceUID = d.file_meta.MediaStorageSOPInstanceUID = uid + ".1"
    d.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian; d.file_meta.ImplementationClassUID = "2.25.8154"
    d.ImageType = ["DERIVED", "PRIMARY", "VOLUME", "NONE"]; d.Modality = "CT"; d.Manufacturer = "none"
    d.PatientName = "A^B"; d.PatientID = "1"
    d.PatientBirthDate = d.PatientSex = d.AccessionNumber = d.ReferringPhysicianName = d.PositionReferenceIndicator = d.Laterality = ""
    d.StudyDate = d.SeriesDate = d.ContentDate = "20260101"; d.StudyTime = d.SeriesTime = d.ContentTime = "120000"
    d.StudyID = d.SeriesNumber = d.AcquisitionNumber = d.InstanceNumber = "1"; d.PatientPosition = "HFS"
    d.SamplesPerPixel = 1; d.PhotometricInterpretation = "MONOCHROME2"
    d.Rows, d.Columns, d.BitsAllocated, d.BitsStored, d.HighBit, d.PixelRepresentation = 10, 10, 16, 16, 15, 1
    return d
def pixels(d, stored):
    d.PixelData = stored.astype("<i2").tobytes(); d["PixelData"].VR = "OW"
os.makedirs("classic"); os.makedirs("enhanced")
for k, factor in enumerate(factors):
    d = image(f"2.25.8154.1.{k + 1}", "1.2.840.10008.5.1.4.1.1.2")
    d.StudyInstanceUID, d.SeriesInstanceUID, d.FrameOfReferenceUID = "2.25.8154.1.7", "2.25.8154.1.8", "2.25.8154.1.9"
    d.ImageType = ["ORIGINAL", "PRIMARY", "AXIAL"]; d.KVP = "120"; d.InstanceNumber = str(k + 1); d.SliceThickness = "1"
    d.PixelSpacing = ["0.5", "0.5"]; d.ImageOrientationPatient = ["1", "0", "0", "0", "1", "0"]; d.ImagePositionPatient = ["0", "0", str(k)]
    d.RescaleIntercept, d.RescaleSlope, d.RescaleType = "0", f"{1 / factor:g}", "HU"
    pixels(d, hu * factor)
    d.save_as(f"classic/{k}.dcm", write_like_original=False)
d = image("2.25.8154.2.1", "1.2.840.10008.5.1.4.1.1.2.1")
d.StudyInstanceUID, d.SeriesInstanceUID, d.FrameOfReferenceUID = "2.25.8154.2.7", "2.25.8154.2.8", "2.25.8154.2.9"
del d.Laterality
d.AcquisitionContextSequence = Sequence(); d.NumberOfFrames = "4"; d.AcquisitionDateTime = "20260101120000"
d.PresentationLUTShape = "IDENTITY"; d.BurnedInAnnotation = "NO"
d.LossyImageCompression = "00"; d.PixelPresentation = "MONOCHROME"; d.VolumetricProperties = "VOLUME"
d.VolumeBasedCalculationTechnique = "NONE"; d.ContentQualification = "PRODUCT"
d.ManufacturerModelName = d.DeviceSerialNumber = d.SoftwareVersions = "none"
d.DimensionOrganizationSequence = Sequence([item(DimensionOrganizationUID="2.25.8154.2.6")])
d.DimensionIndexSequence = Sequence([item(
    DimensionIndexPointer=p, FunctionalGroupPointer=0x00209111, DimensionOrganizationUID="2.25.8154.2.6")
    for p in (0x00209056, 0x00209057)])
d.SharedFunctionalGroupsSequence = Sequence([item(
    PixelMeasuresSequence=Sequence([item(PixelSpacing=["0.5", "0.5"], SliceThickness="1")]),
    PlaneOrientationSequence=Sequence([item(ImageOrientationPatient=["1", "0", "0", "0", "1", "0"])]),
    FrameAnatomySequence=Sequence([item(FrameLaterality="U", AnatomicRegionSequence=Sequence([item(
        CodeValue="421060004", CodingSchemeDesignator="SCT", CodeMeaning="Vertebral column")]))]),
    IrradiationEventIdentificationSequence=Sequence([item(IrradiationEventUID="2.25.8154.2.5")]),
    CTImageFrameTypeSequence=Sequence([item(FrameType=list(d.ImageType), PixelPresentation="MONOCHROME", VolumetricProperties="VOLUME",
                                            VolumeBasedCalculationTechnique="NONE")]))])
d.PerFrameFunctionalGroupsSequence = Sequence([item(
    FrameContentSequence=Sequence([item(StackID="1", InStackPositionNumber=k + 1, DimensionIndexValues=[1, k + 1])]),
    PlanePositionSequence=Sequence([item(ImagePositionPatient=["0", "0", str(k)])]),
    PixelValueTransformationSequence=Sequence([item(RescaleIntercept="0", RescaleSlope=f"{1 / f:g}", RescaleType="HU")]))
    for k, f in enumerate(factors)])
pixels(d, np.stack([hu * f for f in factors]))
d.save_as("enhanced/0.dcm", write_like_original=False)
PY
cat > read.py <<'PY'
import glob, sys
import numpy as np
how, path = sys.argv[1:]
frames = []
if how == "gdcm":
    import gdcm
    for file in sorted(glob.glob(path + "/*.dcm")):
        reader = gdcm.ImageReader(); reader.SetFileName(file); assert reader.Read()
        image = reader.GetImage(); values = np.frombuffer(image.GetBuffer().encode("utf-8", "surrogateescape"), "<i2")
        frames.extend((values * image.GetSlope() + image.GetIntercept()).reshape(-1, 100))
else:  # a NIfTI-1 file
    data = open(path, "rb").read(); kind = int.from_bytes(data[70:72], "little"); start, slope, offset = np.frombuffer(data[108:120], "<f4")
    values = np.frombuffer(data[int(start):], {4: "<i2", 8: "<i4", 16: "<f4", 512: "<u2"}[kind]) * (slope or 1) + offset
    frames = values.reshape(-1, 100)
print(", ".join(f"{round(float(f.min()), 2):g} .. {round(float(f.max()), 2):g}" for f in frames))
PY
inside python3 write.py
for form in classic enhanced; do
  inside dicomtonifti --silent -o $form-v.nii $form > log 2>&1 && echo "$form, vtk-dicom: $(inside python3 read.py nifti $form-v.nii)"
  inside dcm2niix -b n -z n -f $form -o . $form > log && echo "$form, dcm2niix: $(inside python3 read.py nifti $form.nii)"
  grep -iE 'slope|scale|intensit' log || true
  echo "$form, GDCM: $(inside python3 read.py gdcm $form)"
done | tee seen
cat > wanted <<'T'
classic, vtk-dicom: -200 .. 295, -200 .. 295, -200 .. 295, -200 .. 295
classic, dcm2niix: -200 .. 295, -200 .. 295, -200 .. 295, -200 .. 295
Saving as 32-bit float (slope, intercept or bits allocated varies).
classic, GDCM: -200 .. 295, -200 .. 295, -200 .. 295, -200 .. 295
enhanced, vtk-dicom: -200 .. 295, -200 .. 295, -200 .. 295, -200 .. 295
enhanced, dcm2niix: -40 .. 59, -80 .. 118, -160 .. 236, -200 .. 295
enhanced, GDCM: -200 .. 295, -400 .. 590, -800 .. 1180, -1000 .. 1475
T
diff wanted seen
echo "as described"
