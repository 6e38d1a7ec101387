// gamma = 80 degrees, nodes 0.01 mm apart: see rhombus.geo.
gamma = 80;
s = 0.01;
Include "rhombus.geo";
