# SPDX-License-Identifier: BSD-3-Clause
"""The interactive page: its script, its style, and the solver as WebAssembly, all in one file."""

from importlib import resources
from pathlib import Path

HOW_TO = "./run teach"


def values(web_module: str) -> dict[str, str]:
    """Without the module the page says how to get it."""
    templates = resources.files("firn_teach").joinpath("templates")
    module = Path(web_module) if web_module else None
    text = module.read_text(encoding="utf-8") if module and module.is_file() else ""
    return {
        "module": text.replace("</script", "<\\/script"),
        "script": templates.joinpath("interactive.js").read_text(encoding="utf-8"),
        "style": templates.joinpath("interactive.css").read_text(encoding="utf-8"),
        "how_to": HOW_TO,
    }
