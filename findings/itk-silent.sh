#!/usr/bin/env bash
# ITK reads two valid files without a word, and not what is in them.
#
#     asked                                              guessed                       is (SimpleITK 2.5.7 with ITK 5.4, Python 3.11)
#     NaN and infinity in a NIfTI of reals               NaN and infinity              0 and 0; the same values in an NRRD are kept
#     NRRD in the space right-anterior-superior-time     where the same file in        turned by 180 degrees about z: the coordinates of
#                                                        left-posterior-superior-time  RAS are taken for those of LPS
#                                                        has it
#
# Runs in a folder of its own; installs the packages there unless PY names a Python that has them. Fails where that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
if [[ -z ${PY:-} ]]; then
    python3 -m venv venv
    venv/bin/pip install --quiet --disable-pip-version-check --no-deps numpy==2.4.6 SimpleITK==2.5.7
    PY=venv/bin/python
fi
cat >ask.py <<'P'
import math, struct, numpy, SimpleITK as sitk

numbers = numpy.array([1, math.nan, math.inf, 2], "<f4")
header = bytearray(352)
struct.pack_into("<i", header, 0, 348)
struct.pack_into("<8h", header, 40, 3, 4, 1, 1, 1, 1, 1, 1)
struct.pack_into("<hh", header, 70, 16, 32)
struct.pack_into("<8f", header, 76, *[1] * 8)
struct.pack_into("<ff", header, 108, 352, 1)
header[344:348] = b"n+1\0"
open("nan.nii", "wb").write(bytes(header) + numbers.tobytes())
start = b"NRRD0004\ntype: float\ndimension: 3\nsizes: 4 1 1\nendian: little\nencoding: raw\n\n"
open("nan.nrrd", "wb").write(start + numbers.tobytes())
for name in ("nan.nrrd", "nan.nii"):
    read = sitk.GetArrayFromImage(sitk.ReadImage(name)).ravel()
    print(f"{name}: written {numbers.tolist()}, read {read.tolist()}")
    assert numpy.isfinite(read).all() == (name == "nan.nii"), "that has changed"

# One place, in two ways of counting.
for space, first, origin in [
    ("left-posterior-superior-time", "(1,0,0,0) (0,1,0,0)", "(10,20,30,0)"),
    ("right-anterior-superior-time", "(-1,0,0,0) (0,-1,0,0)", "(-10,-20,30,0)"),
]:
    lines = ["NRRD0004", "type: uchar", "dimension: 4", f"space: {space}", "sizes: 2 2 2 2", "encoding: raw"]
    lines += [f"space directions: {first} (0,0,1,0) (0,0,0,1)", f"space origin: {origin}"]
    lines += ["kinds: space space space time", "", ""]
    open("timed.nrrd", "wb").write("\n".join(lines).encode() + bytes(range(16)))
    image = sitk.ReadImage("timed.nrrd")
    place = image.TransformIndexToPhysicalPoint([1, 0, 0, 0])[:3]
    print(f"{space}: voxel (1, 0, 0, 0) is read at {place}")
    assert place[0] == (11 if space.startswith("left") else -11), "that has changed"
P
"$PY" ask.py
