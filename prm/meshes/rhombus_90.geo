// gamma = 90 degrees, nodes 0.01 mm apart: see rhombus.geo.
gamma = 90;
s = 0.01;
Include "rhombus.geo";
