# SPDX-License-Identifier: BSD-3-Clause
"""Reading JSON that another program wrote."""

import json
from pathlib import Path
from typing import Any

from . import InputError


def read(path: str | Path) -> Any:
    """The value that the file holds.

    Raises InputError with the line of the first mistake, OSError if there is no such file.
    """
    try:
        return json.loads(Path(path).read_text(encoding="utf-8"))
    except json.JSONDecodeError as error:
        raise InputError(f"{path}: line {error.lineno}: not JSON: {error.msg}") from None
