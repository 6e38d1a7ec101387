"""A plotted curve in five lines: the force on the upper arm of a double cantilever
beam over its displacement, which a probe measures. A crack grows in steps."""

import matplotlib.pyplot as plt
import nsfd
run = nsfd.run("prm/verification/dcb_beam_growth.prm", **{"Observable: grip": {"type": "probe", "on": "upper"}})
plt.plot(run.observables["grip"]["displacement_y"], run.history["reaction_upper_y"])
plt.savefig("force_displacement.png")
