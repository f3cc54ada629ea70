# SPDX-License-Identifier: BSD-3-Clause
"""Reads Firn's HDF5 files and tells what is in them on one HTML page.

trajectory.py, results.py   what the files hold
trajectory_*.py, laws.py    the page of a trajectory
snowball.py                 a picture of the particles; camera.py, tracing.py, colliders.py serve it
results_*.py                the page of results: its top, its sections, figures, tables
accuracy*.py, implicit.py, limits.py, float_accuracy.py, roofline.py, *_figures.py
                            figures and tables of the suites
baseline.py, highlights.py  what became faster or slower, and what deserves a look
readme_table.py             the summary as Markdown
style.py, drawing.py        how figures look
page.py, output.py          what a page is made of; where it may be written
json_file.py, kinds.py      reading JSON; names of types
"""

# What firn_teach builds on; every other module serves the report alone. The test
# layering.includes_follow_the_arrows reads this list.
__all__ = ["InputError", "json_file", "kinds", "output", "page", "style"]


class InputError(Exception):
    """Bad input: one line with what, where, the value and what is allowed (exit 2)."""
