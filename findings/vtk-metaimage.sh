#!/usr/bin/env bash
# VTK and a MetaImage whose axes are turned.
#
#     asked                                              guessed                       is (VTK 9.7.2, SimpleITK 2.5.7, Python 3.11)
#     where voxel (1, 0, 0) of an oblique .mha is        where ITK, which wrote it,    elsewhere: rows and columns of TransformMatrix
#                                                        has it                        are exchanged, error code 0
#
# Runs in a folder of its own; installs the two packages there unless PY names a Python that has them. Fails where that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
if [[ -z ${PY:-} ]]; then
    python3 -m venv venv
    venv/bin/pip install --quiet --disable-pip-version-check --no-deps numpy==2.4.6 SimpleITK==2.5.7 vtk==9.7.2
    PY=venv/bin/python
fi
cat >places.py <<'P'
import math, numpy, SimpleITK as sitk
from vtkmodules.vtkCommonCore import vtkVersion
from vtkmodules.vtkIOImage import vtkMetaImageReader

c, s = math.cos(math.radians(30)), math.sin(math.radians(30))
image = sitk.GetImageFromArray(numpy.arange(60, dtype="int16").reshape(5, 4, 3))
image.SetDirection([c, -s, 0, s, c, 0, 0, 0, 1])
sitk.WriteImage(image, "oblique.mha")
itk = sitk.ReadImage("oblique.mha").TransformIndexToPhysicalPoint([1, 0, 0])
reader = vtkMetaImageReader()
assert reader.CanReadFile("oblique.mha")
reader.SetFileName("oblique.mha")
reader.Update()
vtk = [0.0, 0.0, 0.0]
reader.GetOutput().TransformIndexToPhysicalPoint([1, 0, 0], vtk)
shown = lambda place: [round(p, 3) for p in place]
print("SimpleITK", sitk.Version.VersionString(), "and VTK", vtkVersion.GetVTKVersion())
print("voxel (1, 0, 0), ITK:", shown(itk), " VTK:", shown(vtk), " error code", reader.GetErrorCode())
assert shown(itk) == [0.866, 0.5, 0.0], "ITK has changed"
assert shown(vtk) == [0.866, -0.5, 0.0] and reader.GetErrorCode() == 0, "VTK has changed"
P
"$PY" places.py
