# Completion of nsfd for bash. Words and options are those that the program
# prints; files are scenes, stored problems, or the folders of runs.
_nsfd() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}
  local program=${COMP_WORDS[0]} sub= words
  case ${COMP_WORDS[1]} in
  study | law | solve | compare | mesh | run) [ "$COMP_CWORD" -gt 1 ] && sub=${COMP_WORDS[1]} ;;
  esac
  case $before in
  --output | --resume)
    mapfile -t COMPREPLY < <(compgen -d -- "$word")
    return
    ;;
  --plug-in)
    mapfile -t COMPREPLY < <(compgen -f -X '!*.so' -- "$word"; compgen -d -- "$word")
    return
    ;;
  esac
  if [[ $word == -* ]]; then
    # shellcheck disable=SC2086 # sub is a word or none
    words=$("$program" $sub --help 2>/dev/null | grep -oE '^ +(-h,)?--[a-z-]+' | sed 's/.*--/--/' | sort -u)
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
    return
  fi
  words=
  if [ "$COMP_CWORD" -eq 1 ]; then
    words=$("$program" --help 2>/dev/null | sed -n 's/^  nsfd \([a-z]*\) .*/\1/p')
  elif [ "$sub" = law ]; then
    words=$("$program" --list 2>/dev/null | sed -n '/^cohesive law/,/^$/s/^  \([^ ]*\) .*/\1/p')
  fi
  local pattern='!*.prm'
  [ "$sub" != solve ] || pattern='!*.@(hdf5|h5)'
  mapfile -t COMPREPLY < <(
    compgen -W "$words" -- "$word"
    compgen -d -S / -- "$word"
    compgen -f -X "$pattern" -- "$word"
  )
}
complete -o nospace -o filenames -F _nsfd nsfd ./nsfd
