"""Reads Firn's HDF5 files and tells what is in them on one HTML page.

trajectory.py, results.py   what the files hold
snowball.py                 a picture of the particles
*_page.py                   which figures and tables a page has
style.py, page.py           how they look
baseline.py                 what became faster or slower
"""


class InputError(Exception):
    """Bad input: one line with what, where, the value and what is allowed (exit 2)."""
