// The strip of xu_needleman.geo with a mesh that goes along y = 0 through the
// band: a way for a crack that is kept straight.
line = 1;
Include "xu_needleman.geo";
