"""MetaImage, as ITK and VTK write it, and headers by hand for what no writer writes."""

import gzip
import zlib

import numpy
import SimpleITK as sitk
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOImage import vtkMetaImageWriter

from grids import LPS, OBLIQUE, SIGNED_PERMUTATIONS, TILTED, TYPES, Grid, rotation
from nifti_files import itk_image

NAMES = {
    "int8": "MET_CHAR", "uint8": "MET_UCHAR", "int16": "MET_SHORT", "uint16": "MET_USHORT", "int32": "MET_INT",
    "uint32": "MET_UINT", "int64": "MET_LONG_LONG", "uint64": "MET_ULONG_LONG", "float32": "MET_FLOAT", "float64": "MET_DOUBLE",
}  # fmt: skip


def by_itk(files):
    def save(name, image, options, grid, compress=False):
        path = files.path(f"metaimage/{name}")
        sitk.WriteImage(image, str(path), useCompression=compress)
        files.add(path, "ITK", options, grid)

    for n, dtype in enumerate(TYPES):
        for m, suffix in enumerate([".mha", ".mhd"]):
            for compress in (False, True):
                grid = Grid(17 * n + 7 * m + 5 * compress, dtype)
                how = "zlib" if compress else "raw"
                save(f"itk_{dtype}_{how}{suffix}", itk_image(grid), f"{dtype}, {how}{suffix}", grid, compress)
    for n in range(48):
        grid = Grid(n, "int16")
        save(f"turn_{n:02}.mha", itk_image(grid), f"signed permutation {n}", grid, n % 2 == 0)
    turns = [("oblique", OBLIQUE), ("mirrored", OBLIQUE @ numpy.diag([-1, 1, 1])), ("tilted", TILTED)]
    turns += [(f"steep_{n}", SIGNED_PERMUTATIONS[9 * n + 1] @ rotation((3, n, 1), 40 - 7 * n)) for n in range(5)]
    for n, (name, turn) in enumerate(turns):
        grid = Grid(n, "float32", turn=turn)
        save(f"{name}.mha", itk_image(grid), name, grid)
    for frames in (2, 3):
        grid = Grid(5 * frames, "int16", frames=frames)
        save(f"itk_series_{frames}.mha", itk_image(grid, 4), f"series of {frames}", grid, frames == 3)
    grid = Grid(0, "uint8", dims=(6, 5, 1), turn=LPS, origin=(4.0, 5.0, 0.0))
    save("itk_axes_2.mha", itk_image(grid, 2), "2 axes", grid)
    grid = Grid(0, "uint8", dims=(6, 5, 1), turn=rotation((0, 0, 1), 130), origin=(4.0, 5.0, 0.0))
    save("itk_axes_2_turned.mha", itk_image(grid, 2), "2 axes, turned", grid)
    grid = Grid(19, "uint8", dims=(6, 5, 1))
    save("itk_one_slice.mha", itk_image(grid), "one slice of 3 axes", grid)
    for name, image, word in [
        ("vectors", sitk.Image([3, 4, 5], sitk.sitkVectorInt16, 2), "2 numbers"),
        ("colours", sitk.Image([3, 4, 5], sitk.sitkVectorUInt8, 3), "3 numbers"),
    ]:
        path = files.path(f"metaimage/{name}.mha")
        sitk.WriteImage(image, str(path))
        files.refuse(path, "ITK", name, word)
    for dtype in ("int64", "uint64"):
        path = files.path(f"metaimage/{dtype}_wide.mha")
        sitk.WriteImage(itk_image(Grid(3, dtype, wide=True)), str(path))
        files.refuse(path, "ITK", f"{dtype} beyond 32 bits", "64")


def by_vtk(files):
    for n, dtype in enumerate(["uint8", "int8", "int16", "uint16", "int32", "uint32", "float32", "float64"]):
        for compress in (False, True):
            grid = Grid(n, dtype, turn=LPS)
            image = vtkImageData()
            image.SetDimensions(grid.dims)
            image.SetSpacing(*grid.spacing)
            image.SetOrigin(*(LPS @ grid.origin))
            image.GetPointData().SetScalars(numpy_to_vtk(grid.values, deep=True))
            writer = vtkMetaImageWriter()
            path = files.path(f"metaimage/vtk_{dtype}_{int(compress)}.{'mha' if n % 2 else 'mhd'}")
            writer.SetFileName(str(path))
            if path.suffix == ".mhd":
                writer.SetRAWFileName(str(path.with_suffix(".zraw" if compress else ".raw")))
            writer.SetCompression(compress)
            writer.SetInputData(image)
            writer.Write()
            files.add(path, "VTK", f"{dtype}, {'zlib' if compress else 'raw'}{path.suffix}", grid)


def by_hand(files):
    def lines_of(grid, kind=None, spacing=None, **more):
        directions, origin = grid.lps
        lines = {"ObjectType": "Image", "NDims": "3", "BinaryData": "True", "BinaryDataByteOrderMSB": "False"}
        if grid.space != "unknown":
            lines["TransformMatrix"] = " ".join(repr(float(n)) for n in directions.T.ravel())
        lines["Offset"] = " ".join(repr(float(n)) for n in (origin if grid.space != "unknown" else grid.origin))
        lines["ElementSpacing"] = " ".join(repr(float(n)) for n in (grid.spacing if spacing is None else spacing))
        lines["DimSize"] = " ".join(map(str, grid.dims))
        lines["ElementType"] = kind or NAMES[grid.values.dtype.name]
        for key, value in more.items():
            if value is None:
                lines.pop(key)
            else:
                lines[key] = value
        lines["ElementDataFile"] = lines.pop("ElementDataFile", "LOCAL")
        return lines

    def write(name, grid, options, lines, data=None, own=None):
        path = files.path(f"metaimage/{name}")
        text = "".join(f"{key} = {value}\n" for key, value in lines.items()).encode()
        text += grid.bytes() if data is None else data
        path.write_bytes(gzip.compress(text) if name.endswith(".gz") else text)
        files.add(path, "by hand", options, grid, own)

    def parts(name, grid, count):
        names = [f"{name}_{k + 1:02}.raw" for k in range(count)]
        size = grid.values.nbytes // count
        for k, part in enumerate(names):
            files.path(f"metaimage/{part}").write_bytes(grid.bytes()[k * size : (k + 1) * size])
        return names

    # Synonyms of keys.
    for n, old in enumerate(["Orientation", "Rotation"]):
        grid = Grid(n, "int16", turn=OBLIQUE)
        lines = lines_of(grid)
        lines = {old if key == "TransformMatrix" else key: value for key, value in lines.items()}
        write(f"synonym_{old}.mha", grid, f"{old} for TransformMatrix", lines)
    for n, old in enumerate(["Position", "Origin"]):
        grid = Grid(n + 3, "int16", turn=OBLIQUE)
        lines = {old if key == "Offset" else key: value for key, value in lines_of(grid).items()}
        write(f"synonym_{old}.mha", grid, f"{old} for Offset", lines)
    grid = Grid(13, "int16")
    lines = {"ElementSize" if key == "ElementSpacing" else key: value for key, value in lines_of(grid).items()}
    write("element_size.mha", grid, "ElementSize without ElementSpacing", lines)
    lines = lines_of(grid, ElementSize="9 9 9")
    write("both_sizes.mha", grid, "ElementSize beside ElementSpacing", lines)
    lines = lines_of(grid, AnatomicalOrientation="LAS", CenterOfRotation="1 2 3", Modality="MET_MOD_CT", Comment="any = thing")
    write("more_keys.mha", grid, "AnatomicalOrientation, CenterOfRotation, Modality, Comment", lines)
    # No matrix.
    grid = Grid(3, "int16").unplaced(origin=(4.0, -5.0, 6.0))
    write("no_matrix.mha", grid, "no TransformMatrix", lines_of(grid))
    grid = Grid(3, "int16").unplaced(origin=(0.0, 0.0, 0.0))
    write("bare.mha", grid, "no TransformMatrix, no Offset", lines_of(grid, Offset=None))
    # Byte order.
    for n, (dtype, key) in enumerate([("int16", "BinaryDataByteOrderMSB"), ("float64", "ElementByteOrderMSB"), ("uint32", "ElementByteOrderMSB")]):
        grid = Grid(n + 21, dtype)
        lines = lines_of(grid)
        lines.pop("BinaryDataByteOrderMSB")
        lines = {key: "True"} | lines
        write(f"big_{n}.mha", grid, f"{dtype}, {key} = True", lines, grid.bytes(True))
    grid = Grid(22, "uint16")
    packed = zlib.compress(grid.bytes(True))
    lines = lines_of(grid, BinaryDataByteOrderMSB="True", CompressedData="True", CompressedDataSize=len(packed))
    write("big_zlib.mha", grid, "zlib of big endian", lines, packed)
    packed = zlib.compress(grid.bytes())
    why = "ITK gives what its memory held before"
    write("zlib_unsized.mha", grid, "zlib without CompressedDataSize", lines_of(grid, CompressedData="True"), packed, why)
    # Text.
    for n, dtype in enumerate(["uint8", "int16", "float32", "float64"]):
        grid = Grid(n + 25, dtype)
        text = (" ".join(map(str, grid.values.tolist())) + "\n").encode()
        write(f"text_{dtype}.mha", grid, f"{dtype} as text", lines_of(grid, BinaryData="False"), text)
    # Names of types.
    for n, (kind, dtype) in enumerate([("MET_LONG", "int32"), ("MET_ULONG", "uint32"), ("MET_LONG_LONG", "int64")]):
        grid = Grid(n + 33, dtype)
        write(f"kind_{kind}.mha", grid, kind, lines_of(grid, kind))
    # What stands before the voxels.
    for n, size in enumerate([7, 100, -1]):
        grid = Grid(n + 36, "int16", turn=OBLIQUE)
        files.path(f"metaimage/header_{n}.raw").write_bytes(b"x" * (size if size > 0 else 33) + grid.bytes())
        lines = lines_of(grid, HeaderSize=size, ElementDataFile=f"header_{n}.raw")
        write(f"header_{n}.mhd", grid, f"HeaderSize {size}", lines, b"")
    # Several files.
    grid = Grid(40, "int16")
    names = parts("list", grid, grid.dims[2])
    lines = lines_of(grid, ElementDataFile="LIST\n" + "\n".join(names))
    write("list.mhd", grid, "slices of a LIST", lines, b"")
    lines = lines_of(grid, ElementDataFile="LIST 2\n" + "\n".join(names))
    write("list_2.mhd", grid, "slices of a LIST 2", lines, b"")
    lines = lines_of(grid, ElementDataFile=f"list_%02d.raw 1 {grid.dims[2]} 1")
    write("pattern.mhd", grid, "slices of a pattern", lines, b"")
    # A direction the other way round, by the sign of its spacing.
    grid = Grid(41, "int16", turn=LPS @ numpy.diag([-1, 1, 1]))
    lines = lines_of(grid, spacing=grid.spacing * (-1, 1, 1), TransformMatrix="1 0 0 0 1 0 0 0 1")
    write("negative.mha", grid, "negative ElementSpacing", lines)
    grid = Grid(43, "int16", turn=OBLIQUE @ numpy.diag([1, -1, -1]))
    matrix = " ".join(repr(float(n)) for n in (LPS @ OBLIQUE).T.ravel())
    lines = lines_of(grid, spacing=grid.spacing * (1, -1, -1), TransformMatrix=matrix)
    write("negative_oblique.mha", grid, "negative ElementSpacing, oblique", lines)
    # How lines are written.
    grid = Grid(44, "int16", turn=OBLIQUE)
    text = "".join(f"{key}={value}\n" for key, value in lines_of(grid).items()).encode() + grid.bytes()
    files.path("metaimage/no_blanks.mha").write_bytes(text)
    files.add(files.path("metaimage/no_blanks.mha"), "by hand", "no blanks about =", grid)
    files.path("metaimage/a folder/of voxels.raw").write_bytes(grid.bytes())
    lines = lines_of(grid, ElementDataFile="a folder/of voxels.raw", ElementNumberOfChannels=1)
    write("in_folder.mhd", grid, "a data file in a folder, with blanks in its name", lines, b"")
    text = "".join(f"{key} = {value}\r\n" for key, value in lines.items()).encode()
    files.path("metaimage/crlf.mhd").write_bytes(text)
    files.add(files.path("metaimage/crlf.mhd"), "by hand", "lines that end with CR LF", grid)
    grid = Grid(45, "int16", turn=OBLIQUE)
    names = parts("skip", grid, grid.dims[2])
    for name in names:
        path = files.path(f"metaimage/{name}")
        path.write_bytes(b"0123456" + path.read_bytes())
    lines = lines_of(grid, HeaderSize=7, ElementDataFile="LIST\n" + "\n".join(names))
    write("list_header.mhd", grid, "a LIST, each file with a header of 7", lines, b"")
    lines = lines_of(grid, HeaderSize=-1, ElementDataFile="LIST\n" + "\n".join(names))
    write("list_header_end.mhd", grid, "a LIST, each file with a header of -1", lines, b"")
    grid = Grid(46, "int16", frames=3)
    names = parts("volume", grid, 3)
    lines = lines_of(grid, ElementDataFile="LIST\n" + "\n".join(names), NDims=4)
    lines["DimSize"] += " 3"
    lines["ElementSpacing"] += " 1"
    lines["Offset"] += " 0"
    full = numpy.eye(4)
    full[:3, :3] = grid.lps[0].T
    lines["TransformMatrix"] = " ".join(map(repr, full.ravel().tolist()))
    write("series_list.mhd", grid, "series of 3, volumes of a LIST", lines, b"")
    lines["ElementDataFile"] = "volume_%02d.raw 1 3 1"
    write("series_pattern.mhd", grid, "series of 3, volumes of a pattern", lines, b"")
    grid = Grid(42, "int16", turn=OBLIQUE)
    write("whole.mha.gz", grid, "the whole file through gzip", lines_of(grid), own="no library reads it")
