# SPDX-License-Identifier: BSD-3-Clause
"""Commands of the exercises, run on this machine while the pages are made, for their answers."""

import json
import os
import subprocess
import tempfile
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from firn_reports.kinds import Json


def run(command: str, program: str) -> Json:
    """What a shell command that ends in a `firn … --json` prints, parsed.

    Its exit status stands under "exit". Raises RuntimeError if it printed no JSON.
    """
    with tempfile.TemporaryDirectory(prefix="firn-teach-") as folder:
        environment = os.environ | {"PATH": f"{Path(program).parent}:{os.environ.get('PATH', '')}"}
        done = subprocess.run(
            ["bash", "-c", command],
            cwd=folder,
            env=environment,
            capture_output=True,
            check=False,
            text=True,
            timeout=120,
        )
    try:
        return json.loads(done.stdout) | {"exit": done.returncode}
    except (json.JSONDecodeError, TypeError):
        message = done.stderr.strip().splitlines()
        raise RuntimeError(
            f"{command}: exit {done.returncode}: {message[-1] if message else 'no output'}"
        ) from None


def run_all(commands: Iterable[str], program: str) -> list[Json]:
    """In the order of `commands`; two at a time."""
    with ThreadPoolExecutor(max_workers=2) as pool:
        return list(pool.map(lambda command: run(command, program), commands))
