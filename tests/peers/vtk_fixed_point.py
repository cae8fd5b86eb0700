"""VTK's fixed-point ray caster on one thread, made to show what cube3 shows.

- Values are stretched to 16 bits: of bytes its interpolation gives whole numbers alone.
- Samples begin at the camera's near plane, which is set; a step of 1/8 makes that small.
- The material's ambient part counts only with a light that has an ambient colour, and a light has none unless it is given.
- What its window shows is not what its rays gave: the rays' image is stretched by one pixel over the volume's extent and interpolated.
  So both are read: the rays' image, which is what is to be compared, and the window, also beside our picture when that is stretched.
"""

import ctypes
import ctypes.util

import numpy as np

import scene

try:
    import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401  (what the mapper draws by)
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkVersion
    from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
    from vtkmodules.vtkRenderingCore import (
        vtkColorTransferFunction,
        vtkLight,
        vtkRenderer,
        vtkVolume,
        vtkVolumeProperty,
        vtkWindowToImageFilter,
    )
    from vtkmodules.vtkRenderingOpenGL2 import vtkOSOpenGLRenderWindow
    from vtkmodules.vtkRenderingVolume import vtkFixedPointVolumeRayCastMapper
except ImportError as error:
    vtkVersion, WHY = None, error

NAME = "VTK fixed point"
# Whether shaded: both.
SHADED = (False, True)
STRETCH = 128
DISTANCE, NEAR, FAR = 500.0, 200.0, 900.0
ONE = 32767
# Its rays end where 1/128 of the light is left; below this none has.
NEARLY_OPAQUE = 250


def version():
    """What is installed."""
    if vtkVersion is None:
        raise scene.Missing(f"VTK cannot be had ({WHY}): pip install --no-deps -r tests/peers/requirements.txt; apt-get install libosmesa6 libgl1")
    if ctypes.util.find_library("OSMesa") is None:
        raise scene.Missing("VTK has no window off the screen: apt-get install libosmesa6 libgl1")
    return vtkVersion.GetVTKVersion()


def camera(renderer, shape, yaw_deg):
    eye, _, _ = scene.frame(yaw_deg)
    centre = (np.array(shape) - 1) / 2
    view = renderer.GetActiveCamera()
    view.ParallelProjectionOn()
    view.SetParallelScale(scene.PIXELS * scene.PIXEL_VOXEL / 2)
    view.SetFocalPoint(*centre)
    view.SetPosition(*(centre + DISTANCE * eye))
    view.SetViewUp(0, 0, 1)
    view.SetClippingRange(NEAR, FAR)


def mapper(voxels, step):
    image = vtkImageData()
    image.SetDimensions(*voxels.shape)
    values = voxels.astype(np.uint16) * STRETCH
    image.GetPointData().SetScalars(numpy_to_vtk(values.ravel(order="F"), deep=True))
    caster = vtkFixedPointVolumeRayCastMapper()
    caster.SetInputData(image)
    caster.SetNumberOfThreads(1)
    caster.AutoAdjustSampleDistancesOff()
    caster.LockSampleDistanceToInputSpacingOff()
    caster.SetSampleDistance(step)
    caster.SetInteractiveSampleDistance(step)
    caster.SetImageSampleDistance(1)
    return caster


def material(shaded):
    opacity, colour = vtkPiecewiseFunction(), vtkColorTransferFunction()
    for value, alpha in [[0, 0.0], *scene.OPACITY, [255, scene.OPACITY[-1][1]]]:
        opacity.AddPoint(value * STRETCH, alpha)
    colour.AddRGBPoint(0, 1, 1, 1)
    colour.AddRGBPoint(255 * STRETCH, 1, 1, 1)
    properties = vtkVolumeProperty()
    properties.SetScalarOpacity(opacity)
    properties.SetColor(colour)
    properties.SetInterpolationTypeToLinear()
    properties.SetScalarOpacityUnitDistance(1)
    properties.SetShade(shaded)
    properties.SetAmbient(scene.AMBIENT)
    properties.SetDiffuse(scene.DIFFUSE)
    properties.SetSpecular(scene.SPECULAR)
    properties.SetSpecularPower(scene.SHININESS)
    return properties


def light_at_eye():
    light = vtkLight()
    light.SetLightTypeToHeadlight()
    light.SetAmbientColor(1, 1, 1)
    return light


def image_of_rays(caster):
    """What the rays gave, 15 bits of red each; rows from the top."""
    image = caster.GetRayCastImage()
    address = int(image.GetImage().split("_")[1], 16)
    (width, height), (columns, rows) = image.GetImageInUseSize(), image.GetImageMemorySize()
    left, below = image.GetImageOrigin()
    words = (ctypes.c_uint16 * (columns * rows * 4)).from_address(address)
    texels = np.ctypeslib.as_array(words).reshape(rows, columns, 4)[:height, :width, 0]
    picture = np.zeros((scene.PIXELS, scene.PIXELS))
    picture[below : below + height, left : left + width] = texels / ONE * 255
    return picture[::-1]


def stretched(picture, caster):
    """A picture as the window shows it: from the middle of the first texel in use to the middle of the last, over as many pixels."""
    extent, origin = caster.GetRayCastImage().GetImageInUseSize(), caster.GetRayCastImage().GetImageOrigin()
    columns = slice(origin[0], origin[0] + extent[0])
    rows = slice(scene.PIXELS - origin[1] - extent[1], scene.PIXELS - origin[1])
    inner = picture[rows, columns]
    for axis, n in ((0, extent[1]), (1, extent[0])):
        at = (np.arange(n) + 0.5) * (n - 1) / n
        near = np.floor(at).astype(int)
        part = (at - near).reshape((n, 1) if axis == 0 else (1, n))
        inner = inner.take(near, axis) * (1 - part) + inner.take(near + 1, axis) * part
    shown = np.zeros_like(picture)
    shown[rows, columns] = inner
    return shown


def pictures(ours, voxels, path, yaw_deg, shaded, step, threads, folder):
    """Pairs of pictures to compare, ours and its, each with a name: rows from the top, 0 to 255. It runs on one thread."""
    caster = mapper(voxels, step)
    volume = vtkVolume()
    volume.SetMapper(caster)
    volume.SetProperty(material(shaded))
    renderer = vtkRenderer()
    renderer.SetBackground(0, 0, 0)
    renderer.AddVolume(volume)
    renderer.AddLight(light_at_eye())
    window = vtkOSOpenGLRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(scene.PIXELS, scene.PIXELS)
    window.AddRenderer(renderer)
    camera(renderer, voxels.shape, yaw_deg)
    window.Render()
    shown = vtkWindowToImageFilter()
    shown.SetInput(window)
    shown.ReadFrontBufferOff()
    shown.Update()
    bytes_shown = vtk_to_numpy(shown.GetOutput().GetPointData().GetScalars())
    on_screen = bytes_shown.reshape(scene.PIXELS, scene.PIXELS, -1)[::-1, :, 0].astype(float)
    rays, thin = image_of_rays(caster), ours < NEARLY_OPAQUE
    pairs = [("rays", ours, rays)]
    if not shaded:
        pairs.append((f"rays, below {NEARLY_OPAQUE}", ours[thin], rays[thin]))
    return [*pairs, ("window", ours, on_screen), ("window, ours stretched", stretched(ours, caster), on_screen)]
