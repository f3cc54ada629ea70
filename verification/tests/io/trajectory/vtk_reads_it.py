# SPDX-License-Identifier: BSD-3-Clause
"""VTK's own reader opens what Firn writes: finished, in float, and cut off at any write.

    vtk_reads_it.py KILL_RUN KILL_SHIM

Compares times, points and all arrays of every time step with what h5py reads at
the place that docs/files.md gives. VTK >= 9.3 (ParaView >= 5.12).
"""

import os
import subprocess
import sys
import tempfile

import h5py
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkVersion
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline
from vtkmodules.vtkIOHDF import vtkHDFReader

ARRAYS = {"velocity": 3, "mass": 1, "volume": 1, "F_E": 9, "F_P": 9, "id": 1, "material": 1}


def expect(condition: object, what: str) -> None:
    """Exits with a message unless the condition holds."""
    if not condition:
        raise SystemExit(f"vtk_reads_it.py: {what}")


def compare(path: str) -> int:
    """Reads every time step with VTK; returns how many there are."""
    with h5py.File(path, "r") as file:
        steps = file["VTKHDF/Steps"]
        frames = min(int(steps.attrs["NSteps"]), len(steps["Values"]))
        times = steps["Values"][:frames]
        particles = int(file["VTKHDF/NumberOfPoints"][0])
        points = file["VTKHDF/Points"][:]
        arrays = {name: file[f"VTKHDF/PointData/{name}"][:] for name in ARRAYS}

    reader = vtkHDFReader()
    reader.SetFileName(path)
    reader.UpdateInformation()
    information = reader.GetOutputInformation(0)
    key = Pipeline.TIME_STEPS()
    found = [information.Get(key, i) for i in range(information.Length(key))]
    if frames > 1:  # VTK lists no times for a single one
        expect(found[:frames] == list(times), f"{path}: times {found} are not {list(times)}")

    for k, time in enumerate(times):
        rows = slice(k * particles, (k + 1) * particles)
        reader.UpdateTimeStep(time) if frames > 1 else reader.Update()
        data = reader.GetOutputDataObject(0)
        where = f"{path}, frame {k}"
        expect(data.GetClassName() == "vtkPolyData", f"{where}: {data.GetClassName()}")
        expect(data.GetNumberOfVerts() == particles, f"{where}: {data.GetNumberOfVerts()} vertices")
        seen = vtk_to_numpy(data.GetPoints().GetData())
        expect(seen.dtype == points.dtype, f"{where}: points are {seen.dtype}")
        expect(np.array_equal(seen, points[rows]), f"{where}: points differ")
        expect(
            data.GetPointData().GetNumberOfArrays() == len(ARRAYS), f"{where}: arrays are missing"
        )
        for name, components in ARRAYS.items():
            array = data.GetPointData().GetArray(name)
            expect(array is not None, f"{where}: {name} is missing")
            expect(array.GetNumberOfComponents() == components, f"{where}: components of {name}")
            expect(
                np.array_equal(vtk_to_numpy(array), arrays[name][rows]), f"{where}: {name} differs"
            )
    return frames


def units_everywhere(path: str) -> None:
    """Every data set of the file has the attribute `units`."""
    missing = []
    with h5py.File(path, "r") as file:
        file.visititems(
            lambda name, item: (
                missing.append(name)
                if isinstance(item, h5py.Dataset) and "units" not in item.attrs
                else None
            )
        )
    expect(not missing, f"{path}: no units at {missing}")


def main(kill_run: str, shim: str) -> None:
    """Compares finished files, then files cut off at every write."""
    print("VTK", vtkVersion.GetVTKVersion())
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "out.vtkhdf")
        for arguments in (["fixed"], ["adaptive"], ["fixed", "precision", "float"]):
            subprocess.run(
                [kill_run, arguments[0], path, *arguments[1:]],
                check=True,
                stdout=subprocess.DEVNULL,
            )
            units_everywhere(path)
            print(" ".join(arguments), "-", compare(path), "frames")

        # Cut off before its n-th write, for every n from the first complete frame on.
        cut_off = 0
        for n in range(1, 10_000):
            if os.path.exists(path):
                os.remove(path)
            environment = dict(os.environ, FIRN_KILL_AT=str(n), LD_PRELOAD=shim)
            environment["ASAN_OPTIONS"] = "verify_asan_link_order=0"
            status = subprocess.run(
                [kill_run, "fixed", path], env=environment, stdout=subprocess.DEVNULL, check=False
            )
            if status.returncode == 0:
                break
            if os.path.exists(path):
                compare(path)
                cut_off += 1
        expect(cut_off > 20, f"only {cut_off} runs were cut off with a file left")
        print("cut off -", cut_off, "files opened")


if __name__ == "__main__":
    main(*sys.argv[1:])
