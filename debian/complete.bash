# Completes options and subcommands of Polyfly's tools by what `TOOL SUBCOMMAND... --help` prints. Installed under each tool's name.
_polyfly() {
  local word current=${COMP_WORDS[COMP_CWORD]} help words
  local -a command=("${COMP_WORDS[0]/#\~/$HOME}")
  for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}" ""; do
    help=$("${command[@]}" --help 2> /dev/null)
    words=$(awk '/^[^ ]/ {inside = /^Subcommands:/} inside && /^  [a-z]/ {print $1}' <<< "$help")
    if [ -n "$word" ] && grep -qxF -e "$word" <<< "$words"; then
      command+=("$word")
    fi
  done
  if [[ $current == -* ]]; then
    # Where options are listed: at the start of a line, or in the usage.
    words=$(awk '/^[^ ]/ {usage = /^[Uu]sage/} usage {print} /^  -/ {print $1}' <<< "$help" | grep -oE -e '--[a-z][a-z-]*' | sort -u)
  fi
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
}
complete -o default -F _polyfly "${BASH_SOURCE[0]##*/}"
