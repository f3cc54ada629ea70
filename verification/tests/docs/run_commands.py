#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""run_commands.py ROOT BIN: runs every `firn` command that documents and pages print.

Documents are README.md, CONTRIBUTING.md, docs/ and the README of each folder (docs/guests.md has
a test of its own); pages are a report and a lesson, made here. What would take long is cut
short: fewer steps, lists instead of measurements. Exits 1 if a command fails, or too few are found.
"""

import html
import os
import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

VERBS = "run|check|compare|verify|bench|report|teach|info|scenes|solvers"
COMMAND = re.compile(rf"^!? ?(?:build/release/bin/)?firn (?:{VERBS})\b.*")
# Words that stand for something of the reader's.
PLACEHOLDER = re.compile(
    r"\b(SCENE|FILE|SUITE|YOURS|NAME|COMMAND|VERB|NEW|OLD|P)\b|…|\{|libmine|mine\.py|wrong|\bA B\b"
)


def fenced(text: str) -> list[str]:
    """Commands in blocks of sh."""
    blocks = re.findall(r"^ *```sh\n(.*?)^ *```", text, re.MULTILINE | re.DOTALL)
    return [line.strip() for block in blocks for line in block.splitlines()]


def inline(text: str) -> list[str]:
    """Commands in running text, with arguments: `firn check` alone is a name."""
    return [c for c in re.findall(r"`([^`\n]+)`", text) if len(c.split()) > 2]


def printed(page: str) -> list[str]:
    """Commands on a page."""
    blocks = re.findall(r"<(?:code|pre)[^>]*>(.*?)</(?:code|pre)>", page, re.DOTALL)
    lines = [line for block in blocks for line in html.unescape(block).splitlines()]
    return [re.sub(r"<[^>]+>|^\$ ", "", line).strip() for line in lines]


def commands(lines: list[str]) -> list[str]:
    """Those that can be run as they stand, each once, without comments."""
    found = []
    for line in lines:
        text = re.sub(r"\s+#.*$|;\s*echo.*$", "", line)
        if COMMAND.match(text) and not PLACEHOLDER.search(text) and text not in found:
            found.append(text)
    return found


def shortened(words: list[str]) -> list[str] | None:
    """The same command with less to do; None if it needs a file that is not here."""
    verb = words[1]
    if verb == "run":
        return [*words, "--steps", "2", *([] if "-o" in words else ["-o", "run.vtkhdf"])]
    if verb == "check" and "--steps" not in words:
        return [*words, "--steps", "1"]
    if verb == "verify":
        return None if "--svd" in words else [*words, "--list"]
    if verb == "bench":
        return [*words, "--list"]
    files = [w for w in words[2:] if w.endswith((".h5", ".vtkhdf", ".json"))]
    return words if all(Path(f).exists() for f in files) else None


def in_shell(command: str, programs: Path) -> str | None:
    """A command of several programs, as it stands; a run of it may fail with exit status 3."""
    done = subprocess.run(
        ["bash", "-c", command],
        env=os.environ | {"PATH": f"{programs}:{os.environ['PATH']}"},
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode in (0, 3):
        return None
    return f"exit {done.returncode}: {done.stderr.strip()[-300:]}"


def run(command: str, programs: Path) -> str | None:
    """What is wrong with the command; None if nothing is."""
    fails = command.startswith("!")
    if "|" in command or "&&" in command:
        return in_shell(command, programs)
    words = shlex.split(command.lstrip("! "))
    short = shortened(words)
    if short is None:
        return None
    wrong = words[1] == "check" and any(w.startswith(("mutant:", "exercise:")) for w in words)
    done = subprocess.run(
        [str(programs / "firn"), *short[1:]], capture_output=True, text=True, check=False
    )
    # A wrong solver need not show in every step: it must not be refused.
    allowed = {1, 2, 3} if fails else {0, 1} if wrong else {0}
    if done.returncode in allowed:
        return None
    return f"{shlex.join(short)}: exit {done.returncode}: {done.stderr.strip()[-300:]}"


def documents(root: Path) -> list[str]:
    """All that the documents print."""
    paths = [root / "README.md", root / "CONTRIBUTING.md", *(root / "docs").glob("*.md")]
    paths += [p for p in root.glob("*/README.md") if p.parent.name != "build"]
    lines = []
    for path in sorted(set(paths)):
        text = path.read_text(encoding="utf-8")
        lines += inline(text) if path.name == "guests.md" else fenced(text) + inline(text)
    return lines


def pages(programs: Path) -> list[str]:
    """All that a report and a lesson print, both of a built-in scene with a blank in its name."""
    firn = str(programs / "firn")

    def make(*words: str) -> str:
        return subprocess.run([firn, *words], capture_output=True, text=True, check=True).stdout

    make("run", "tiny_impact", "--steps", "3", "-o", "tiny_impact.vtkhdf")
    Path("check.json").write_text(make("check", "tiny_impact", "--steps", "1", "--json"))
    make("report", "tiny_impact.vtkhdf", "--check", "check.json", "-o", "page")
    make("teach", "tiny_impact", "-o", "lesson")
    return [
        line
        for path in [*Path("page").rglob("*.html"), *Path("lesson").rglob("*.html")]
        for line in printed(path.read_text(encoding="utf-8"))
    ]


def main(root: Path, programs: Path) -> int:
    """0 if every command works."""
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for name in ("examples", "scenes"):
            Path(name).symlink_to(root / name)
        failed = 0
        for what, lines, least in (
            ("documents", documents(root), 15),
            ("pages", pages(programs), 10),
        ):
            found = commands(lines)
            print(f"{what}: {len(found)} commands")
            if len(found) < least:
                print(f"too few: at least {least} were expected")
                failed += 1
            for command in found:
                if (fault := run(command, programs)) is not None:
                    print(f"FAILED {command}\n  {fault}")
                    failed += 1
                else:
                    print(f"ok     {command}")
        # The test can fail: a scene with a blank in its name, unquoted.
        if run("firn check snowball drop", programs) is None:
            print("a wrong command was not noticed")
            failed += 1
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()))
