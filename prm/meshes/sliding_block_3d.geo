// The block of sliding_block.geo in space, on cells of 0.5 mm in the middle of its
// lower side and of 2 mm along the rest of it.
s = 0.5;
base = 2;
layers = 3;
Include "sliding_block.geo";
