#!/usr/bin/env bash
# VTK's fixed-point ray caster: what its window shows is not what its rays gave.
#
#     asked                                              guessed                       is (VTK 9.7.2, OSMesa of Debian 12, Python 3.11)
#     a block that ends between two pixels, one ray a    black beside it               48 of 255 beside it
#     pixel: what has the pixel beside it
#     rays that give 254 and 0 in turn                   254 and 0 in turn             so in the middle, 114 and 144 near the edges
#
# The image of the rays, W×H over the volume's extent, is drawn over as many pixels, but from the middle of its first texel to the middle of its last,
# and interpolated: pixel j shows the place (j + 1/2)·(W − 1)/W, where texels are at whole numbers. So a picture is stretched about its middle, half a pixel at each
# edge, and there each pixel is the mean of two. One ray a pixel and no other scaling are asked for (SetImageSampleDistance(1)).
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
import ctypes, numpy
import vtkmodules.vtkRenderingVolumeOpenGL2
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkVersion
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkRenderingCore import vtkColorTransferFunction, vtkRenderer, vtkVolume, vtkWindowToImageFilter
from vtkmodules.vtkRenderingOpenGL2 import vtkOSOpenGLRenderWindow
from vtkmodules.vtkRenderingVolume import vtkFixedPointVolumeRayCastMapper

SIDE, SIZE = 64, 128


def pictures(voxels, pixel):
    """Opacity of the rays and red of the window, 0 to 255, along y; `pixel` voxels a pixel."""
    image = vtkImageData()
    image.SetDimensions(SIDE, SIDE, SIDE)
    image.GetPointData().SetScalars(numpy_to_vtk(voxels.ravel(order="F"), deep=True))
    mapper = vtkFixedPointVolumeRayCastMapper()
    mapper.SetInputData(image)
    mapper.SetNumberOfThreads(1)
    mapper.AutoAdjustSampleDistancesOff()
    mapper.LockSampleDistanceToInputSpacingOff()
    mapper.SetSampleDistance(0.25)
    mapper.SetImageSampleDistance(1)
    opacity, white = vtkPiecewiseFunction(), vtkColorTransferFunction()
    for value, alpha in [(0, 0), (80, 0), (100, 0.9), (255, 0.9)]:
        opacity.AddPoint(value, alpha)
    white.AddRGBPoint(0, 1, 1, 1)
    volume = vtkVolume()
    volume.SetMapper(mapper)
    properties = volume.GetProperty()
    properties.SetScalarOpacity(opacity)
    properties.SetColor(white)
    properties.SetInterpolationTypeToLinear()
    properties.ShadeOff()
    renderer, window = vtkRenderer(), vtkOSOpenGLRenderWindow()
    renderer.AddVolume(volume)
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(SIZE, SIZE)
    window.AddRenderer(renderer)
    camera, middle = renderer.GetActiveCamera(), (SIDE - 1) / 2
    camera.ParallelProjectionOn()
    camera.SetParallelScale(SIZE * pixel / 2)
    camera.SetFocalPoint(middle, middle, middle)
    camera.SetPosition(middle, middle - 200, middle)
    camera.SetViewUp(0, 0, 1)
    camera.SetClippingRange(100, 300)
    window.Render()
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    grab.Update()
    shown = vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).reshape(SIZE, SIZE, -1)[:, :, 0].astype(float)
    rays = mapper.GetRayCastImage()
    (w, h), (columns, rows), (left, below) = rays.GetImageInUseSize(), rays.GetImageMemorySize(), rays.GetImageOrigin()
    words = (ctypes.c_uint16 * (columns * rows * 4)).from_address(int(rays.GetImage().split("_")[1], 16))
    given = numpy.ctypeslib.as_array(words).reshape(rows, columns, 4)[:h, :w, 3] / 32767 * 255
    return given, shown[below : below + h, left : left + w]


def stretched(given):
    """From the middle of the first texel to that of the last."""
    for axis in (0, 1):
        n = given.shape[axis]
        at = (numpy.arange(n) + 0.5) * (n - 1) / n
        near = numpy.floor(at).astype(int)
        part = (at - near).reshape((n, 1) if axis == 0 else (1, n))
        given = given.take(near, axis) * (1 - part) + given.take(near + 1, axis) * part
    return given


print("VTK", vtkVersion.GetVTKVersion())
block = numpy.zeros((SIDE,) * 3, numpy.uint8)
block[20:44, 20:44, 20:44] = 200
given, shown = pictures(block, 0.75)
row = given.shape[0] // 2
edge = int(numpy.argmax(given[row] > 100))
print("a block's left edge, rays:  ", given[row, edge - 2 : edge + 2].round().tolist())
print("the same, window:           ", shown[row, edge - 2 : edge + 2].tolist())
assert given[row, edge - 1] == 0 and 40 < shown[row, edge - 1] < 56, "that has changed"
assert abs(stretched(given) - shown).max() < 2, "that has changed"
# Sheets two voxels apart, a pixel each: every other ray meets one.
sheets = numpy.zeros((SIDE,) * 3, numpy.uint8)
sheets[0::2, 20:44, :] = 200
given, shown = pictures(sheets, 1.0)
row, w = given.shape[0] // 2, given.shape[1]
for what, picture in [("rays:  ", given), ("window:", shown)]:
    edge, middle = picture[row, 3:7].round().tolist(), picture[row, w // 2 - 2 : w // 2 + 2].round().tolist()
    print(f"sheets, {w} rays, {what} near the edge {edge}, in the middle {middle}")
assert set(given[row, 3:7].round()) == {0, 254}, "that has changed"
assert numpy.ptp(shown[row, 3:7]) < 80 and numpy.ptp(shown[row, w // 2 - 2 : w // 2 + 2]) > 230, "that has changed"
assert abs(stretched(given) - shown).max() < 2, "that has changed"
P
"$PY" ask.py
