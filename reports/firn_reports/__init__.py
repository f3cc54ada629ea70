"""Reads Firn's HDF5 files and tells what is in them on one HTML page.

trajectory.py, results.py   what the files hold
snowball.py                 a picture of the particles
*_page.py                   which figures and tables a page has
style.py, page.py           how they look
json_file.py, kinds.py      reading JSON; names of types
baseline.py                 what became faster or slower
"""

# What firn_teach builds on; every other module serves the report alone. The test
# layering.includes_follow_the_arrows reads this list.
__all__ = ["InputError", "json_file", "kinds", "page", "style"]


class InputError(Exception):
    """Bad input: one line with what, where, the value and what is allowed (exit 2)."""
