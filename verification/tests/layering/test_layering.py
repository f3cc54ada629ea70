# SPDX-License-Identifier: BSD-3-Clause
"""The layering check must be able to fail: every rule is broken once in a tree of its own."""

import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from check_layering import crossings

SCRIPT = Path(__file__).with_name("check_layering.py")

# file, what it includes, allowed?
CASES = [
    ("firn/state.hpp", '#include "firn/types.hpp"', True),
    ("firn/state.hpp", '#include "reference/svd.hpp"', False),
    ("firn/state.hpp", '#include "io/trajectory/reader.hpp"', False),
    ("reference/svd.cpp", '#include "firn/types.hpp"', True),
    ("reference/svd.cpp", '#include "optimized/math/svd-inl.h"', False),
    ("reference/svd.cpp", "#  include <optimized/math/svd-inl.h>", False),
    ("optimized/math/svd.cpp", '#include "reference/svd.hpp"', False),
    ("optimized/math/svd.cpp", '#include "../../reference/svd.hpp"', False),
    ("optimized/math/svd.cpp", '#define HWY_TARGET_INCLUDE "reference/svd.hpp"', False),
    ("optimized/math/svd.cpp", '#define HWY_TARGET_INCLUDE "optimized/math/svd.cpp"', True),
    ("simulation/simulate.cpp", '#include "firn/solver.hpp"', True),
    ("simulation/simulate.cpp", '#include "reference/reference_solver.hpp"', False),
    ("simulation/simulate.cpp", '#include "solvers/solvers.hpp"', False),
    ("verification/check/bounds.cpp", '#include "reference/stencil.hpp"', False),
    ("verification/check/bounds.cpp", '#include "solvers/solvers.hpp"', False),
    ("verification/studies/map.cpp", '#include "verification/oracles/exact.hpp"', True),
    ("verification/studies/map.cpp", '#include "verification/suite/run.hpp"', False),
    ("verification/studies/map.cpp", '#include "bench/timing.hpp"', False),
    ("verification/tests/check/test.cpp", '#include "solvers/solvers.hpp"', True),
    ("verification/suite/test.cpp", '#include "optimized/drivers/solver.hpp"', False),
    ("verification/suite/test.cpp", '#include "solvers/solvers.hpp"', False),
    ("verification/tests/solvers/test.cpp", '#include "solvers/solvers.hpp"', True),
    ("verification/tests/solvers/test.cpp", '#include "guests/guests.hpp"', False),
    ("guests/guests.cpp", '#include "verification/check/check.hpp"', False),
    ("bench/steps.cpp", '#include "cli/options.hpp"', False),
    ("io/trajectory/reader.cpp", '#include "simulation/simulate.hpp"', False),
    ("verification/suite/test.cpp", '#include "cli/progress.hpp"', False),
    ("verification/tests/reference/test_svd.cpp", '#include "reference/svd.hpp"', True),
    ("verification/tests/reference/test_svd.cpp", '#include "optimized/drivers/solver.hpp"', False),
    ("verification/tests/optimized/test_svd.cpp", '#include "optimized/drivers/solver.hpp"', True),
    ("verification/tests/optimized/test_svd.cpp", '#include "reference/svd.hpp"', False),
    ("bench/steps.cpp", '#include "solvers/solvers.hpp"', True),
    ("bench/steps.cpp", '#include "reference/reference_solver.hpp"', False),
    ("solvers/solvers.cpp", '#include "reference/reference_solver.hpp"', True),
    ("cli/run.cpp", '#include "reference/reference_solver.hpp"', False),
    ("cli/run.cpp", '#include "verification/check/check.hpp"', True),
    ("reports/firn_reports/page.py", "import h5py", True),
    ("reports/firn_reports/page.py", "import ctypes", False),
    ("reports/firn_reports/page.py", "from subprocess import run", False),
    ("reports/firn_reports/page.py", "from . import style", True),
    ("reports/firn_reports/page.py", "from firn_teach import lesson", False),
    ("reports/tests/test_page.py", "import firn_teach.lesson", False),
    ("reports/tests/test_page.py", "from firn_reports import results", True),
    ("teach/firn_teach/lesson.py", "from firn_reports import InputError", True),
    ("teach/firn_teach/lesson.py", "from firn_reports.page import Figure", True),
    ("teach/firn_teach/lesson.py", "import firn_reports.page as reports", True),
    ("teach/firn_teach/lesson.py", "from firn_reports import page, results", False),
    ("teach/firn_teach/lesson.py", "    from firn_reports.results import read", False),
    ("teach/firn_teach/lesson.py", "import firn_reports", False),
    ("teach/firn_teach/lesson.py", "import subprocess", True),
    ("examples/python/mpm.py", "import firn_reports.results", False),
    ("examples/python/mpm.py", "import numpy", True),
]
# What firn_teach may see of firn_reports.
PUBLIC = '__all__ = ["InputError", "page"]\n'


def run(root: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, str(SCRIPT), str(root)], capture_output=True, text=True, check=False
    )


class Layering(unittest.TestCase):
    def test_every_case(self) -> None:
        for path, line, allowed in CASES:
            with self.subTest(path=path, line=line), tempfile.TemporaryDirectory() as folder:
                # The files meant are there, so that relative includes resolve.
                for other, _, _ in CASES:
                    (Path(folder) / other).parent.mkdir(parents=True, exist_ok=True)
                    (Path(folder) / other).touch()
                for header in ("reference/svd.hpp", "firn/types.hpp"):
                    (Path(folder) / header).touch()
                (Path(folder) / "reports/firn_reports/__init__.py").write_text(PUBLIC)
                first = "if True:" if line.startswith(" ") else "# first line"
                first = first if path.endswith(".py") else "// first line"
                (Path(folder) / path).write_text(f"{first}\n{line}\n")
                found = list(crossings(Path(folder)))
                self.assertEqual(len(found), 0 if allowed else 1, found)
                if not allowed:
                    self.assertRegex(found[0], rf"^{re.escape(path)}:2: (includes|imports) ")

    def test_the_script_as_a_program(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(run(folder).returncode, 1, "an empty tree is not a pass")
            source = Path(folder) / "firn" / "state.cpp"
            source.parent.mkdir()
            source.write_text('#include "firn/state.hpp"\n')
            self.assertEqual(run(folder).returncode, 0)
            source.write_text('#include "reference/svd.hpp"\n')
            result = run(folder)
            self.assertEqual(result.returncode, 1)
            self.assertIn("firn/state.cpp:1: includes reference/svd.hpp", result.stdout)


if __name__ == "__main__":
    unittest.main()
