# SPDX-License-Identifier: BSD-3-Clause
"""Rejects an #include or a Python import that crosses the layout's arrows (docs/architecture.md).

    firn <- reference        firn <- optimized        these two never see each other
    io reads and writes files and knows no solver
    verification and bench reach solvers through the composition root only, except the
    unit suites of a solver's own parts
    solvers/solvers.cpp is the one place that names concrete solvers
    reports is Python and reads HDF5 and nothing else
    teach sees the modules of reports that firn_reports names in __all__; reports never sees teach

Usage: check_layering.py ROOT; prints one line per crossing and exits 1 if there is any.
"""

import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path

FOLDERS = (
    "firn",
    "io",
    "simulation",
    "reference",
    "optimized",
    "guests",
    "verification",
    "solvers",
    "bench",
    "cli",
    "reports",
    "teach",
    "web",
    "examples",
)

# Folder (the longest match counts) -> what its files may include besides that folder itself.
# An entry is a folder or one header.
SOLVERS = "solvers/solvers.hpp"
ALLOWED = {
    "firn": [],
    "reference": ["firn"],
    "optimized": ["firn"],
    "io": ["firn"],
    "simulation": ["firn", "io"],
    # A guest's answers are files.
    "guests": ["firn", "io"],
    # The checker knows solvers as the interface has them.
    "verification/check": ["firn"],
    "verification/oracles": [
        "firn",
        "verification/support/random_numbers.hpp",
        "verification/support/scenes.hpp",
    ],
    # An experiment has two callers, and knows neither.
    "verification/studies": [
        "firn",
        "verification/oracles",
        "verification/check",
        "verification/support",
    ],
    # Wrong solvers are made of the right one's stages.
    "verification/mutants": ["firn", "reference"],
    "verification/support": ["firn", "io", "simulation", SOLVERS],
    # The suite judges any solver by the interface alone: no wrong solvers, no tests.
    "verification/suite": [
        "firn",
        "verification/check",
        "verification/oracles",
        "verification/studies",
        "verification/support",
    ],
    "verification/fuzz": ["firn", "io", "verification", SOLVERS],
    # Tests see the room that they test, the shared fixtures, and solvers by their names.
    "verification/tests": ["firn", "io", "simulation", "verification", SOLVERS],
    "verification/tests/bench": ["firn", "io", "bench", "verification", SOLVERS],
    "verification/tests/reference": ["firn", "reference", "verification"],
    "verification/tests/optimized": [
        "firn",
        "io",
        "simulation",
        "optimized",
        "verification",
        SOLVERS,
    ],
    # A project of its own, built against the installed package.
    "verification/tests/install/outside": ["firn", "io", "reference", "verification"],
    # The composition root.
    "solvers": ["firn", "reference", "optimized", "guests", "verification/mutants", "teach"],
    "bench": ["firn", "io", "verification", SOLVERS],
    # Kernels are measured one by one, below the interface of solvers.
    "bench/kernels": ["firn", "reference", "optimized", "bench"],
    "cli": ["firn", "io", "simulation", "guests", "verification", "bench", "teach", SOLVERS],
    "reports": [],
    # What an outsider has.
    "examples": ["firn/firn_guest.h"],
    # A lesson is about the reference, and its exercises are mutants.
    "teach": ["firn", "io", "reference", "verification/mutants"],
    "web": ["firn", "io", "reference"],
}

CPP = {".c", ".cc", ".cpp", ".h", ".hpp", ".inl", ".in"}
# Also the way in which SIMD code includes itself once per instruction set.
INCLUDE = re.compile(
    r'^\s*#\s*(?:include|define\s+HWY_TARGET_INCLUDE)\s*[<"]([^">]+)[">]', re.MULTILINE
)
# A report that called into a solver would no longer be a reader of files.
NOT_IN_REPORTS = {"ctypes", "cffi", "subprocess"}
# The project's own Python packages, and the folder that may import any module of each.
PACKAGES = {"firn_reports": "reports", "firn_teach": "teach"}


def rule_of(path: str) -> str:
    """The most specific key of ALLOWED that holds for the file at `path`."""
    keys = [key for key in ALLOWED if path == key or path.startswith(key + "/")]
    return max(keys, key=len)


def target_of(root: Path, file: Path, include: str) -> str | None:
    """The project's own file that an include names, or None for anybody else's."""
    for candidate in (root / include, file.parent / include):
        if candidate.is_file():
            relative = candidate.resolve().relative_to(root)
            if relative.parts[0] in FOLDERS:
                return relative.as_posix()
    # A header that does not exist (yet) still crosses if it names a folder of ours.
    first = include.split("/")[0]
    return include if "/" in include and first in FOLDERS else None


def allowed(rule: str, target: str) -> bool:
    """True if files under the key `rule` of ALLOWED may include `target`."""
    return any(
        target == entry or target.startswith(entry + "/") for entry in [rule, *ALLOWED[rule]]
    )


def include_crossings(root: Path, file: Path) -> Iterator[str]:
    """One text per #include of the file that its folder may not have."""
    path = file.relative_to(root).as_posix()
    text = file.read_text(encoding="utf-8")
    for match in INCLUDE.finditer(text):
        target = target_of(root, file, match[1])
        if target and not allowed(rule_of(path), target):
            line = text.count("\n", 0, match.start(1)) + 1
            yield f"{path}:{line}: includes {target}, which {rule_of(path)} may not see"


def imports_of(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """(line, module) of every absolute import; the last part of `from a import b` may be a name."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, name.name) for name in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            yield from ((node.lineno, f"{node.module}.{name.name}") for name in node.names)


def public_names(root: Path) -> set[str]:
    """What firn_reports lists in __all__."""
    init = root / "reports" / "firn_reports" / "__init__.py"
    tree = ast.parse(init.read_text(encoding="utf-8")) if init.is_file() else ast.Module([], [])
    for node in tree.body:
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__":
            return set(ast.literal_eval(node.value))
    return set()


def import_crossings(root: Path, file: Path) -> Iterator[str]:
    """One text per Python import of the file that its folder may not have."""
    path = file.relative_to(root).as_posix()
    folder = path.split("/")[0]
    for line, module in imports_of(ast.parse(file.read_text(encoding="utf-8"), path)):
        package, name = [*module.split("."), ""][:2]
        if package in NOT_IN_REPORTS and path.startswith("reports/firn_reports/"):
            yield f"{path}:{line}: imports {package}; reports read HDF5 and nothing else"
        if PACKAGES.get(package, folder) == folder:
            continue
        if folder == "teach" and name in public_names(root):
            continue
        public = ", but for what firn_reports has in __all__" if folder == "teach" else ""
        yield f"{path}:{line}: imports {module}, which {folder} may not see{public}"


def crossings(root: Path) -> Iterator[str]:
    """One text per crossing in the tree below `root`, and one if there is nothing to check."""
    root = root.resolve()
    seen = 0
    for folder in FOLDERS:
        for file in sorted((root / folder).rglob("*")) if (root / folder).is_dir() else []:
            if file.suffix == ".py":
                seen += 1
                yield from import_crossings(root, file)
            elif file.suffix in CPP and file.is_file():
                seen += 1
                yield from include_crossings(root, file)
    if seen == 0:
        yield f"{root}: no source file found, nothing was checked"


def main() -> int:
    """Exit status: 1 if there is a crossing."""
    found = list(crossings(Path(sys.argv[1])))
    for line in found:
        print(line)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
