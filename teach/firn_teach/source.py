# SPDX-License-Identifier: BSD-3-Clause
"""The reference's own source, as the build embedded it."""

import hashlib
import html
import re

from . import STAGES
from .lesson import Lesson

CPP_WORDS = (
    "const constexpr void double int bool auto for if else return namespace struct class static inline while switch case break continue "
    "using template true false std this throw try catch enum public private explicit override final"
)
PYTHON_WORDS = (
    "def return for if else elif in not and or lambda import from continue None True False while"
)


def tokens(comment: str, directive: str, words: str) -> re.Pattern[str]:
    """Finds comments, strings, directives, key words and numbers of a language."""
    keyword = r"\b(?:" + "|".join(words.split()) + r")\b"
    return re.compile(
        rf'(?P<comment>{comment}[^\n]*)|(?P<string>"(?:\\.|[^"\\\n])*")|(?P<directive>{directive})|(?P<keyword>{keyword})|(?P<number>\b\d[\w.]*(?:e[+-]\d+)?)',
        re.MULTILINE,
    )


CPP = tokens("//", r"^[ \t]*#[^\n]*", CPP_WORDS)
PYTHON = tokens("#", r"^@\w+", PYTHON_WORDS)


def highlight(text: str, language: re.Pattern[str] = CPP) -> str:
    """HTML of a source with classes on tokens; the text itself is unchanged."""
    out, end = [], 0
    for match in language.finditer(text):
        out.append(html.escape(text[end : match.start()], quote=False))
        out.append(
            f'<span class="{(match.lastgroup or "?")[0]}">{html.escape(match[0], quote=False)}</span>'
        )
        end = match.end()
    return "".join(out) + html.escape(text[end:], quote=False)


def path_of(stage: int) -> str:
    """The file of the reference that holds a stage."""
    return f"reference/step_{stage:02d}_{STAGES[stage - 1]}.cpp"


# The files whose functions a step's file calls.
CALLED = {
    1: ["transfer.cpp"],
    3: ["constitutive.cpp", "transfer.cpp"],
    7: ["transfer.cpp", "constitutive.cpp"],
    8: ["transfer.cpp"],
}


def called_by(stage: int) -> list[str]:
    """The files of the reference with the formulas that a stage calls by name."""
    return [f"reference/{name}" for name in CALLED.get(stage, [])]


class File:
    """A source file of the reference with its highlighted text."""

    def __init__(self, lesson: Lesson, path: str) -> None:
        self.path, self.text = path, lesson.sources[path]
        self.html = highlight(self.text)
        self.lines = self.text.count("\n")
        self.sha256 = hashlib.sha256(self.text.encode()).hexdigest()
