"""Makes small volumes with programs that are not cube3's, and tells what each file holds.

    python3 -m venv venv && venv/bin/pip install numpy nibabel SimpleITK pynrrd vtk
    apt-get install teem-apps
    venv/bin/python write_files.py FOLDER

FOLDER/files.jsonl has one file a line: its name, its writer, the grid that was written (sizes, affine from stored index to
the world, values), and in what the reading of each library differs from that. Where the format's own library reads another
grid than the one written, the script fails, unless the line says why ("own").
"""

import importlib.util
import shutil
import sys

MODULES = {"numpy": "numpy", "nibabel": "nibabel", "SimpleITK": "SimpleITK", "nrrd": "pynrrd", "vtkmodules": "vtk"}


def missing():
    found = [package for module, package in MODULES.items() if importlib.util.find_spec(module) is None]
    return found + ([] if shutil.which("unu") or shutil.which("teem-unu") else ["teem-apps (unu)"])


def main():
    if missing():
        print(f"missing: {', '.join(missing())}", file=sys.stderr)
        return 3
    import metaimage_files
    import nifti_files
    import nrrd_files
    from files import Files

    files = Files(sys.argv[1])
    for module in (nifti_files, nrrd_files, metaimage_files):
        for name in ("by_nibabel", "by_pynrrd", "by_teem", "by_itk", "by_vtk", "by_hand"):
            if hasattr(module, name):
                getattr(module, name)(files)
    files.save()
    for line in files.wrong:
        print(line, file=sys.stderr)
    return 1 if files.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
