// gamma = 110 degrees, nodes 0.01 mm apart: see rhombus.geo.
gamma = 110;
s = 0.01;
Include "rhombus.geo";
