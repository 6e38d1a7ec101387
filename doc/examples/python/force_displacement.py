"""A plotted curve in five lines: the force on the upper side of the plate of
prm/quickstart.prm over its displacement, which a probe measures."""

import matplotlib.pyplot as plt
import nsfd
run = nsfd.run("prm/quickstart.prm", **{"Observable: grip": {"type": "probe", "on": "top"}})
plt.plot(run.observables["grip"]["displacement_y"], run.history["reaction_top_y"])
plt.savefig("force_displacement.png")
