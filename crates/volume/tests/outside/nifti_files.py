"""NIfTI-1, NIfTI-2 and Analyze 7.5, as nibabel, ITK and VTK write them."""

import gzip
import math
import struct

import nibabel
import numpy
import SimpleITK as sitk
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkIOImage import vtkNIFTIImageWriter

from grids import LPS, OBLIQUE, SIGNED_PERMUTATIONS, TILTED, TYPES, Grid, rotation

HEADERS = {1: nibabel.Nifti1Header, 2: nibabel.Nifti2Header}
SINGLES = {1: nibabel.Nifti1Image, 2: nibabel.Nifti2Image}
PAIRS = {1: nibabel.Nifti1Pair, 2: nibabel.Nifti2Pair}


def image_of(grid, version=1, big=False, pair=False, sform=1, qform=1, array=None):
    """A nibabel image of a grid, with the codes of its two transforms."""
    array = grid.array(4 if grid.frames > 1 else 3) if array is None else array
    header = HEADERS[version](endianness=">" if big else "<")
    header.set_data_dtype(array.dtype)
    header.set_xyzt_units("mm")
    image = (PAIRS if pair else SINGLES)[version](array, grid.affine, header)
    image.set_sform(grid.affine if sform else None, sform)
    image.set_qform(grid.affine if qform else None, qform)
    # Setting a transform to none leaves the sizes of voxels as they are.
    zooms = list(image.header.get_zooms())
    zooms[: min(3, len(zooms))] = [float(s) for s in grid.spacing[: len(zooms)]]
    image.header.set_zooms(zooms)
    return image


def patch(path, offset, code, *numbers, big=False):
    """Writes numbers over a header's bytes."""
    opened = gzip.open if path.suffix == ".gz" else open
    with opened(path, "rb") as file:
        data = bytearray(file.read())
    struct.pack_into((">" if big else "<") + code, data, offset, *numbers)
    with opened(path, "wb") as file:
        file.write(data)


def by_nibabel(files):
    def save(name, image, options, grid, **more):
        path = files.path(f"nifti/{name}")
        image.to_filename(path)
        files.add(path, "nibabel", options, grid, canonical=True, **more)
        return path

    for n, dtype in enumerate(TYPES):
        for big in (False, True):
            for version in (1, 2):
                grid = Grid(5 * n + 24 * big + 7 * version, dtype)
                end = "big" if big else "little"
                suffix = ".nii.gz" if (n + big) % 2 else ".nii"
                image = image_of(grid, version, big)
                save(f"nib{version}_{dtype}_{end}{suffix}", image, f"NIfTI-{version}, {dtype}, {end}{suffix}", grid)
    for n in range(48):
        codes = [(1, 0), (0, 1), (2, 4), (4, 0), (0, 2), (3, 3)][n % 6]
        grid = Grid(n, "int16")
        image = image_of(grid, 1 + n % 2, n % 3 == 0, sform=codes[0], qform=codes[1])
        options = f"signed permutation {n}, sform code {codes[0]}, qform code {codes[1]}"
        save(f"turn_{n:02}.nii", image, options, grid)
    turns = [("oblique", OBLIQUE), ("mirrored", OBLIQUE @ numpy.diag([1, 1, -1])), ("tilted", TILTED)]
    turns += [(f"steep_{n}", SIGNED_PERMUTATIONS[5 * n] @ rotation((2, -1, n), 20 + 5 * n)) for n in range(6)]
    turns += [("tilted_oblique", OBLIQUE @ TILTED @ SIGNED_PERMUTATIONS[13])]
    for n, (name, turn) in enumerate(turns):
        for form in ("s", "q"):
            if form == "q" and name.startswith("tilted"):
                continue
            grid = Grid(n, "uint16", turn=turn)
            image = image_of(grid, 1 + n % 2, sform=form == "s", qform=form == "q")
            save(f"{name}_{form}form.nii.gz", image, f"{name}, {form}form alone", grid)

    # Two transforms that disagree: the one that counts is the sform wherever its code is not 0.
    for n, (scode, qcode) in enumerate([(1, 1), (2, 1), (3, 1), (4, 2), (0, 1), (1, 0), (0, 0)]):
        grid = Grid(n + 11, "int16", turn=OBLIQUE)
        other = Grid(n + 30, "int16", turn=SIGNED_PERMUTATIONS[30], spacing=tuple(grid.spacing), origin=(9.0, 8.0, 7.0))
        image = image_of(grid)
        image.header.set_qform(other.affine, qcode)
        image.header.set_sform(grid.affine, scode)
        # Without an affine nibabel leaves the header's transforms as they are.
        image = nibabel.Nifti1Image(grid.array(), None, image.header)
        told = grid if scode else other
        told.dims, told.values = grid.dims, grid.values
        if not scode and not qcode:
            told.unplaced()
        save(f"two_transforms_{scode}{qcode}.nii", image, f"transforms disagree, sform code {scode}, qform code {qcode}", told)

    # The lengths of the sform's columns are not those of pixdim.
    grid = Grid(3, "int16")
    image = image_of(grid)
    image.header["pixdim"][1:4] = 1.0
    image.header["qform_code"] = 0
    save("sform_not_pixdim.nii", image, "columns of the sform of other lengths than pixdim", grid, own="get_zooms tells pixdim")

    # Pairs, asked for by either name.
    for n, (suffix, version) in enumerate([(s, v) for s in (".hdr", ".img", ".hdr.gz", ".img.gz") for v in (1, 2)]):
        for big in (False, True):
            grid = Grid(3 * n + 17 * big, ["uint8", "int16", "float32", "float64"][n % 4], turn=[None, OBLIQUE][n % 2])
            image = image_of(grid, version, big, pair=True)
            path = files.path(f"nifti/pair_{n}_{int(big)}{suffix}")
            image.to_filename(path)
            end = "big" if big else "little"
            files.add(path, "nibabel", f"NIfTI-{version} pair, {end}, asked by {suffix}", grid, canonical=True)

    # Other numbers of axes.
    for n, dims in enumerate([(7, 1, 1), (6, 5, 1), (1, 5, 4), (4, 1, 6), (1, 1, 5)]):
        for axes in (1, 2, 3):
            if math.prod(dims[axes:]) > 1:
                continue
            grid = Grid(7 * n + axes, "uint8", dims=dims)
            image = image_of(grid, array=grid.array(axes))
            save(f"axes_{axes}_{n}.nii", image, f"{axes} axes, {'x'.join(map(str, dims))}", grid)
    for n, frames in enumerate([2, 3, 4]):
        grid = Grid(9 * n + 2, ["int16", "uint8", "float32"][n], frames=frames)
        save(f"series_{n}.nii.gz", image_of(grid, 1 + n % 2, n == 1), f"series of {frames}", grid)
    grid = Grid(13, "int16", frames=3, dims=(6, 5, 1))
    save("series_slice.nii", image_of(grid), "series of 3 slices", grid)
    grid = Grid(14, "int16")
    image = image_of(grid, array=grid.values.reshape((*grid.dims, 1, 1, 1, 1), order="F"))
    save("axes_7.nii", image, "7 axes, the last four of one", grid)
    grid = Grid(15, "int16")
    path = files.path("nifti/axes_zeros.nii")
    image_of(grid).to_filename(path)
    patch(path, 48, "hhhh", 0, 0, 0, 0)
    files.add(path, "nibabel", "dim 0 beyond the axes", grid, canonical=True)
    # The fifth axis is that of several numbers a voxel.
    for n, frames in enumerate([1, 2]):
        path = files.path(f"nifti/vectors_{n}.nii")
        image_of(Grid(4), array=numpy.zeros((3, 4, 2, frames, 3), "uint8")).to_filename(path)
        files.refuse(path, "nibabel", f"vectors of 3 numbers, {frames} volumes", "vector")
    for n, value in enumerate([0.0, math.nan]):
        grid = Grid(n, "int16", dims=(5, 4, 1), turn=numpy.eye(3)).unplaced()
        grid.spacing[2] = 1.0
        path = files.path(f"nifti/pixdim_{n}.nii")
        image_of(grid, sform=0, qform=0).to_filename(path)
        patch(path, 76 + 12, "f", value)
        files.add(path, "nibabel", f"pixdim {value} of an axis of one voxel, no transform", grid)
    grid = Grid(1, "int16").unplaced()
    path = files.path("nifti/pixdim_negative.nii")
    image_of(grid, sform=0, qform=0).to_filename(path)
    patch(path, 80, "fff", *[-s for s in grid.spacing])
    files.add(path, "nibabel", "negative pixdim, no transform", grid)

    # Scaling, as fields say it.
    for n, (slope, inter) in enumerate([(0.5, -10), (2, 0), (1, 100), (-2, 3), (0, 5), (math.nan, 3), (1, 0), (1e-3, 1e3)]):
        for dtype in ("uint8", "int16", "int32", "float32", "float64"):
            grid = Grid(n, dtype)
            path = files.path(f"nifti/scaled_{n}_{dtype}.nii")
            image_of(grid, 1 + n % 2).to_filename(path)
            at, code = ((112, "ff"), (176, "dd"))[n % 2]
            patch(path, at, code, slope, inter)
            if slope and slope == slope:
                single = (lambda v: float(numpy.float32(v))) if n % 2 == 0 else float
                grid.values = grid.values.astype(float) * single(slope) + single(inter)
            files.add(path, "nibabel", f"{dtype}, slope {slope}, intercept {inter}", grid, canonical=True)

    # nibabel chooses a slope where reals go into integers.
    for n, kind in enumerate(["uint8", "int16", "int32"]):
        grid = Grid(n + 2, "float64")
        image = image_of(grid)
        image.set_data_dtype(kind)
        path = files.path(f"nifti/fitted_{kind}.nii.gz")
        image.to_filename(path)
        grid.values = numpy.asanyarray(nibabel.load(path).dataobj).ravel(order="F")
        files.add(path, "nibabel", f"reals as {kind}, slope by nibabel", grid, canonical=True)

    # What stands between header and voxels.
    grid = Grid(8, "int16", turn=OBLIQUE)
    image = image_of(grid)
    image.header.extensions.append(nibabel.nifti1.Nifti1Extension(6, b"a comment of some length, which no reader may take for voxels"))
    save("extension.nii", image, "an extension behind the header", grid)
    image = image_of(grid)
    image.header["vox_offset"] = 1024
    save("offset.nii", image, "voxels at byte 1024", grid)
    image = image_of(grid, pair=True)
    image.header["vox_offset"] = 64
    path = files.path("nifti/pair_offset.img")
    image.to_filename(path)
    files.add(path, "nibabel", "pair with the voxels at byte 64 of the .img", grid, canonical=True)
    grid = Grid(2, "float32", turn=numpy.eye(3))
    grid.values[[3, 7, 9]] = [math.nan, math.inf, -math.inf]
    save("nan.nii", image_of(grid), "NaN and infinities", grid)
    # qfac 0 stands for 1.
    grid = Grid(0, "int16", turn=OBLIQUE)
    path = files.path("nifti/qfac_0.nii")
    image_of(grid, sform=0).to_filename(path)
    patch(path, 76, "f", 0.0)
    files.add(path, "nibabel", "qfac 0", grid, canonical=True)

    for wide in (False, True):
        for dtype in ("int64", "uint64"):
            grid = Grid(6, dtype, wide=wide)
            path = files.path(f"nifti/{dtype}_{'wide' if wide else 'narrow'}.nii.gz")
            image_of(grid).to_filename(path)
            if wide:
                files.refuse(path, "nibabel", f"{dtype} beyond 32 bits", "64")
            else:
                files.add(path, "nibabel", f"{dtype} within 32 bits", grid, canonical=True)

    # Values that are no numbers, or several.
    rgb = numpy.zeros((3, 4, 5), dtype=[("R", "u1"), ("G", "u1"), ("B", "u1")])
    for name, array, word in [
        ("rgb", rgb, "RGB"), ("complex64", numpy.zeros((3, 4, 5), "complex64"), "complex"),
        ("complex128", numpy.zeros((3, 4, 5), "complex128"), "complex"),
    ]:  # fmt: skip
        path = files.path(f"nifti/{name}.nii")
        nibabel.Nifti1Image(array, numpy.eye(4)).to_filename(path)
        files.refuse(path, "nibabel", name, word)

    path = files.path("nifti/float128.nii")
    nibabel.Nifti1Image(numpy.zeros((6, 4, 5)), numpy.eye(4)).to_filename(path)
    patch(path, 42, "h", 3)
    patch(path, 70, "hh", 1536, 128)
    files.refuse(path, "nibabel", "reals of 128 bits", "1536", "nibabel has them only where the machine does")

    # Analyze 7.5 has no world.
    for n, dtype in enumerate(["uint8", "int16", "int32", "float32", "float64"]):
        for big in (False, True):
            grid = Grid(n, dtype, frames=1 + (n == 1)).unplaced()
            header = nibabel.AnalyzeHeader(endianness=">" if big else "<")
            header.set_data_dtype(dtype)
            image = nibabel.AnalyzeImage(grid.array(3 + (n == 1)), numpy.diag([*grid.spacing, 1]), header)
            image.header.set_zooms([*map(float, grid.spacing), 1.0][: image.ndim])
            suffix = [".hdr", ".img", ".img.gz"][n % 3]
            path = files.path(f"analyze/{dtype}_{'big' if big else 'little'}{suffix}")
            image.to_filename(path)
            files.add(path, "nibabel", f"Analyze 7.5, {dtype}, {'big' if big else 'little'}, asked by {suffix}", grid)
    grid = Grid(7, "int16").unplaced()
    image = nibabel.AnalyzeImage(grid.array()[..., None], numpy.diag([*grid.spacing, 1]))
    image.header.set_zooms([*map(float, grid.spacing), 1.0])
    path = files.path("analyze/axes_4.img")
    image.to_filename(path)
    files.add(path, "nibabel", "Analyze 7.5, 4 axes, one volume", grid)


def itk_image(grid, axes=3):
    """An image of ITK's, of 2 to 4 axes."""
    array = grid.array(axes).T
    image = sitk.GetImageFromArray(numpy.ascontiguousarray(array), isVector=False)
    used = min(axes, 3)
    directions, origin = grid.lps
    full = numpy.eye(axes)
    full[:used, :used] = directions[:used, :used]
    image.SetDirection(full.ravel().tolist())
    image.SetOrigin([float(o) for o in origin[:used]] + [0.0] * (axes - used))
    image.SetSpacing([float(s) for s in grid.spacing[:used]] + [1.0] * (axes - used))
    return image


def by_itk(files):
    def save(name, image, options, grid, **more):
        path = files.path(f"nifti/{name}")
        sitk.WriteImage(image, str(path), useCompression=path.suffix == ".gz")
        files.add(path, "ITK", options, grid, canonical=True, **more)

    for n, dtype in enumerate(TYPES):
        for suffix in (".nii", ".nii.gz"):
            grid = Grid(11 * n + 5 * len(suffix), dtype)
            save(f"itk_{dtype}{suffix}", itk_image(grid), f"{dtype}{suffix}", grid)
    for n in range(0, 48, 3):
        grid = Grid(n, "int16")
        save(f"itk_turn_{n:02}.nii", itk_image(grid), f"signed permutation {n}", grid)
    for n, (name, turn) in enumerate([("oblique", OBLIQUE), ("mirrored", OBLIQUE @ numpy.diag([1, -1, 1]))]):
        grid = Grid(n, "float32", turn=turn)
        save(f"itk_{name}.nii.gz", itk_image(grid), name, grid)
    for n, suffix in enumerate([".hdr", ".img", ".img.gz"]):
        grid = Grid(n + 3, "uint16", turn=OBLIQUE)
        save(f"itk_pair_{n}{suffix}", itk_image(grid), f"pair, asked by {suffix}", grid)
    grid = Grid(7, "int16", frames=3)
    save("itk_series.nii.gz", itk_image(grid, 4), "series of 3", grid)
    grid = Grid(0, "uint8", dims=(6, 5, 1), turn=LPS, origin=(4.0, 5.0, 0.0))
    save("itk_slice.nii", itk_image(grid, 2), "2 axes", grid)
    grid = Grid(9, "uint8", dims=(6, 5, 1))
    save("itk_one_slice.nii", itk_image(grid), "one slice of 3 axes", grid)


def by_vtk(files):
    kinds = ["uint8", "int16", "uint16", "int32", "uint32", "float32", "float64", "int8"]
    for n in range(16):
        turn = SIGNED_PERMUTATIONS[3 * n] if n % 4 else OBLIQUE
        grid = Grid(n, kinds[n % 8], turn=turn, frames=1 + (n == 5))
        image = vtkImageData()
        image.SetDimensions(grid.dims)
        image.SetSpacing(*grid.spacing)
        scalars = grid.values.reshape((-1, grid.frames), order="F") if grid.frames > 1 else grid.values
        image.GetPointData().SetScalars(numpy_to_vtk(numpy.ascontiguousarray(scalars), deep=True))
        form = vtkMatrix4x4()
        mirrored = numpy.linalg.det(turn) < 0
        for row in range(3):
            for column in range(3):
                form.SetElement(row, column, grid.directions[row, column])
            form.SetElement(row, 3, grid.origin[row])
        writer = vtkNIFTIImageWriter()
        suffix = [".nii", ".nii.gz", ".hdr", ".img.gz"][n % 4]
        path = files.path(f"nifti/vtk_{n:02}{suffix}")
        writer.SetFileName(str(path))
        writer.SetNIFTIVersion(1 + n // 2 % 2)
        options = f"NIfTI-{1 + n // 2 % 2}, {kinds[n % 8]}{suffix}"
        if n % 3 != 1 or mirrored:
            writer.SetSFormMatrix(form)
            options += ", sform"
        if n % 3 != 0 and not mirrored:
            writer.SetQFormMatrix(form)
            options += ", qform"
        if grid.frames > 1:
            writer.SetTimeDimension(grid.frames)
            options += f", series of {grid.frames}"
        writer.SetInputData(image)
        writer.Write()
        files.add(path, "VTK", options, grid, canonical=True)
