"""Runs nsfd, nonsmooth fracture dynamics, and reads what it writes.

    import nsfd

    results = nsfd.run("prm/quickstart.prm", Time={"end": "40 us"})
    results.history["time"], results.fields[-1]["displacement"], results.ok

doc/python.md has more."""

from .errors import (
    Error,
    FolderError,
    InputError,
    NotSolved,
    Problem,
    ProgramError,
    Stopped,
)
from .fields import Grid, Series
from .results import Certificate, CertificateLine, Results, load, run
from .scene import Scene
from .study import Order, Study, study
from .table import Table

__all__ = [
    "Certificate",
    "CertificateLine",
    "Error",
    "FolderError",
    "Grid",
    "InputError",
    "NotSolved",
    "Order",
    "Problem",
    "ProgramError",
    "Results",
    "Scene",
    "Series",
    "Stopped",
    "Study",
    "Table",
    "load",
    "run",
    "study",
]
