#!/bin/sh
# quickstart_figure.sh: the figure of README.md, doc/pictures/quickstart.png: runs
# prm/quickstart.prm and puts three of its pictures side by side. Run it at the top;
# it needs rsvg-convert (package librsvg2-bin).
set -eu
results=$(mktemp -d)
trap 'rm -rf "$results"' EXIT INT TERM
./nsfd prm/quickstart.prm --quiet --output "$results/run"
{
  echo '<svg xmlns="http://www.w3.org/2000/svg" width="1200" height="320">'
  echo '<rect width="100%" height="100%" fill="#fff"/>'
  x=0
  for number in 011 013 020; do # 55, 65 and 100 us
    sed "1d; 2s|^<svg |&x=\"$x\" |" "$results/run/deformed_$number.svg"
    x=$((x + 400))
  done
  echo '</svg>'
} >"$results/all.svg"
rsvg-convert -z 1.25 "$results/all.svg" -o doc/pictures/quickstart.png
