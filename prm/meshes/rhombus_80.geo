// gamma = 80 degrees, see rhombus.geo.
gamma = 80;
Include "rhombus.geo";
