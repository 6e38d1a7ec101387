// gamma = 70 degrees, nodes 0.01 mm apart: see rhombus.geo.
gamma = 70;
s = 0.01;
Include "rhombus.geo";
