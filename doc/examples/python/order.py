"""Orders of convergence of a standing wave: p + 1 for linear and quadratic cells."""

import nsfd

study = nsfd.study(
    "prm/verification/mode.prm",
    {"Discretization/degree": [1, 2], "Mesh/cells": [[4, 1], [8, 1], [16, 1]]},
    output="output/order",
    Study={"repeats": 1, "limit checks": False},
)
for order in study.orders:
    if order.error == "displacement_L2":
        print(f"{order.series}: order {order.order:.2f}")
        for size, error in zip(order.sizes, order.errors):
            print(f"  {size:.4f}  {error:.2e}")
