"""Tells what the libraries of the formats read from files, a JSON line for each file and library.

    venv/bin/python read_back.py FILE …

A library that does not tell what its world is has the space null.
"""

import json
import sys

import write_files


def told(reading):
    from files import plain

    affine = reading.affine
    if affine is None:
        affine = [[0.0] * 4 for _ in range(4)]
        for axis in range(3):
            affine[axis][axis] = reading.spacing[axis]
            affine[axis][3] = float(reading.origin[axis]) if reading.origin is not None else 0.0
    return {
        "dims": reading.dims,
        "frames": reading.frames,
        "spacing": reading.spacing,
        "space": reading.space,
        "affine": [[float(n) for n in row] for row in affine],
        "placed": reading.affine is not None or reading.origin is not None,
        "values": [plain(v) for v in reading.values],
    }


def main():
    if write_files.missing():
        print(f"missing: {', '.join(write_files.missing())}", file=sys.stderr)
        return 3
    import readers

    for path in sys.argv[1:]:
        for library, read in readers.readers_of(path).items():
            # VTK turns slices and exchanges rows and columns of directions: no witness of places.
            if library == "VTK":
                continue
            line = {"file": path, "library": library}
            try:
                line |= told(read(path))
            except Exception as error:
                line["error"] = " ".join(str(error).split())[-160:]
            print(json.dumps(line))
    return 0


if __name__ == "__main__":
    sys.exit(main())
