// The plate of kalthoff.geo with lips of the notch that do not know of each
// other: no contact between them.
open = 1;
Include "kalthoff.geo";
