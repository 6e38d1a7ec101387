"""What several tests of the Python package need."""

import shutil
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
PRM = SOURCE / "prm"
MODE = PRM / "verification" / "mode.prm"

# A square of two halves that fly apart: no waves, no forces. The masses are 4 and
# 8 kg/m, the speeds -1 and 2 m/s.
HALVES = """\
# halves.prm - two halves fly apart
set dimension = 2
subsection Mesh
  set type         = rectangle            # of 2 m x 4 m
  set upper corner = 2, 4
  set cells        = 4, 4
end
subsection Material: left
  set where              = x < 1
  set Young modulus      = 1 MPa
  set Poisson ratio      = 0.25
  set density            = 1
  set initial velocity x = -1
end
subsection Material: right
  set where              = all
  set Young modulus      = 1 MPa
  set Poisson ratio      = 0.25
  set density            = 2
  set initial velocity x = 2
end
subsection Interface: middle
  set where     = abs(x - 1) < 0.01
  set law       = camacho-ortiz
  set strength  = 1 kPa
  set toughness = 1 J/m^2
  set broken    = true
end
subsection Interface: joints
  set law = rigid
end
subsection Time
  set end  = 10 ms
  set step = 1 ms
end
subsection Output
  set fields every = 5 ms
end
"""


class InScratch(unittest.TestCase):
    """Tests with a folder of their own."""

    def setUp(self):
        self.scratch = Path(tempfile.mkdtemp(prefix="nsfd_python_"))
        self.addCleanup(shutil.rmtree, self.scratch)
