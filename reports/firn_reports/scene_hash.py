# SPDX-License-Identifier: BSD-3-Clause
"""Which scene a result belongs to, as firn/scene_hash.hpp computes it."""


def scene_hash(resolved_toml: str) -> str:
    """64-bit FNV-1a, in hexadecimal, of a scene's resolved text.

    Keys of [time] that change no step, `end` and `frames_per_second`, are left out.
    """
    value = 0xCBF29CE484222325
    in_time = False
    for line in resolved_toml.splitlines(keepends=True):
        if line.startswith("["):
            in_time = line.startswith("[time]")
        if in_time and line.startswith(("end = ", "frames_per_second = ")):
            continue
        for byte in line.encode():
            value = ((value ^ byte) * 0x100000001B3) % 2**64
    return f"{value:016x}"
