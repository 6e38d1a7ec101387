// gamma = 110 degrees, see rhombus.geo.
gamma = 110;
Include "rhombus.geo";
