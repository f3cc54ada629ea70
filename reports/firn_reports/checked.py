# SPDX-License-Identifier: BSD-3-Clause
"""Values of an HDF5 file that may hold anything."""

from collections.abc import Sequence

import h5py
import numpy as np

from . import InputError
from .kinds import Array


def where(node: h5py.HLObject) -> str:
    """FILE: /path."""
    return f"{node.file.filename}: {node.name}"


def numbers(
    group: h5py.Group, name: str, shape: Sequence[int | None], finite: bool = True
) -> Array:
    """A dataset of numbers with as many axes as `shape`; None: any length.

    Raises InputError if it is no such dataset or holds a number that is not finite.
    """
    data = group.get(name)
    if not isinstance(data, h5py.Dataset):
        raise InputError(f"{where(group)}/{name}: got no dataset, allowed: a dataset of numbers")
    if data.dtype.kind not in "fiu":
        raise InputError(f"{where(data)}: type: got {data.dtype}, allowed: numbers")
    got = data.shape
    fits = (
        got is not None
        and len(got) == len(shape)
        and all(want in (None, n) for n, want in zip(got, shape, strict=True))
    )
    if not fits:
        allowed = ",".join("n" if want is None else str(want) for want in shape)
        raise InputError(f"{where(data)}: shape: got {got}, allowed: ({allowed})")
    values: Array = data[()].astype(float)
    if finite and not np.isfinite(values).all():
        place = tuple(int(i) for i in np.argwhere(~np.isfinite(values))[0])
        raise InputError(
            f"{where(data)}: value {list(place)}: got {values[place]}, allowed: finite"
        )
    return values


def text(group: h5py.HLObject, name: str, allowed: Sequence[str] = ()) -> str:
    """An attribute that is one string, one of `allowed` if that is given.

    Raises InputError.
    """
    value = group.attrs.get(name)
    if isinstance(value, bytes):
        value = value.decode("utf-8", "replace")
    if not isinstance(value, str) or (allowed and value not in allowed):
        raise InputError(
            f"{where(group)}: attribute {name}: got {value!r}, "
            f"allowed: {', '.join(allowed) if allowed else 'a string'}"
        )
    return value
