// The block of sliding_block.geo in space, on cells of 1 mm in the middle of its
// lower side and of 4 mm along the rest of it.
s = 1;
base = 4;
layers = 2;
Include "sliding_block.geo";
