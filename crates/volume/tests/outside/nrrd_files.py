"""NRRD, as pynrrd, teem's `unu`, and ITK write it, and headers by hand for what no writer writes."""

import gzip
import math
import re

import nrrd
import numpy
import SimpleITK as sitk

from grids import LPS, OBLIQUE, SIGNED_PERMUTATIONS, TILTED, TYPES, Grid, rotation
from nifti_files import itk_image
from readers import nrrd_space, teem_reads, unu

TEEM_NAMES = {
    "int8": "signed char", "uint8": "uchar", "int16": "short", "uint16": "ushort", "int32": "int", "uint32": "uint",
    "int64": "longlong", "uint64": "ulonglong", "float32": "float", "float64": "double",
}  # fmt: skip


def in_space(grid, space):
    """Directions (columns) and origin as a named space counts them."""
    signs, _ = nrrd_space(space)
    return numpy.diag(signs) @ (grid.directions * grid.spacing), numpy.diag(signs) @ grid.origin


def vector(numbers):
    return "(" + ",".join(repr(float(n)) for n in numbers) + ")"


def by_pynrrd(files):
    def save(name, array, options, grid, own=None, **header):
        path = files.path(f"nrrd/{name}")
        fields = {key.replace("_", " "): value for key, value in header.items()}
        nrrd.write(str(path), array, fields, index_order="F", detached_header=path.suffix == ".nhdr")
        files.add(path, "pynrrd", options, grid, own)

    def placed(grid, space, series_first=False, series_last=False):
        matrix, origin = in_space(grid, space)
        rows = matrix.T
        none = numpy.full((1, 3), math.nan)
        if series_first:
            rows = numpy.vstack([none, rows])
        if series_last:
            rows = numpy.vstack([rows, none])
        return {"space": space, "space_directions": rows, "space_origin": origin}

    for n, dtype in enumerate(TYPES):
        for m, (encoding, end) in enumerate([("raw", "<"), ("raw", ">"), ("gzip", "<"), ("gzip", ">"), ("ascii", "<")]):
            grid = Grid(5 * n + 11 * m, dtype)
            space = ["right-anterior-superior", "left-anterior-superior", "left-posterior-superior"][(n + m) % 3]
            array = grid.array().astype(numpy.dtype(dtype).newbyteorder(end))
            order = "big" if end == ">" else "little"
            name = f"pynrrd_{dtype}_{encoding}_{order}{'.nhdr' if (n + m) % 4 == 0 else '.nrrd'}"
            save(name, array, f"{dtype}, {encoding}, {order}, {space}", grid, encoding=encoding, **placed(grid, space))
    # Every signed permutation, through every named space.
    spaces = ["right-anterior-superior", "left-anterior-superior", "left-posterior-superior", "RAS", "LAS", "LPS"]
    for n in range(48):
        grid = Grid(n, "int16")
        space = spaces[n % 6]
        save(f"turn_{n:02}.nrrd", grid.array(), f"signed permutation {n}, {space}", grid, **placed(grid, space))
    turns = [("oblique", OBLIQUE), ("mirrored", OBLIQUE @ numpy.diag([-1, 1, 1])), ("tilted", TILTED)]
    turns += [(f"steep_{n}", SIGNED_PERMUTATIONS[7 * n + 3] @ rotation((1, n, -2), 30 - 4 * n)) for n in range(5)]
    for n, (name, turn) in enumerate(turns):
        grid = Grid(n, "float32", turn=turn)
        space = spaces[n % 6]
        save(f"{name}.nrrd", grid.array(), f"{name}, {space}", grid, **placed(grid, space))
    for n, space in enumerate(["scanner-xyz", "3D-right-handed", "3D-left-handed"]):
        for turn in (numpy.eye(3), OBLIQUE):
            grid = Grid(n, "int16", turn=turn).of_room()
            name = f"room_{n}_{int(turn is OBLIQUE)}.nrrd"
            save(name, grid.array(), f"{space}{', oblique' if turn is OBLIQUE else ''}", grid, **placed(grid, space))
    # No space of a name.
    grid = Grid(5, "int16").unplaced()
    save("plain.nrrd", grid.array(), "no spacing at all", unit(Grid(5, "int16").unplaced()))
    save("spacings.nrrd", grid.array(), "spacings alone", grid, spacings=list(grid.spacing))
    grid = Grid(5, "int16").unplaced(origin=(4.0, -5.0, 6.0))
    rows = numpy.diag(grid.spacing)
    about = {"space_dimension": 3, "space_directions": rows, "space_origin": grid.origin}
    save("no_name.nrrd", grid.array(), "space dimension 3 without a name", grid, **about)
    grid = Grid(5, "int16").unplaced(origin=(4.0, -5.0, 6.0))
    grid.directions = OBLIQUE
    about["space_directions"] = (OBLIQUE * grid.spacing).T
    save("no_name_oblique.nrrd", grid.array(), "space dimension 3 without a name, oblique", grid, **about)
    # Spacings of every sign.
    grid = Grid(2, "uint8").unplaced()
    grid.directions = numpy.diag([-1.0, 1, 1])
    spacings = list(grid.spacing * (-1, 1, 1))
    save("negative.nrrd", grid.array(), "a negative spacing", grid, spacings=spacings)
    grid = Grid(2, "uint8", dims=(5, 4, 1)).unplaced()
    grid.spacing[2] = 1
    why = "teem refuses a spacing of 0"
    save("zero.nrrd", grid.array(), "spacing 0 of an axis of one voxel", grid, why, spacings=[*grid.spacing[:2], 0.0])
    save("nan.nrrd", grid.array(), "spacing NaN of an axis of one voxel", grid, spacings=[*grid.spacing[:2], math.nan])
    # Other numbers of axes.
    grid = Grid(3, "float32", dims=(11, 1, 1)).unplaced()
    save("axes_1.nrrd", grid.array(1), "1 axis", grid, spacings=[grid.spacing[0]])
    grid = Grid(3, "float32", dims=(11, 6, 1)).unplaced()
    save("axes_2.nrrd", grid.array(2), "2 axes", grid, spacings=list(grid.spacing[:2]))
    for n, frames in enumerate([2, 3, 5]):
        grid = Grid(9 * n + 4, ["int16", "uint8", "float64"][n], frames=frames)
        about = placed(grid, "left-posterior-superior", series_last=True)
        kinds = ["space"] * 3 + ["list"]
        save(f"series_last_{n}.nrrd", grid.array(4), f"series of {frames}, last axis", grid, kinds=kinds, **about)
        grid = Grid(9 * n + 5, ["int16", "uint8", "float64"][n], frames=frames)
        about = placed(grid, "right-anterior-superior", series_first=True)
        array = numpy.asfortranarray(grid.array(4).transpose(3, 0, 1, 2))
        for kind in ("list", "time"):
            kinds = [kind] + ["space"] * 3
            options = f"series of {frames}, first axis, kind {kind}"
            save(f"series_first_{kind}_{n}.nrrd", array, options, grid, kinds=kinds, **about)
    # A series that no kind and no direction names: the fourth axis.
    grid = Grid(6, "int16", frames=3).unplaced()
    save("series_bare.nrrd", grid.array(4), "4 axes, spacings alone", grid, spacings=[*grid.spacing, math.nan])
    save("series_kinds.nrrd", grid.array(4), "4 axes of kind domain", grid, spacings=[*grid.spacing, 1.0], kinds=["domain"] * 4)
    array = numpy.asfortranarray(grid.array(4).transpose(3, 0, 1, 2))
    kinds = ["list"] + ["domain"] * 3
    save("series_nan.nrrd", array, "first axis of kind list, spacings alone", grid, spacings=[math.nan, *grid.spacing], kinds=kinds)
    grid = Grid(8, "int16", dims=(7, 4, 1)).unplaced(origin=(3.0, -2.0, 0.0))
    about = {"space_dimension": 2, "space_directions": numpy.diag(grid.spacing[:2]), "space_origin": grid.origin[:2]}
    save("plane.nrrd", grid.array(2), "2 axes, space dimension 2", grid, **about)
    for n, space in enumerate(["right-anterior-superior-time", "LPST"]):
        grid = Grid(n + 20, "int16", frames=3)
        matrix, origin = in_space(grid, space)
        rows = numpy.zeros((4, 4))
        rows[:3, :3] = matrix.T
        rows[3, 3] = 0.04
        about = {"space": space, "space_directions": rows, "space_origin": [*origin, 0.0]}
        kinds = ["space"] * 3 + ["time"]
        save(f"timed_{n}.nrrd", grid.array(4), f"series in the space {space}", grid, kinds=kinds, **about)
    grid = Grid(21, "int16")
    about = placed(grid, "LPS", series_first=True)
    kinds = ["vector"] + ["space"] * 3
    save("one_component.nrrd", grid.array()[None], "a first axis of one component", grid, kinds=kinds, **about)
    # What cube3 takes no volume from.
    for kind, count in [("RGB-color", 3), ("vector", 3), ("RGBA-color", 4), ("3-vector", 3), ("complex", 2)]:
        grid = Grid(2, "uint8")
        array = numpy.zeros((count, *grid.dims), "uint8")
        path = files.path(f"nrrd/{kind}.nrrd")
        about = {"kinds": [kind] + ["domain"] * 3}
        nrrd.write(str(path), array, about, index_order="F")
        files.refuse(path, "pynrrd", f"{count} components of kind {kind}", kind)
    path = files.path("nrrd/bzip2.nrrd")
    nrrd.write(str(path), Grid(1).array(), {"encoding": "bzip2"}, index_order="F")
    files.refuse(path, "pynrrd", "bzip2", "bzip2")
    for dtype in ("int64", "uint64"):
        path = files.path(f"nrrd/{dtype}_wide.nrrd")
        nrrd.write(str(path), Grid(1, dtype, wide=True).array(), {"encoding": "raw"}, index_order="F")
        files.refuse(path, "pynrrd", f"{dtype} beyond 32 bits", "64")


def unit(grid):
    grid.spacing[:] = 1
    return grid


def by_teem(files):
    def make(name, grid, dtype, encoding="raw", big=False, space="LPS"):
        """Has unu make an NRRD of a grid, and save it in an encoding."""
        path = files.path(f"nrrd/{name}")
        raw = path.with_suffix(".bytes")
        raw.write_bytes(grid.bytes())
        words = ["make", "-i", raw, "-t", TEEM_NAMES[dtype], "-s", *grid.dims, "-en", "little"]
        if grid.space == "unknown":
            words += ["-sp", *grid.spacing]
        else:
            matrix, origin = in_space(grid, space)
            words += ["-spc", space, "-orig", vector(origin), "-dirs", " ".join(map(vector, matrix.T))]
            words += ["-k", "space", "space", "space"]
        made = unu(*words, "-o", "-")
        unu("save", "-f", "nrrd", "-e", encoding, "-en", "big" if big else "little", "-i", "-", "-o", path, input=made)
        raw.unlink()
        return path

    ways = [("raw", False), ("raw", True), ("gzip", False), ("gzip", True), ("ascii", False), ("hex", False), ("hex", True)]
    for n, dtype in enumerate(TYPES):
        for m, (encoding, big) in enumerate(ways):
            grid = Grid(7 * n + 5 * m, dtype)
            order = "big" if big else "little"
            space = ["RAS", "LAS", "LPS"][(n + m) % 3]
            suffix = ".nhdr" if (n + m) % 5 == 0 else ".nrrd"
            path = make(f"teem_{dtype}_{encoding}_{order}{suffix}", grid, dtype, encoding, big, space)
            own = None
            if dtype in ("int64", "uint64") and encoding == "ascii":
                own = "teem reads 64-bit integers in text as 32-bit ones" if teem_reads(path).values.tolist() != grid.values.tolist() else None
            files.add(path, "teem", f"{dtype}, {encoding}, {order}, {space}", grid, own)
    for n, encoding in enumerate(["raw", "gzip", "ascii", "hex"]):
        grid = Grid(n, "int16").unplaced()
        files.add(make(f"teem_plain_{encoding}.nrrd", grid, "int16", encoding), "teem", f"spacings alone, {encoding}", grid)
    for encoding in ("raw", "ascii", "hex"):
        grid = Grid(18, "float32")
        grid.values[[2, 5, 7]] = [math.nan, math.inf, -math.inf]
        path = make(f"teem_nan_{encoding}.nrrd", grid, "float32", encoding)
        files.add(path, "teem", f"NaN and infinities, {encoding}", grid)
    path = make("teem_bzip2.nrrd", Grid(1), "int16", "bzip2")
    files.refuse(path, "teem", "bzip2", "bzip2")

    # What unu makes of a volume: teem itself says where its voxels are.
    steps = [("permute", "-p", "2", "0", "1"), ("permute", "-p", "1", "0", "2"), ("flip", "-a", "0"), ("flip", "-a", "2")]
    steps += [("crop", "-min", "1", "1", "0", "-max", "M", "M-1", "M"), ("pad", "-min", "-1", "0", "0", "-max", "M+1", "M", "M", "-b", "pad", "-v", "7")]
    steps += [("slice", "-a", "2", "-p", "1"), ("axinsert", "-a", "0"), ("resample", "-s", "x2", "x1", "x1", "-k", "box")]
    for n, step in enumerate(steps):
        source = make("step_source.nrrd", Grid(n + 3, "int16", turn=OBLIQUE), "int16")
        path = files.path(f"nrrd/step_{n}_{step[0]}.nrrd")
        unu(*step, "-i", source, "-o", path)
        source.unlink()
        reading = teem_reads(path)
        grid = Grid(0, "int16")
        grid.dims, grid.values = reading.dims, reading.values
        grid.spacing = numpy.array(reading.spacing)
        grid.directions, grid.origin = reading.affine[:3, :3] / grid.spacing, reading.affine[:3, 3]
        files.add(path, "teem", f"after unu {' '.join(step)}", grid)

    # Ends of axes, by centre.
    for n, center in enumerate(["cell", "node", None]):
        grid = Grid(n, "uint8")
        source = make("ends_source.nrrd", Grid(n, "uint8").unplaced(), "uint8")
        ends = [(-3.0, 6.0), (10.0, 14.5), (0.5, 5.5)]
        data = unu("save", "-f", "nrrd", "-i", source)
        source.unlink()
        for axis, (low, high) in enumerate(ends):
            words = ["-c", center] if center else []
            data = unu("axinfo", "-a", axis, "-mm", low, high, *words, "-i", "-", input=data)
        path = files.path(f"nrrd/ends_{center}.nrrd")
        # unu keeps the spacings, which say something else.
        path.write_bytes(re.sub(rb"spacings: .*\n", b"", data))
        counts = [d - (center == "node") for d in grid.dims]
        spacing = [(high - low) / count for (low, high), count in zip(ends, counts)]
        origin = [low + (0 if center == "node" else s / 2) for (low, _), s in zip(ends, spacing)]
        grid = Grid(n, "uint8", spacing=spacing).unplaced(origin=origin)
        files.add(path, "teem", f"axis mins and maxs, centers {center or 'not said'}", grid)

    # Voxels in several files.
    def split(name, grid, dtype, per_file, arguments, names, options, big=False):
        folder = files.path(f"nrrd/{name}/x").parent
        data = grid.bytes(big)
        assert len(names) * per_file == len(data)
        for n, file in enumerate(names):
            (folder / file).write_bytes(data[n * per_file : (n + 1) * per_file])
        matrix, origin = in_space(grid, "RAS")
        words = ["make", "-h", "-i", *arguments, "-t", TEEM_NAMES[dtype], "-s", *grid.dims, "-en", "big" if big else "little"]
        words += ["-spc", "RAS", "-orig", vector(origin), "-dirs", " ".join(map(vector, matrix.T)), "-o", "all.nhdr"]
        unu(*words, cwd=folder)
        files.add(folder / "all.nhdr", "teem", options, grid)

    for n, dtype in enumerate(["int16", "uint8", "float32", "uint16"]):
        grid = Grid(4 * n + 1, dtype)
        slices = grid.dims[2]
        size = grid.values.nbytes // slices
        big = n % 2 == 1
        names = [f"s{k:03}.raw" for k in range(1, slices + 1)]
        split(f"pattern_{n}", grid, dtype, size, ["s%03d.raw", 1, slices, 1], names, "slices of a pattern", big)
        names = [f"s{k}.raw" for k in range(10 * slices, 0, -10)]
        split(f"down_{n}", grid, dtype, size, ["s%d.raw", 10 * slices, 10, -10], names, "slices of a pattern that counts down", big)
        names = [f"{chr(97 + k)}.raw" for k in range(slices)]
        split(f"list_{n}", grid, dtype, size, names, names, "slices of a list", big)


def by_itk(files):
    def save(name, image, options, grid, compress=False, **more):
        path = files.path(f"nrrd/{name}")
        sitk.WriteImage(image, str(path), useCompression=compress)
        files.add(path, "ITK", options, grid, **more)

    for n, dtype in enumerate(TYPES):
        for compress in (False, True):
            grid = Grid(13 * n + 6 * compress, dtype)
            suffix = ".nhdr" if n % 3 == 2 else ".nrrd"
            how = "gzip" if compress else "raw"
            save(f"itk_{dtype}_{how}{suffix}", itk_image(grid), f"{dtype}, {how}{suffix}", grid, compress)
    for n in range(1, 48, 3):
        grid = Grid(n, "int16")
        save(f"itk_turn_{n:02}.nrrd", itk_image(grid), f"signed permutation {n}", grid)
    for n, (name, turn) in enumerate([("oblique", OBLIQUE), ("tilted", TILTED), ("mirrored", OBLIQUE @ numpy.diag([1, -1, 1]))]):
        grid = Grid(n, "uint16", turn=turn)
        save(f"itk_{name}.nrrd", itk_image(grid), name, grid, True)
    grid = Grid(2, "int16", frames=3, turn=LPS)
    save("itk_series.nrrd", itk_image(grid, 4), "4 axes", Grid(2, "int16", frames=3).unplaced(origin=LPS @ grid.origin))
    grid = Grid(0, "uint8", dims=(6, 5, 1), turn=LPS, origin=(4.0, 5.0, 0.0))
    told = Grid(0, "uint8", dims=(6, 5, 1)).unplaced(origin=(-4.0, -5.0, 0.0))
    save("itk_slice.nrrd", itk_image(grid, 2), "2 axes", told)
    image = sitk.JoinSeries([sitk.Image(3, 4, sitk.sitkVectorUInt8)] * 2)
    path = files.path("nrrd/itk_vectors.nrrd")
    sitk.WriteImage(image, str(path))
    files.refuse(path, "ITK", "vectors of 2 numbers", "vector")


def by_hand(files):
    def write(name, grid, options, lines, data, version="NRRD0005", own=None, end="\n"):
        path = files.path(f"nrrd/{name}")
        header = end.join([version, *lines, "", ""]).encode()
        text = header + data
        path.write_bytes(gzip.compress(text) if name.endswith(".gz") else text)
        files.add(path, "by hand", options, grid, own)

    def basic(grid, kind="short", encoding="raw"):
        used = [f"type: {kind}", "dimension: 3", "sizes: " + " ".join(map(str, grid.dims)), f"encoding: {encoding}"]
        return used + ["endian: little"]

    def placed(grid, space):
        matrix, origin = in_space(grid, space)
        return [f"space: {space}", "space directions: " + " ".join(map(vector, matrix.T)), f"space origin: {vector(origin)}"]

    for n, version in enumerate(["NRRD00.01", "NRRD0001", "NRRD0002", "NRRD0003", "NRRD0004", "NRRD0005"]):
        grid = Grid(n, "int16").unplaced()
        if n >= 4:
            grid = Grid(n, "int16")
            lines = basic(grid) + placed(grid, "LPS")
        else:
            lines = basic(grid) + ["spacings: " + " ".join(map(repr, grid.spacing.tolist()))]
        if n >= 2:
            lines += ["key:=value: with a colon", "# a comment"]
        write(f"magic_{n}.nrrd", grid, version, lines, grid.bytes(), version)
    for n, kind in enumerate(["signed short int", "int16_t", "int16", "signed short"]):
        grid = Grid(n + 3, "int16")
        write(f"type_{n}.nrrd", grid, f"type: {kind}", basic(grid, kind) + placed(grid, "RAS"), grid.bytes())
    grid = Grid(12, "int16")
    lines = basic(grid) + placed(grid, "RAS")
    write("crlf.nrrd", grid, "lines that end with CR LF", lines, grid.bytes(), end="\r\n")
    lines = basic(grid, encoding="txt") + placed(grid, "RAS")
    text = ", ".join(map(str, grid.values.tolist()))
    write("commas.nrrd", grid, "text with commas", lines, text.encode())
    text = "\n".join(map(str, grid.values.tolist()))
    write("lines.nrrd", grid, "text, a number a line", lines, text.encode())
    lines = basic(grid, encoding="hex") + placed(grid, "RAS")
    text = "\n".join(grid.bytes().hex().upper()[k : k + 30] for k in range(0, 2 * len(grid.bytes()), 30))
    write("upper.nrrd", grid, "hex in upper case, lines of 30", lines, text.encode())
    lines = basic(grid) + placed(grid, "RAS")
    write("whole.nrrd.gz", grid, "the whole file through gzip", lines, grid.bytes(), own="no library reads it")

    # Fields that say nothing of place or values.
    lines = ["content: a thing: with colons", "number: 60", "block size: 1"][:1] + basic(grid) + placed(grid, "RAS")
    lines += ['labels: "x axis" "a \\"quoted\\" one" "z: up"', 'space units: "mm" "mm" "mm"', "thicknesses: nan nan 2"]
    lines += ["measurement frame: (1,0,0) (0,1,0) (0,0,1)", "kinds: space space space", "centerings: cell cell cell"]
    lines += ["old min: -5", "old max: 7", "min: 0", "max: 1", "sample units: mm", "a key:=of its: own", "# spacings: 9 9 9"]
    write("many_fields.nrrd", grid, "every other field", lines, grid.bytes())
    lines = [line.replace("sizes: ", "sizes:   ").replace(" 4", "  \t 4") for line in basic(grid)] + placed(grid, "RAS")
    lines = [line.replace(",", " , ") if "directions" in line else line for line in lines]
    write("blanks.nrrd", grid, "blanks within values", lines, grid.bytes())
    lines = placed(grid, "RAS")[:1] + ["dimension: 3"] + placed(grid, "RAS")[1:]
    lines += [line for line in basic(grid) if "dimension" not in line]
    write("order.nrrd", grid, "fields in another order", lines, grid.bytes())
    # Without an order of bytes where none is needed.
    small = Grid(17, "uint8")
    lines = basic(small, "uint8_t")[:-1] + placed(small, "LAS")
    write("no_endian.nrrd", small, "8 bits without endian", lines, small.bytes())
    lines = basic(grid, encoding="text")[:-1] + placed(grid, "LAS")
    text = " ".join(map(str, grid.values.tolist())).encode()
    write("no_endian_text.nrrd", grid, "text without endian", lines, text)
    for n, (dtype, kind) in enumerate([
        ("int8", "int8_t"), ("uint8", "unsigned char"), ("uint16", "unsigned short int"), ("int32", "signed int"),
        ("uint32", "uint32_t"), ("int64", "signed long long int"), ("uint64", "unsigned long long"), ("int64", "int64_t"),
    ]):  # fmt: skip
        other = Grid(n + 5, dtype)
        write(f"name_{n}.nrrd", other, f"type: {kind}", basic(other, kind) + placed(other, "LPS"), other.bytes())
    path = files.path("nrrd/block.nrrd")
    path.write_bytes(b"NRRD0004\ntype: block\nblock size: 3\ndimension: 3\nsizes: 2 2 2\nendian: little\nencoding: raw\n\n" + bytes(24))
    files.refuse(path, "by hand", "type: block", "block", "unu save cannot copy it")
    # Compressed data: lines are skipped before, bytes after they are unpacked.
    packed = gzip.compress(b"1234" + grid.bytes())
    for n, (skip, before) in enumerate([(["byte skip: 4"], b""), (["line skip: 1", "byte skip: 4"], b"a line\n")]):
        files.path(f"nrrd/packed_{n}.gz").write_bytes(before + packed)
        lines = basic(grid, encoding="gz") + placed(grid, "LPS") + skip + [f"data file: packed_{n}.gz"]
        write(f"packed_{n}.nhdr", grid, f"gz, {', '.join(skip)}", lines, b"")
    for n, (encoding, skip) in enumerate([("ascii", "line skip: 2"), ("hex", "line skip: 2")]):
        text = grid.bytes().hex() if encoding == "hex" else " ".join(map(str, grid.values.tolist()))
        files.path(f"nrrd/text_{n}.txt").write_text("one 1\ntwo 2\n" + text + "\n")
        lines = basic(grid, encoding=encoding) + placed(grid, "LPS") + [skip, f"data file: text_{n}.txt"]
        write(f"text_{n}.nhdr", grid, f"{encoding}, {skip}", lines, b"")
    files.path("nrrd/folder/data.raw").write_bytes(grid.bytes())
    lines = basic(grid) + placed(grid, "LPS") + ["data file: folder/data.raw"]
    write("in_folder.nhdr", grid, "a data file in a folder", lines, b"")
    lines = basic(grid) + placed(grid, "LPS") + [f"data file: {files.path('nrrd/folder/data.raw').resolve()}"]
    write("absolute.nhdr", grid, "a data file by its whole path", lines, b"")
    lines = basic(grid) + placed(grid, "LPS") + ["datafile: ./folder/data.raw"]
    write("synonym.nhdr", grid, "datafile", lines, b"")

    # A data file with lines and bytes before the voxels.
    for n, (skip, before) in enumerate([
        (["line skip: 2"], b"one\ntwo\n"),
        (["byte skip: 5"], b"12345"),
        (["line skip: 1", "byte skip: 3"], b"a line\n123"),
        (["byte skip: -1"], b"of any length"),
        (["line skip: 1", "byte skip: -1"], b"a line\nof any length"),
    ]):  # fmt: skip
        grid = Grid(n + 30, "int16")
        files.path(f"nrrd/skip_{n}.bin").write_bytes(before + grid.bytes())
        lines = basic(grid) + placed(grid, "LPS") + skip + [f"data file: skip_{n}.bin"]
        write(f"skip_{n}.nhdr", grid, ", ".join(skip), lines, b"")
    # Each of several files skips for itself.
    grid = Grid(31, "int16")
    part = grid.values.nbytes // grid.dims[2]
    for k in range(grid.dims[2]):
        files.path(f"nrrd/each_{k}.bin").write_bytes(b"head\nxy" + grid.bytes()[k * part : (k + 1) * part])
    lines = basic(grid) + placed(grid, "LPS") + ["line skip: 1", "byte skip: 2", "data file: LIST"]
    lines += [f"each_{k}.bin" for k in range(grid.dims[2])]
    path = files.path("nrrd/each.nhdr")
    path.write_text("\n".join(["NRRD0004", *lines, ""]))
    files.add(path, "by hand", "LIST, each file with lines and bytes before", grid)
    for k in range(grid.dims[2]):
        files.path(f"nrrd/part {k}.bin").write_bytes(grid.bytes()[k * part : (k + 1) * part])
    lines = basic(grid) + placed(grid, "LPS") + ["data file: LIST"] + [f"part {k}.bin" for k in range(grid.dims[2])]
    path = files.path("nrrd/blanks.nhdr")
    path.write_text("\n".join(["NRRD0004", *lines, ""]))
    files.add(path, "by hand", "LIST, names with blanks", grid)
    # Files of one row, and of two slices.
    grid = Grid(1, "int16", dims=(3, 4, 6))
    row = 3 * 2
    for k in range(24):
        files.path(f"nrrd/row_{k:02}.bin").write_bytes(grid.bytes()[k * row : (k + 1) * row])
    lines = basic(grid) + placed(grid, "LPS") + ["data file: row_%02d.bin 0 23 1 1"]
    write("rows.nhdr", grid, "files of one row", lines, b"", "NRRD0004")
    names = [f"row_{k:02}.bin" for k in range(24)]
    lines = basic(grid) + placed(grid, "LPS") + ["data file: LIST 1", *names]
    path = files.path("nrrd/list_1.nhdr")
    path.write_text("\n".join(["NRRD0004", *lines, ""]))
    files.add(path, "by hand", "LIST 1", grid)
    for k in range(6):
        files.path(f"nrrd/even_{2 + 3 * k}.bin").write_bytes(grid.bytes()[k * 24 : (k + 1) * 24])
    lines = basic(grid) + placed(grid, "LPS") + ["data file: even_%d.bin 2 17 3"]
    write("even.nhdr", grid, "every third of a pattern", lines, b"", "NRRD0004")
    for k in range(2):
        files.path(f"nrrd/half_{k}.bin").write_bytes(grid.bytes()[k * 72 : (k + 1) * 72])
    lines = basic(grid) + placed(grid, "LPS") + ["data file: half_%d.bin 0 1 1 3"]
    write("halves.nhdr", grid, "files of three slices", lines, b"", "NRRD0004")
    for k in range(6):
        files.path(f"nrrd/zip_{k}.gz").write_bytes(gzip.compress(grid.bytes()[k * 24 : (k + 1) * 24]))
    lines = basic(grid, encoding="gzip") + placed(grid, "LPS") + ["data file: zip_%d.gz 0 5 1"]
    write("zips.nhdr", grid, "slices through gzip", lines, b"", "NRRD0004")
