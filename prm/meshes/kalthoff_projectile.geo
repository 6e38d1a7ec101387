// The plate of kalthoff.geo with the upper half of a projectile, 200 mm long.
projectile = 200;
fine = 2.4;
Include "kalthoff.geo";
