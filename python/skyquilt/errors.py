"""Errors. Their messages say what was found and how to fix it."""
from __future__ import annotations

import os
import pathlib


class Error(Exception):
    """Of any of the kinds below."""


class UsageError(Error, ValueError):
    """A wrong argument, option or configuration (exit status 2 of the program)."""


class InputError(Error, ValueError):
    """A file or its content cannot be used (exit status 3). `file` is its path."""

    def __init__(self, message: str, file: str | os.PathLike[str] = ""):
        super().__init__(message)
        self.file = pathlib.Path(file)

    def __reduce__(self):
        return InputError, (str(self), self.file)


class BlockError(Error, RuntimeError):
    """The training of a block failed after all tries; the others are saved (exit status 4)."""


class Interrupted(Error, RuntimeError):
    """Work that another thread of this process cancelled. Its state is saved; the same call continues."""
