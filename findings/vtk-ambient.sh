#!/usr/bin/env bash
# VTK's ambient part of a shaded volume.
#
#     asked                                              guessed                       is (VTK 9.7.2, OSMesa of Debian 12, Python 3.11)
#     fixed-point ray caster, opaque white block,        255, as a surface has with    0: ambient counts times the ambient colour of the lights, and a
#     ambient 1, diffuse 0, the renderer's own light     the same material and light   light's is black; the renderer's own (white) has no part in it
#     the same, light.SetAmbientColor(1, 1, 1)           the same                      255
#     a surface, ambient 1, either light                 255                           255 and 255
#
# Runs in a folder of its own; installs the two packages there unless PY names a Python that has them. The system must have libosmesa6 and libgl1
# (apt-get install libosmesa6 libgl1). Fails where that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
if [[ -z ${PY:-} ]]; then
    python3 -m venv venv
    venv/bin/pip install --quiet --disable-pip-version-check --no-deps numpy==2.4.6 vtk==9.7.2
    PY=venv/bin/python
fi
cat >ask.py <<'P'
import numpy
import vtkmodules.vtkRenderingVolumeOpenGL2
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkVersion
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkFiltersSources import vtkCubeSource
from vtkmodules.vtkRenderingCore import vtkActor, vtkColorTransferFunction, vtkLight, vtkPolyDataMapper, vtkRenderer, vtkVolume
from vtkmodules.vtkRenderingCore import vtkWindowToImageFilter
from vtkmodules.vtkRenderingOpenGL2 import vtkOSOpenGLRenderWindow
from vtkmodules.vtkRenderingVolume import vtkFixedPointVolumeRayCastMapper

SIDE, SIZE = 32, 64


def block():
    voxels = numpy.zeros((SIDE,) * 3, numpy.uint8)
    voxels[8:24, 8:24, 8:24] = 200
    image = vtkImageData()
    image.SetDimensions(SIDE, SIDE, SIDE)
    image.GetPointData().SetScalars(numpy_to_vtk(voxels.ravel(), deep=True))
    mapper, volume = vtkFixedPointVolumeRayCastMapper(), vtkVolume()
    mapper.SetInputData(image)
    mapper.SetNumberOfThreads(1)
    opacity, white = vtkPiecewiseFunction(), vtkColorTransferFunction()
    for value, alpha in [(0, 0), (80, 0), (100, 0.9), (255, 0.9)]:
        opacity.AddPoint(value, alpha)
    white.AddRGBPoint(0, 1, 1, 1)
    volume.SetMapper(mapper)
    properties = volume.GetProperty()
    properties.SetScalarOpacity(opacity)
    properties.SetColor(white)
    properties.SetInterpolationTypeToLinear()
    properties.ShadeOn()
    return volume


def surface():
    cube, mapper, actor = vtkCubeSource(), vtkPolyDataMapper(), vtkActor()
    cube.SetBounds(8, 24, 8, 24, 8, 24)
    mapper.SetInputConnection(cube.GetOutputPort())
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(1, 1, 1)
    return actor


def middle(prop, lamp_colour):
    """The pixel in the middle of its picture."""
    prop.GetProperty().SetAmbient(1)
    prop.GetProperty().SetDiffuse(0)
    prop.GetProperty().SetSpecular(0)
    renderer, window = vtkRenderer(), vtkOSOpenGLRenderWindow()
    renderer.AddViewProp(prop)
    if lamp_colour:
        light = vtkLight()
        light.SetLightTypeToHeadlight()
        light.SetAmbientColor(*lamp_colour)
        renderer.AddLight(light)
    window.SetOffScreenRendering(1)
    window.SetSize(SIZE, SIZE)
    window.AddRenderer(renderer)
    camera = renderer.GetActiveCamera()
    camera.ParallelProjectionOn()
    camera.SetParallelScale(SIDE / 2)
    camera.SetFocalPoint(15.5, 15.5, 15.5)
    camera.SetPosition(15.5, -100, 15.5)
    camera.SetViewUp(0, 0, 1)
    camera.SetClippingRange(50, 200)
    window.Render()
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    grab.Update()
    pixels = vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).reshape(SIZE, SIZE, -1)
    return int(pixels[SIZE // 2, SIZE // 2, 0]), renderer.GetAmbient(), renderer.GetLights().GetNumberOfItems()


print("VTK", vtkVersion.GetVTKVersion())
for name, prop, lamp, low, high in [
    ("volume, the renderer's own light", block(), None, 0, 0),
    ("volume, a light of ambient colour white", block(), (1, 1, 1), 250, 255),
    ("surface, the renderer's own light", surface(), None, 255, 255),
    ("surface, a light of ambient colour white", surface(), (1, 1, 1), 255, 255),
]:
    got, ambient, lights = middle(prop, lamp)
    print(f"{name}: {got} (renderer's ambient {ambient}, {lights} light)")
    assert low <= got <= high, "that has changed"
P
"$PY" ask.py
