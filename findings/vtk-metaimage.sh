#!/usr/bin/env bash
# VTK and a MetaImage whose axes are turned, has 64-bit integers, or has four axes.
#
#     asked                                              guessed                       is (VTK 9.7.2, SimpleITK 2.5.7, Python 3.11)
#     where voxel (1, 0, 0) of an oblique .mha is        where ITK, which wrote it,    elsewhere: rows and columns of TransformMatrix
#                                                        has it                        are exchanged, error code 0
#     reading a valid .mha of 64-bit integers            numbers, or an error          an error line, then writes beyond its memory
#     reading a valid .mha of four axes                  the first volume, or an       writes beyond its memory
#                                                        error
#
# Runs in a folder of its own; installs the two packages there unless PY names a Python that has them.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
if [[ -z ${PY:-} ]]; then
    python3 -m venv venv
    venv/bin/pip install --quiet --disable-pip-version-check --no-deps numpy==2.4.6 SimpleITK==2.5.7 vtk==9.7.2
    PY=venv/bin/python
fi
cat >write.py <<'P'
import math, numpy, SimpleITK as sitk
c, s = math.cos(math.radians(30)), math.sin(math.radians(30))
image = sitk.GetImageFromArray(numpy.arange(60, dtype="int16").reshape(5, 4, 3))
image.SetDirection([c, -s, 0, s, c, 0, 0, 0, 1])
sitk.WriteImage(image, "oblique.mha")
sitk.WriteImage(sitk.Cast(image, sitk.sitkInt64), "long.mha")
sitk.WriteImage(sitk.JoinSeries([image] * 8), "series.mha")
P
cat >read.py <<'P'
import sys
from vtkmodules.vtkIOImage import vtkMetaImageReader
for time in range(int(sys.argv[2])):
    reader = vtkMetaImageReader()
    assert reader.CanReadFile(sys.argv[1])
    reader.SetFileName(sys.argv[1])
    reader.Update()
place = [0.0, 0.0, 0.0]
reader.GetOutput().TransformIndexToPhysicalPoint([1, 0, 0], place)
print([round(p, 3) for p in place], "error code", reader.GetErrorCode())
P
"$PY" write.py
grep -a TransformMatrix oblique.mha
echo "ITK:  $("$PY" -c 'import SimpleITK as s; print([round(p, 3) for p in s.ReadImage("oblique.mha").TransformIndexToPhysicalPoint([1, 0, 0])])')"
echo "VTK:  $("$PY" read.py oblique.mha 1)"
for file in long series; do
    code=0
    "$PY" read.py $file.mha 200 >said 2>&1 || code=$?
    echo "VTK, $file.mha read 200 times: exit code $code, $(grep -aoE 'malloc.*|free\(\).*|corrupted.*|munmap.*|Unknown data type: [0-9]+|Segmentation.*' said | sort | uniq -c | tail -1 | tr -s ' ')"
done
