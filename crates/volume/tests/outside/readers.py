"""What the libraries read from a file, all told in the same words.

Each reader returns a `Reading`: three sizes, frames, spacing, the affine from stored index to RAS+ (or None where the
library says that it knows none), and the values, x fastest.
"""

import ctypes
import ctypes.util
import math
import pathlib
import re
import shutil
import subprocess
import tempfile
import warnings

import nibabel
import nrrd
import numpy
import SimpleITK as sitk
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkObject, vtkVersion
from vtkmodules.vtkIOImage import vtkMetaImageReader, vtkNIFTIImageReader

from grids import LPS

UNU = shutil.which("unu") or shutil.which("teem-unu")
sitk.ProcessObject.SetGlobalWarningDisplay(False)
vtkObject.GlobalWarningDisplayOff()
warnings.simplefilter("ignore")


def versions():
    about = subprocess.run([UNU, "--help"], capture_output=True, text=True).stdout
    return {
        "nibabel": nibabel.__version__,
        "pynrrd": nrrd.__version__,
        "ITK": f"SimpleITK {sitk.Version().VersionString().split('-')[0]}",
        "teem": re.search(r"Teem version ([\d.]+)", about).group(1),
        "VTK": vtkVersion.GetVTKVersion(),
    }


class Reading:
    """`space` is the kind of world (see grids.py), or None where the library does not tell."""

    def __init__(self, dims, frames, spacing, affine, values, space="patient", origin=None):
        self.dims = tuple(int(d) for d in dims)
        self.frames = int(frames)
        self.spacing = [float(s) for s in spacing]
        self.affine = affine
        self.values = numpy.asarray(values)
        self.space = space
        # Of the first voxel in a file whose world is unknown.
        self.origin = origin


def three(sizes, fill=1):
    return (list(sizes) + [fill] * 3)[:3]


def nibabel_reads(path):
    image = nibabel.load(path)
    shape = image.shape
    header = image.header
    known = isinstance(image, nibabel.Nifti1Pair) and (header["sform_code"] > 0 or header["qform_code"] > 0)
    data = numpy.asanyarray(image.dataobj)
    spacing = three(header.get_zooms()[:3], 1.0)
    return Reading(
        three(shape),
        math.prod(shape[3:]),
        spacing,
        image.affine if known else None,
        data.ravel(order="F"),
        "patient" if known else "unknown",
    )


def itk_reads(path):
    image = sitk.ReadImage(str(path))
    if image.GetNumberOfComponentsPerPixel() != 1:
        raise ValueError(f"{image.GetNumberOfComponentsPerPixel()} numbers for each voxel")
    axes = image.GetDimension()
    matrix = numpy.eye(4)
    used = min(axes, 3)
    direction = numpy.array(image.GetDirection()).reshape(axes, axes)[:used, :used]
    matrix[:used, :used] = direction * numpy.array(image.GetSpacing()[:used])
    matrix[:used, 3] = image.GetOrigin()[:used]
    matrix[:3] = LPS @ matrix[:3]
    size = image.GetSize()
    values = sitk.GetArrayFromImage(image).ravel()
    return Reading(three(size), math.prod(size[3:]), three(image.GetSpacing(), 1.0), matrix, values, None)


def vtk_reads(path):
    nifti = pathlib.Path(path).name.removesuffix(".gz").endswith((".nii", ".hdr", ".img"))
    # VTK writes beyond its memory, and goes down sooner or later.
    if not nifti and re.search(rb"LONG_LONG|NDims = 4", pathlib.Path(path).read_bytes()):
        raise ValueError("writes beyond its memory")
    reader = vtkNIFTIImageReader() if nifti else vtkMetaImageReader()
    if not reader.CanReadFile(str(path)):
        raise ValueError("cannot read the file")
    reader.SetFileName(str(path))
    if nifti:
        reader.TimeAsVectorOn()
    reader.Update()
    if reader.GetErrorCode():
        raise ValueError(f"error {reader.GetErrorCode()}")
    image = reader.GetOutput()
    scalars = image.GetPointData().GetScalars()
    if scalars is None:
        raise ValueError("no values")
    values = vtk_to_numpy(scalars)
    frames = values.shape[1] if values.ndim > 1 else 1
    spacing = image.GetSpacing()
    affine = numpy.eye(4)
    if nifti:
        slope, intercept = reader.GetRescaleSlope(), reader.GetRescaleIntercept()
        if math.isfinite(slope) and slope:
            values = values * slope + intercept
        form = reader.GetSFormMatrix() or reader.GetQFormMatrix()
        if form is not None:
            affine = numpy.array([[form.GetElement(r, c) for c in range(4)] for r in range(4)])
            affine[:3, :3] *= spacing
        else:
            affine = None
    else:
        matrix = image.GetDirectionMatrix()
        affine[:3, :3] = numpy.array([[matrix.GetElement(r, c) for c in range(3)] for r in range(3)]) * spacing
        affine[:3, 3] = image.GetOrigin()
        affine[:3] = LPS @ affine[:3]
    return Reading(image.GetDimensions(), frames, spacing, affine, values.ravel(order="F"), None)


# The named spaces of NRRD: the signs that lead to RAS+, or to a right-handed room.
NRRD_SPACES = {
    "right-anterior-superior": ((1, 1, 1), "patient"),
    "left-anterior-superior": ((-1, 1, 1), "patient"),
    "left-posterior-superior": ((-1, -1, 1), "patient"),
    "scanner-xyz": ((1, 1, 1), "room"),
    "3d-right-handed": ((1, 1, 1), "room"),
    "3d-left-handed": ((1, 1, -1), "room"),
}
NRRD_SHORT = {"ras": "right-anterior-superior", "las": "left-anterior-superior", "lps": "left-posterior-superior"}


def nrrd_space(name):
    """The signs of a space's axes, and what its world is."""
    name = (name or "").lower()
    name = re.sub(r"t$", "", name) if re.fullmatch(r"(ras|las|lps)t", name) else name.removesuffix("-time")
    name = NRRD_SHORT.get(name, name)
    return NRRD_SPACES.get(name, ((1, 1, 1), "unknown"))


def nrrd_reading(sizes, space, directions, origin, spacings, kinds, array):
    """A reading from an NRRD's fields; `directions` has None for an axis that is none of the world's."""
    signs, world = nrrd_space(space)
    axes = list(range(len(sizes)))
    series = [a for a in axes if kinds and kinds[a] in ("list", "time") or directions and directions[a] is None]
    series = [a for a in series if sizes[a] > 1 or len(axes) > 3] or axes[3:]
    grid = [a for a in axes if a not in series]
    array = array.transpose(grid + series)
    frames = math.prod(sizes[a] for a in series)
    matrix = numpy.eye(4)
    spacing = [1.0] * 3
    for column, axis in enumerate(grid[:3]):
        vector = numpy.zeros(3)
        if directions and directions[axis] is not None:
            given = directions[axis][:3]
            vector[: len(given)] = given
            spacing[column] = float(numpy.linalg.norm(vector))
        else:
            given = spacings[axis] if spacings else math.nan
            spacing[column] = 1.0 if math.isnan(given) or given == 0 else given
            vector[column] = spacing[column]
        matrix[:3, column] = vector
    if origin is not None:
        given = list(origin)[:3]
        matrix[: len(given), 3] = given
    matrix[:3] = numpy.diag(signs) @ matrix[:3]
    placed = matrix if world != "unknown" else None
    first = matrix[:3, 3] if origin is not None else None
    return Reading(three([sizes[a] for a in grid]), frames, spacing, placed, array.ravel(order="F"), world, first)


def pynrrd_reads(path):
    data, header = nrrd.read(str(path))
    if "axis mins" in header:
        raise ValueError("hands out axis mins as they stand")
    directions = header.get("space directions")
    if directions is not None:
        directions = [None if d is None or numpy.isnan(d).all() else list(d) for d in directions]
    return nrrd_reading(
        list(data.shape),
        header.get("space"),
        directions,
        header.get("space origin"),
        list(header["spacings"]) if "spacings" in header else None,
        header.get("kinds"),
        data,
    )


TEEM_TYPES = {
    "signed char": "i1", "unsigned char": "u1", "short": "i2", "unsigned short": "u2", "int": "i4",
    "unsigned int": "u4", "long long int": "i8", "unsigned long long int": "u8", "float": "f4", "double": "f8",
}  # fmt: skip


def unu(*arguments, cwd=None, input=None):
    done = subprocess.run([UNU, *map(str, arguments)], cwd=cwd, input=input, capture_output=True)
    if done.returncode:
        errors = [line for line in done.stderr.decode().splitlines() if line.startswith("[")]
        raise ValueError(" ".join(errors)[:300])
    return done.stdout


def teem_reads(path):
    """What teem holds after it read a file: the file that it writes then, in its simplest form."""
    text, data = unu("save", "-f", "nrrd", "-e", "raw", "-en", "little", "-i", path).split(b"\n\n", 1)
    fields = dict(re.split(r":=? ?", line, maxsplit=1) for line in text.decode().splitlines()[1:] if line[0] != "#")
    sizes = [int(s) for s in fields["sizes"].split()]
    directions = None
    if "space directions" in fields:
        words = re.findall(r"none|\([^)]*\)", fields["space directions"])
        directions = [None if w == "none" else [float(n) for n in w[1:-1].split(",")] for w in words]
    origin = None
    if "space origin" in fields:
        origin = [float(n) for n in fields["space origin"].strip("()").split(",")]
    if fields["type"] not in TEEM_TYPES:
        raise ValueError(f"type {fields['type']}")
    spacings = [float(n) for n in fields["spacings"].split()] if "spacings" in fields else None
    if "axis mins" in fields:
        positions = teem_positions(path, len(sizes))
        origin = [first for first, _ in positions]
        spacings = [second - first for first, second in positions]
    return nrrd_reading(
        sizes,
        fields.get("space"),
        directions,
        origin,
        spacings,
        fields["kinds"].split() if "kinds" in fields else None,
        numpy.frombuffer(data, "<" + TEEM_TYPES[fields["type"]]).reshape(sizes, order="F"),
    )


def teem_positions(path, axes):
    """Where teem places the first two samples of each axis of an NRRD with `axis mins`, by its own library."""
    teem = ctypes.CDLL(ctypes.util.find_library("teem") or "libteem.so.2")
    teem.nrrdNew.restype = ctypes.c_void_p
    teem.nrrdLoad.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]
    teem.nrrdNuke.argtypes = [ctypes.c_void_p]
    teem.nrrdAxisInfoPos.argtypes = [ctypes.c_void_p, ctypes.c_uint, ctypes.c_double]
    teem.nrrdAxisInfoPos.restype = ctypes.c_double
    held = teem.nrrdNew()
    if teem.nrrdLoad(held, str(path).encode(), None):
        raise ValueError("teem cannot load the file")
    found = [[teem.nrrdAxisInfoPos(held, axis, float(index)) for index in (0, 1)] for axis in range(axes)]
    teem.nrrdNuke(held)
    return found


NIFTI_READERS = {"nibabel": nibabel_reads, "ITK": itk_reads, "VTK": vtk_reads}
# VTK takes a first axis of fewer than 10 for components, and crashes where the voxels lie in several files.
NRRD_READERS = {"teem": teem_reads, "pynrrd": pynrrd_reads, "ITK": itk_reads}
METAIMAGE_READERS = {"ITK": itk_reads, "VTK": vtk_reads}


def readers_of(path):
    """The readers of a file's format, the format's own library first."""
    suffix = pathlib.Path(path).name.removesuffix(".gz").split(".")[-1]
    if suffix in ("nii", "hdr", "img"):
        return NIFTI_READERS
    return NRRD_READERS if suffix in ("nrrd", "nhdr") else METAIMAGE_READERS
