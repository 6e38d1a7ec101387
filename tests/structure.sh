#!/bin/sh
# structure.sh [-v]: measures of the source tree, one per line; exit code 1 if
# one is beyond its bound. With -v what is counted is named. Run it at the top.
#
#   upward includes   of headers from a folder that comes later in source/LAYERS
#   folder circles    pairs of folders that include each other
#   unformatted files that clang-format 14 would change, where it is installed
#   long files        above 500 lines
set -eu
verbose=0
[ "${1:-}" != -v ] || verbose=1

unformatted=
if command -v clang-format-14 >/dev/null 2>&1; then
  unformatted=$(find source include tests -name '*.h' -o -name '*.cc' | sort |
    xargs clang-format-14 --dry-run 2>&1 |
    sed -n 's/^\([^:]*\):[0-9]*:[0-9]*: .*/\1/p' | sort -u | tr '\n' ' ')
fi

find source include/nsfd -name '*.h' -o -name '*.cc' | sort |
  xargs awk -v verbose="$verbose" -v unformatted="$unformatted" '
    function folder(path) {
      sub(/^source\//, "", path)
      sub(/^include\/nsfd\//, "", path)
      sub(/^nsfd\//, "", path)
      if (!sub(/\/[^\/]*$/, "", path)) return ""
      while (!(path in rank))
        if (!sub(/\/[^\/]*$/, "", path)) return ""
      return path
    }
    function tell(text) { if (verbose) print "  " text }
    { ++lines[FILENAME] }
    FNR == 1 { mine = folder(FILENAME) }
    FNR == 1 && mine == "" {
      print FILENAME ": its folder is not in source/LAYERS"; bad = 1
    }
    FILENAME == "source/LAYERS" { next }
    /^[ \t]*#[ \t]*include[ \t]*"/ {
      split($0, part, "\"")
      if (part[2] ~ /^\.\.?\//) {
        print FILENAME ": " part[2] " is not named from source/"; bad = 1
      }
      its = part[2] ~ /\// ? folder(part[2]) : mine
      if (its == "") { print FILENAME ": where is " part[2] "?"; bad = 1 }
      if (its == mine) next
      if (rank[its] > rank[mine]) {
        ++upward; tell("upward: " FILENAME " includes " part[2])
      }
      if (!((mine, its) in uses)) {
        uses[mine, its] = 1
        if ((its, mine) in uses) { ++circles; tell("circle: " mine " and " its) }
      }
    }
    BEGIN {
      while ((getline line < "source/LAYERS") > 0)
        if (line !~ /^#/ && split(line, word, " ") > 0) rank[word[1]] = ++n
    }
    END {
      for (file in lines)
        if (lines[file] > 500) { ++long_files; tell("long: " file " " lines[file]) }
      printf "upward includes %d\n", upward
      printf "folder circles %d\n", circles
      n_unformatted = split(unformatted, file_list, " ")
      for (k = 1; k <= n_unformatted; ++k) tell("unformatted: " file_list[k])
      printf "unformatted files %d\n", n_unformatted
      printf "long files %d\n", long_files
      exit bad || upward || circles || n_unformatted
    }'
