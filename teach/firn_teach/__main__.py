# SPDX-License-Identifier: BSD-3-Clause
"""python -m firn_teach lesson.json -o DIR [--web-module firn_web.js]"""

import argparse
import sys

from firn_reports import InputError

from . import lesson, pages


def tell(message: str) -> int:
    """One line on stderr; exit status 2."""
    print("firn teach:", " ".join(message.split()), file=sys.stderr)
    return 2


def main(arguments: list[str] | None = None) -> int:
    """Exit status: 0, or 2 for bad input."""
    parser = argparse.ArgumentParser(
        "firn teach", description="The pages of a lesson from its lesson.json."
    )
    parser.add_argument("lesson", metavar="LESSON", help="lesson.json, written by `firn teach`")
    parser.add_argument(
        "-o", "--output", default="lesson", metavar="DIR", help="folder for the pages"
    )
    parser.add_argument(
        "--web-module",
        default="",
        metavar="JS",
        help="the reference as WebAssembly, web/firn_web.js of a build with Emscripten",
    )
    parser.add_argument(
        "--input",
        action="append",
        default=[],
        metavar="FILE",
        help="a file that the lesson was made from: no page takes its place",
    )
    parser.add_argument(
        "--force",
        action="store_true",
        help="replace existing files even if Firn did not write them",
    )
    options = parser.parse_args(arguments)
    try:
        made = lesson.read(options.lesson)
        inputs = [options.lesson, *options.input]
        print(pages.write(made, options.output, options.web_module, inputs, options.force))
        return 0
    except (InputError, OSError) as error:
        return tell(str(error))
    except Exception as error:  # a lesson that no check has thought of
        return tell(f"{options.lesson}: cannot be shown: {type(error).__name__}: {error}")


if __name__ == "__main__":
    sys.exit(main())
