# SPDX-License-Identifier: BSD-3-Clause
"""$x$ and $$x$$ in a text become MathML, which browsers show without fonts or scripts of ours."""

import re

from latex2mathml.converter import convert

# What the chapters write for the symbols of the method.
MACROS = {
    r"\F": r"\mathbf{F}",
    r"\R": r"\mathbf{R}",
    r"\S": r"\mathbf{S}",
    r"\U": r"\mathbf{U}",
    r"\V": r"\mathbf{V}",
    r"\P": r"\mathbf{P}",
    r"\I": r"\mathbf{I}",
    r"\H": r"\mathbf{H}",
    r"\W": r"\mathbf{W}",
    r"\A": r"\mathbf{A}",
    r"\C": r"\mathbf{C}",
    r"\B": r"\mathbf{B}",
    r"\v": r"\mathbf{v}",
    r"\x": r"\mathbf{x}",
    r"\f": r"\mathbf{f}",
    r"\g": r"\mathbf{g}",
    r"\n": r"\mathbf{n}",
    r"\u": r"\mathbf{u}",
    r"\b": r"\mathbf{b}",
    r"\dt": r"\Delta t",
    r"\FE": r"\mathbf{F}_{E}",
    r"\FP": r"\mathbf{F}_{P}",
    r"\RE": r"\mathbf{R}_{E}",
    r"\JE": r"J_{E}",
    r"\JP": r"J_{P}",
    r"\Fhat": r"\hat{\mathbf{F}}_{E}",
    r"\Vp": r"V_{p}^{0}",
    r"\vstar": r"\mathbf{v}_{i}^{*}",
    r"\vnew": r"\mathbf{v}_{i}^{n+1}",
    r"\vold": r"\mathbf{v}_{i}^{n}",
    r"\grad": r"\nabla w_{ip}",
    r"\w": r"w_{ip}",
    r"\T": r"{T}",
}
# Bold letters of the mathematical alphabets need a font that has them; bold type does not.
ALPHABETS = [(0x1D400, "A"), (0x1D41A, "a")]


def _bold(match: re.Match[str]) -> str:
    letter = match[1]
    for start, first in ALPHABETS:
        if 0 <= ord(letter) - start < 26:
            letter = chr(ord(first) + ord(letter) - start)
    return f'<mi mathvariant="normal" class="b">{letter}</mi>'


def formula(tex: str, display: bool = False) -> str:
    """MathML of a formula in TeX."""
    for _ in range(2):  # macros may stand for macros
        tex = re.sub(r"\\[A-Za-z]+", lambda m: MACROS.get(m[0], m[0]), tex)
    text = convert(tex, display="block" if display else "inline")
    text = re.sub(r"&#x([0-9A-Fa-f]+);", lambda m: chr(int(m[1], 16)), text)
    text = re.sub(r"<mi>([\U0001D400-\U0001D433])</mi>", _bold, text)
    text = re.sub(r'<mi mathvariant="bold">(.)</mi>', _bold, text)
    return re.sub(
        r"<(m[on])>([<&>])</\1>",
        lambda m: f"<{m[1]}>{ {'<': '&lt;', '&': '&amp;', '>': '&gt;'}[m[2]] }</{m[1]}>",
        text,
    )


def render(text: str) -> str:
    """HTML with its formulas converted."""
    text = re.sub(
        r"\$\$(.+?)\$\$",
        lambda m: (
            f'<div class="equation" tabindex="0" role="region" aria-label="equation">{formula(m[1], True)}</div>'
        ),
        text,
        flags=re.DOTALL,
    )
    return re.sub(r"\$(.+?)\$", lambda m: formula(m[1]), text, flags=re.DOTALL)
