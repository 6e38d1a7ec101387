#!/bin/sh
# documents.sh [FILE.md ...]: what the documents name exists; exit code 1 if
# something does not. Without arguments all documents are read. Run it at the
# top.
#
#   links      relative ones, and headings behind a #
#   files      paths below a folder of this tree, and single names of sources,
#              scenes, scripts and pictures in backticks
#   code       classes and functions() in backticks: words of the sources
#   index      doc/README.md links every document of doc/
#   comments   doc/*.md that sources, scenes and scripts name exist
#   layers     doc/code_tour.md shows every folder of source/LAYERS
#   release    CMakeLists.txt, CITATION.cff and CHANGELOG.md have one version
set -eu

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT INT TERM

# What a reader writes, or what a run leaves.
cat >"$scratch/elsewhere" <<'END'
wedge.prm mesh.prm scene.prm parameters.prm a.prm b.prm midplane.prm plate.msh
beam.geo sizes.geo linear_softening.cc free_fall.cc free_fall.prm
cracks_final.svg bar.svg grip.svg energies.svg floor.svg speeds.svg slopes.svg
END

find source include tests prm doc .ci -type f 2>/dev/null >"$scratch/files"
ls >>"$scratch/files"
find source include tests -name '*.cc' -o -name '*.h' -o -name '*.py' |
  xargs grep -hoE '[A-Za-z_][A-Za-z0-9_]*' | sort -u >"$scratch/words"

# check FILE ...: one line per fault
check() {
  awk -v scratch="$scratch" '
    function fault(text) {
      print FILENAME ":" FNR ": " text
      faults = 1
    }
    # the anchor that a heading gets: lower case, blanks to hyphens
    function anchor(text) {
      text = tolower(text)
      gsub(/[^a-z0-9 _-]/, "", text)
      gsub(/ /, "-", text)
      return text
    }
    function headings(file,    line, fenced) {
      if (file in read_headings) return
      read_headings[file] = 1
      while ((getline line < file) > 0) {
        if (line ~ /^```/) fenced = !fenced
        if (!fenced && sub(/^#+ +/, "", line)) has[file, anchor(line)] = 1
      }
      close(file)
    }
    # a/b/../c to a/c
    function plain(path,    part, n, i, kept, k, result) {
      n = split(path, part, "/")
      k = 0
      for (i = 1; i <= n; ++i)
        if (part[i] == "..") --k
        else if (part[i] != "." && part[i] != "") kept[++k] = part[i]
      for (i = 1; i <= k; ++i) result = result (i > 1 ? "/" : "") kept[i]
      return result
    }
    # a pattern with * of the names that are there
    function known(path,    pattern, file) {
      sub(/\/$/, "", path)
      if (path in is_there) return 1
      if (path !~ /\*/) return 0
      pattern = path
      gsub(/\./, "\\.", pattern)
      gsub(/\*/, "[^/]*", pattern)
      for (file in is_there) if (file ~ "^" pattern "$") return 1
      return 0
    }
    function check_link(target,    file, mark, at) {
      if (target ~ /^[a-z]+:/) return
      at = index(target, "#")
      mark = at ? substr(target, at + 1) : ""
      file = at ? substr(target, 1, at - 1) : target
      if (file == "") file = FILENAME
      else file = plain(folder "/" file)
      if (!known(file) && file != FILENAME) fault("no file behind the link " target)
      else if (mark != "") {
        headings(file)
        if (!((file, mark) in has)) fault("no heading behind the link " target)
      }
    }
    function check_path(path) {
      sub(/[.,:]+$/, "", path)
      if (path ~ /[A-Z][A-Z]/ && path !~ /README|CMakeLists|LAYERS/) return
      if (base(path) in elsewhere) return
      if (!known(path)) fault("no file " path)
    }
    function base(path) { sub(/^.*\//, "", path); return path }
    function check_name(name) {
      if (name in elsewhere || name ~ /^[A-Z]+\.|\*/) return
      if (!(name in is_named)) fault("no file called " name)
    }
    function check_code(text,    part, n, i) {
      gsub(/\(\)/, "", text)
      n = split(text, part, "::")
      for (i = 1; i <= n; ++i)
        if (!(part[i] in is_word)) fault("no name " part[i] " in the sources")
    }
    BEGIN {
      while ((getline line < (scratch "/files")) > 0) {
        is_there[line] = 1
        is_named[base(line)] = 1
        while (sub(/\/[^\/]*$/, "", line)) is_there[line] = 1
      }
      while ((getline line < (scratch "/words")) > 0) is_word[line] = 1
      while ((getline line < (scratch "/elsewhere")) > 0) {
        n = split(line, part, " ")
        for (i = 1; i <= n; ++i) elsewhere[part[i]] = 1
      }
    }
    FNR == 1 {
      fenced = 0
      folder = FILENAME
      if (!sub(/\/[^\/]*$/, "", folder)) folder = "."
    }
    /^ *```/ { fenced = !fenced; next }
    {
      rest = $0
      while (match(rest, /(^|[^A-Za-z0-9_.\/-])(source|include|tests|prm|doc|\.ci)\/[A-Za-z0-9_.*\/-]+/)) {
        path = substr(rest, RSTART, RLENGTH)
        rest = substr(rest, RSTART + RLENGTH)
        sub(/^[^A-Za-z.]/, "", path)
        check_path(path)
      }
    }
    fenced { next }
    {
      rest = $0
      while (match(rest, /\]\([^)" ]+\)/)) {
        check_link(substr(rest, RSTART + 2, RLENGTH - 3))
        rest = substr(rest, RSTART + RLENGTH)
      }
      n = split($0, part, "`")
      for (i = 2; i <= n; i += 2) {
        if (part[i] ~ /^[A-Za-z0-9_]+\.(cc|h|sh|py|prm|geo|svg|bib|awk)$/)
          check_name(part[i])
        else if (part[i] ~ /^([A-Z][A-Za-z0-9]+::)+[a-z_]+(\(\))?$|^[a-z_]+\(\)$|^[A-Z]+[a-z0-9]+[A-Z][A-Za-z0-9]*$/)
          check_code(part[i])
      }
    }
    END { exit faults }' "$@"
}

# A test that cannot fail is none: one fault of each kind.
mkdir "$scratch/doc"
cat >"$scratch/doc/broken.md" <<'END'
[gone](gone.md) [no heading](#gone) `source/gone.cc` `gone.cc` `GoneAway`
END
found=$(check "$scratch/doc/broken.md" || true)
if [ "$(printf '%s\n' "$found" | wc -l)" -ne 5 ]; then
  printf 'documents.sh does not find its own faults, but\n%s\n' "$found"
  exit 1
fi

[ $# -eq 0 ] || { check "$@"; exit; }
set -- README.md CONTRIBUTING.md CHANGELOG.md doc/*.md doc/*/*.md \
  tests/*/README.md
status=0
check "$@" || status=1
for document in doc/*.md; do
  name=$(basename "$document")
  if [ "$name" != README.md ] && ! grep -q "]($name)" doc/README.md; then
    echo "doc/README.md: does not list $name"
    status=1
  fi
done
grep -rnoE 'doc/[a-z_/]+\.md' source include tests prm --include='*.cc' \
  --include='*.h' --include='*.prm' --include='*.sh' --include='*.py' |
  while IFS=: read -r file line document; do
    [ -e "$document" ] || [ "$file" = tests/documents.sh ] ||
      echo "$file:$line: no document $document"
  done >"$scratch/comments"
if [ -s "$scratch/comments" ]; then
  cat "$scratch/comments"
  status=1
fi
for layer in $(sed '/^#/d; s/ .*//' source/LAYERS); do
  if ! grep -q "^ .*\b$layer\b" doc/code_tour.md; then
    echo "doc/code_tour.md: does not show the layer $layer"
    status=1
  fi
done
released=$(sed -n 's/^project(nsfd VERSION \([0-9.]*\) .*/\1/p' CMakeLists.txt)
cited=$(sed -n 's/^version: *//p' CITATION.cff)
changed=$(sed -n 's/^## \([0-9.]*\)$/\1/p' CHANGELOG.md | head -n 1)
if [ -z "$released" ] || [ "$released $released" != "$cited $changed" ]; then
  echo "version: CMakeLists.txt $released, CITATION.cff $cited, CHANGELOG.md $changed"
  status=1
fi
[ $status -ne 0 ] || echo "$# documents: links, files and names are there"
exit $status
