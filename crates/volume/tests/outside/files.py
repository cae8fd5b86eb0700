"""The files that are made: each is told with its grid, and with what the libraries read from it."""

import json
import pathlib

import nibabel
import numpy

import readers
from grids import corners_differ

VERSIONS = readers.versions()


def plain(value):
    """A number for JSON; what JSON has no word for is told as one."""
    value = value.item()
    if value != value:
        return "nan"
    return value if value not in (float("inf"), float("-inf")) else ("inf" if value > 0 else "-inf")


def differences(reading, grid):
    """In what a reading differs from the grid that was written."""
    found = []
    if grid.space != "unknown" and reading.affine is not None:
        reading = in_order_of(grid, reading)
    if reading.dims != grid.dims:
        found.append(f"dims {'x'.join(map(str, reading.dims))}")
    if reading.frames != grid.frames:
        found.append(f"frames {reading.frames}")
    several = [a for a in range(3) if grid.dims[a] > 1]
    spacing = grid.spacing * (numpy.sign(numpy.diag(grid.directions)) if grid.space == "unknown" else 1)
    if not numpy.allclose([reading.spacing[a] for a in several], [spacing[a] for a in several], rtol=1e-5):
        found.append("spacing")
    if reading.space not in (grid.space, None):
        found.append(f"a world that is {reading.space}")
    elif grid.space != "unknown" and reading.affine is None:
        found.append("no world")
    elif grid.space != "unknown" and corners_differ(reading.affine, grid.affine, grid.dims, grid.spacing) > 1e-3:
        found.append("place")
    elif grid.space == "unknown" and grid.placed and reading.origin is not None:
        if not numpy.allclose(reading.origin, grid.origin, atol=1e-6):
            found.append("origin")
    same = reading.values.shape == grid.values.shape and numpy.allclose(
        reading.values.astype(float), grid.values.astype(float), rtol=1e-6, atol=1e-6, equal_nan=True
    )
    if not same:
        found.append("values")
    return found


def in_order_of(grid, reading):
    """The same voxels at the same places, with the third axis the other way round where that is the grid's way.

    VTK turns the slices of a NIfTI file with left-handed axes, and places them accordingly.
    """
    x, y, z = reading.dims
    if numpy.dot(reading.affine[:3, 2], grid.affine[:3, 2]) >= 0 or z == 1 or reading.values.size != x * y * z * reading.frames:
        return reading
    values = reading.values.reshape((x, y, z, reading.frames), order="F")[:, :, ::-1].ravel(order="F")
    affine = reading.affine.copy()
    affine[:3, 3] += affine[:3, 2] * (z - 1)
    affine[:3, 2] *= -1
    return type(reading)(reading.dims, reading.frames, reading.spacing, affine, values, reading.space)


class Files:
    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.lines = []
        self.wrong = []

    def path(self, name):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        return path

    def add(self, path, writer, options, grid, own=None, canonical=False, stored_type=None):
        """Tells of a file that holds `grid`. `own` says why the format's own library reads something else, where it does."""
        told = self._tell(path, writer, options, grid)
        first = next(iter(told["readings"]))
        if bool(told["readings"][first]) != (own is not None):
            self.wrong.append(f"{told['file']}: {options}: {first} reads {told['readings'][first]}, own = {own}")
        if own:
            told["own"] = own
        told["space"] = grid.space
        told["dims"] = grid.dims
        told["frames"] = grid.frames
        told["spacing"] = [float(s) for s in grid.spacing]
        told["affine"] = grid.affine.tolist()
        told["placed"] = grid.placed
        told["values"] = [plain(v) for v in grid.values]
        # nibabel turns images of three axes and more.
        if canonical and grid.space != "unknown" and nibabel.load(path).ndim > 2:
            array = numpy.asanyarray(nibabel.as_closest_canonical(nibabel.load(path)).dataobj)
            told["canonical"] = {"dims": array.shape[:3], "values": [plain(v) for v in array.ravel(order="F")]}
        self.lines.append(told)

    def refuse(self, path, writer, options, word, own=None):
        """Tells of a file that cube3 refuses with a message that has `word` in it, and that the format's own library reads,
        unless `own` says why not."""
        told = self._tell(path, writer, options, None)
        first = next(iter(told["readings"]))
        failed = [e for e in told["readings"][first] if "numbers for each voxel" not in e]
        if bool(failed) != (own is not None):
            self.wrong.append(f"{told['file']}: {options}: {first} says {failed}, own = {own}")
        told["refused"] = word
        self.lines.append(told)

    def _tell(self, path, writer, options, grid):
        told = {
            "file": str(path.relative_to(self.folder)),
            "writer": f"{writer} {VERSIONS[writer]}" if writer in VERSIONS else writer,
            "options": options,
            "readings": {},
        }
        for name, read in readers.readers_of(path).items():
            try:
                reading = read(path)
                told["readings"][name] = differences(reading, grid) if grid else []
            except Exception as error:
                told["readings"][name] = [f"error: {' '.join(str(error).split())[-160:]}"]
        return told

    def save(self):
        with open(self.folder / "files.jsonl", "w") as file:
            for line in self.lines:
                file.write(json.dumps(line) + "\n")
