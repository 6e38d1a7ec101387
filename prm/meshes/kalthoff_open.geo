// The plate of kalthoff.geo with faces of the notch that do not know of each
// other: no contact between them.
open = 1;
fine = 2.4;
Include "kalthoff.geo";
