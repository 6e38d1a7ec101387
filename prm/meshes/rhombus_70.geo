// gamma = 70 degrees, see rhombus.geo.
gamma = 70;
Include "rhombus.geo";
