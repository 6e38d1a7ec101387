// gamma = 100 degrees, nodes 0.01 mm apart: see rhombus.geo.
gamma = 100;
s = 0.01;
Include "rhombus.geo";
