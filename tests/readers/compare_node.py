"""compare_node.py MAP.nii.gz SEG.dcm FOUND.json: what read_with_node.mjs found, beside the NIfTI map."""
import json
import sys

import nibabel
import numpy as np

LEVELS = ["", *(f"C{n}" for n in range(1, 8)), *(f"T{n}" for n in range(1, 13)), *(f"L{n}" for n in range(1, 7)), "sacrum"]


def dice(a, b):
    return 2.0 * np.count_nonzero(a & b) / (np.count_nonzero(a) + np.count_nonzero(b))


def main():
    image = nibabel.load(sys.argv[1])
    labels = np.asarray(image.dataobj)
    lps = np.diag([-1.0, -1.0, 1.0, 1.0]) @ image.affine
    with open(sys.argv[3], encoding="utf-8") as file:
        found = json.load(file)
    is_good = True
    for n in np.unique(labels)[1:]:
        name = LEVELS[int(n)]
        mask = labels == n
        wrong = 0
        for position, count, place in found["dcmjs"][name]:
            k = int(np.rint((np.linalg.inv(lps) @ [*position, 1.0])[2]))
            # Rows one after the other, as frames have them.
            at = np.flatnonzero(mask[:, :, k].T.ravel())
            wrong += count != len(at) or place != at.sum()
        slices = np.count_nonzero(mask.any(axis=(0, 1)))
        is_good &= wrong == 0 and len(found["dcmjs"][name]) == slices
        print(f"dcmjs, SEG, {name}: {slices} slices, {wrong} other than ours")
    itk = found["itk"]
    if "error" in itk:
        print("itk-wasm:", itk["error"])
        return 1
    values = np.zeros(int(np.prod(itk["size"])), int)
    for at, value in itk["voxels"]:
        values[at] = value
    values = values.reshape(itk["size"], order="F")
    offset = np.rint((np.linalg.inv(lps) @ [*itk["origin"], 1.0])[:3]).astype(int)
    for n in np.unique(labels)[1:]:
        name = LEVELS[int(n)]
        number = [int(i) for i, label in itk["names"].items() if label == name]
        mask = np.zeros(labels.shape, bool)
        at = np.argwhere(np.isin(values, number)) + offset
        mask[tuple(at.T)] = True
        index = dice(labels == n, mask)
        is_good &= index == 1.0
        print(f"itk-wasm (dcmqi), SEG, {name}: Dice {index:.6f}")
    return 0 if is_good else 1


sys.exit(main())
