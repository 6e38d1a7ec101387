"""The pieces of a bar that spalls, and how fast they fly, at the end and over time."""

import numpy as np

import nsfd

run = nsfd.run("prm/verification/spall_square.prm")
pieces = run.last_fragments
for mass, x, speed in zip(pieces["mass"], pieces["x"], pieces["vx"]):
    print(f"{mass:8.3f} kg/m at x = {x:.3f} m with {speed:.3f} m/s")
print(f"momentum {np.sum(pieces['mass'] * pieces['vx']):.4f} N s/m")

history = run.history
first = np.argmax(history["fragments"] > 1)
print(f"torn off at t = {1e6 * history['time'][first]:.2f} us")
