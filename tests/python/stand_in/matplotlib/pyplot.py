"""In the place of matplotlib where it is not installed: the examples are run as
they are, and what they would draw is written as numbers. It draws nothing."""

import numpy as np

_curves = []


def plot(x, y):
    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    if x.shape != y.shape or x.ndim != 1:
        raise ValueError(f"x and y of a curve have the shapes {x.shape} and {y.shape}")
    _curves.append(np.column_stack([x, y]))


def savefig(path):
    np.savetxt(path, np.vstack(_curves))
