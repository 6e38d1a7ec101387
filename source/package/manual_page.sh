#!/bin/sh
# manual_page.sh PROGRAM: the manual page nsfd(1), from what the program says of
# itself, on standard output.
set -eu
program=$1
version=$("$program" --version | sed -n '1s/^nsfd \([^ ]*\).*/\1/p')

# Text as it is: a backslash, and a full stop or quote that begins a line, are not for roff.
plain() { sed -e 's/\\/\\e/g' -e 's/-/\\-/g' -e "s/^\([.']\)/\\\\\&\1/"; }

echo ".TH NSFD 1 \"\" \"nsfd $version\" \"User commands\""
echo ".SH NAME"
echo "nsfd \\- nonsmooth fracture dynamics"
echo ".SH DESCRIPTION"
echo ".nf"
"$program" --help | plain
echo ".fi"
for word in $("$program" --help | sed -n 's/^  nsfd \([a-z]*\) .*/\1/p'); do
  echo ".SH NSFD $(echo "$word" | tr '[:lower:]' '[:upper:]')"
  echo ".nf"
  "$program" "$word" --help | plain
  echo ".fi"
done
echo ".SH FILES"
echo "/usr/share/nsfd/prm holds scenes, /usr/share/doc/nsfd the documents."
echo ".SH SEE ALSO"
echo "mpirun(1), paraview(1)"
