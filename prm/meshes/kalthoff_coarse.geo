// The plate of kalthoff.geo on cells of 2.4 mm.
fine = 2.4;
Include "kalthoff.geo";
