"""The layering check must be able to fail: every rule is broken once in a tree of its own."""

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
]


def run(root):
    return subprocess.run(
        [sys.executable, str(SCRIPT), str(root)], capture_output=True, text=True, check=False
    )


class Layering(unittest.TestCase):
    def test_every_case(self):
        for path, line, allowed in CASES:
            with self.subTest(path=path, line=line), tempfile.TemporaryDirectory() as folder:
                # The files meant are there, so that relative includes resolve.
                for other, _, _ in CASES:
                    (Path(folder) / other).parent.mkdir(parents=True, exist_ok=True)
                    (Path(folder) / other).touch()
                for header in ("reference/svd.hpp", "firn/types.hpp"):
                    (Path(folder) / header).touch()
                (Path(folder) / path).write_text(f"// first line\n{line}\n")
                found = list(crossings(Path(folder)))
                self.assertEqual(len(found), 0 if allowed else 1, found)
                if not allowed and path.endswith("pp"):
                    self.assertTrue(found[0].startswith(f"{path}:2: includes"), found)

    def test_the_script_as_a_program(self):
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
