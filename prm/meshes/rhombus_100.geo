// gamma = 100 degrees, see rhombus.geo.
gamma = 100;
Include "rhombus.geo";
