"""Grids whose place in the world and whose values are known, for the files that other programs write.

A grid's world is one of
    patient  x to the right, y to the front, z to the head (RAS+), in mm
    room     a right-handed coordinate system that is no patient's
    unknown  the file does not say: spacing and order of the file's own axes
"""

import itertools
import math

import numpy

TYPES = ["int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64"]
SIZES = [(3, 4, 5), (5, 3, 4), (4, 5, 3), (6, 2, 5), (2, 7, 3)]
SPACINGS = [(0.75, 1.25, 2.5), (1.5, 0.5, 0.875), (3.0, 0.625, 1.0)]
ORIGINS = [(-3.5, 10.25, 7.0), (120.5, -80.25, 33.0), (0.0, 0.0, -1024.0)]
LPS = numpy.diag([-1.0, -1.0, 1.0])


def _signed_permutations():
    for order in itertools.permutations(range(3)):
        for signs in itertools.product((1.0, -1.0), repeat=3):
            matrix = numpy.zeros((3, 3))
            for axis in range(3):
                matrix[order[axis], axis] = signs[axis]
            yield matrix


# Column a is the world direction of the stored axis a.
SIGNED_PERMUTATIONS = list(_signed_permutations())


def rotation(axis, degrees):
    """The rotation about an axis, by Rodrigues' formula."""
    x, y, z = numpy.array(axis) / math.hypot(*axis)
    k = numpy.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = math.radians(degrees)
    return numpy.eye(3) + math.sin(angle) * k + (1 - math.cos(angle)) * k @ k


OBLIQUE = rotation((1, 2, 3), 25)
# A gantry tilted by 15 degrees: slices stay upright, their stack leans.
TILTED = numpy.array([[1, 0, 0], [0, 1, math.sin(math.radians(15))], [0, 0, math.cos(math.radians(15))]])


def values(name, count, wide=False):
    """`count` values of a numpy type, spread over its range; `wide`: beyond 32 bits."""
    index = numpy.arange(count, dtype=object)
    if name in ("float32", "float64"):
        return ((index * 7919) % 10007 / 7 - 500).astype(name)
    if name in ("int64", "uint64"):
        low = 0 if name == "uint64" else -(2**31)
        result = (index * 2654435761) % (2**32 - 5) + low
        return (result + (2**40 if wide else 0)).astype(name)
    info = numpy.iinfo(name)
    modulus = {8: 251, 16: 65521, 32: 2**32 - 5}[info.bits]
    return ((index * 2654435761 + 11) % modulus + int(info.min)).astype(name)


class Grid:
    """What a file holds: three sizes, a place in the world, frames, values (x fastest, frame after frame)."""

    def __init__(self, n=0, dtype="int16", frames=1, dims=None, turn=None, spacing=None, origin=None, wide=False):
        self.dims = tuple(dims or SIZES[n % len(SIZES)])
        self.frames = frames
        self.space = "patient"
        self.spacing = numpy.array(spacing or SPACINGS[n % len(SPACINGS)], float)
        self.origin = numpy.array(origin or ORIGINS[n % len(ORIGINS)], float)
        self.directions = SIGNED_PERMUTATIONS[n % 48] if turn is None else numpy.array(turn, float)
        self.values = values(dtype, math.prod(self.dims) * frames, wide)
        # Whether the origin of an unknown world is given by the format.
        self.placed = True

    def of_room(self):
        self.space = "room"
        return self

    def unplaced(self, origin=None):
        """The same grid in a file that says nothing of the world but the spacing."""
        self.space = "unknown"
        self.directions = numpy.eye(3)
        self.placed = origin is not None
        self.origin = numpy.array(origin if self.placed else (0, 0, 0), float)
        return self

    @property
    def affine(self):
        """Stored index to world, 4 x 4."""
        matrix = numpy.eye(4)
        matrix[:3, :3] = self.directions * self.spacing
        matrix[:3, 3] = self.origin
        return matrix

    @property
    def lps(self):
        """Directions and origin as DICOM, ITK and MetaImage count: x to the left, y to the back."""
        return LPS @ self.directions, LPS @ self.origin

    def array(self, axes=3):
        """The values with the first index fastest, as arrays of x, y, z (and frame)."""
        shape = (self.dims + ((self.frames,) if axes > 3 else ()))[:axes]
        return self.values.reshape(shape, order="F")

    def bytes(self, big=False):
        return self.values.astype(self.values.dtype.newbyteorder(">" if big else "<")).tobytes()


def corners_differ(a, b, dims, spacing):
    """The largest distance of the corners of two affines, in the smallest spacing."""
    index = numpy.array([[x, y, z, 1.0] for x, y, z in itertools.product(*[(0, d - 1) for d in dims])])
    gap = (index @ (numpy.array(a) - numpy.array(b)).T)[:, :3]
    return float(numpy.abs(gap).max() / min(abs(s) for s in spacing))
