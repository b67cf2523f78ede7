#!/bin/sh
# completion.sh PROGRAM: completion of commands, options and their words for bash, made from --help, on standard output.
set -eu
program=$1
commands=$("$program" --help | sed -n '/^Subcommands:/,/^$/s/^  \([a-z][a-z]*\) .*/\1/p')
echo "# bash completion of planlight, made from its --help"
echo "_planlight() {"
echo '    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} options= words='
echo '    if [ "$COMP_CWORD" -eq 1 ]; then'
echo "        COMPREPLY=(\$(compgen -W \"$(echo $commands) --help --version\" -- \"\$word\"))"
echo '        return'
echo '    fi'
echo '    case ${COMP_WORDS[1]} in'
for command in $commands; do
    help=$("$program" "$command" --help)
    echo "    $command)"
    echo "        options=\"$(echo "$help" | grep -oE '^  (-[a-z],)?--[a-z-]+' | grep -oE -- '--[a-z-]+' | xargs)\""
    # options that take one of a few words: --preset TEXT:{modern,paper}
    choices=$(echo "$help" | sed -nE 's/^  (--[a-z-]+) [A-Z]+:\{([^}]*)\}.*/\1 \2/p' | tr ',' ' ')
    if [ -n "$choices" ]; then
        echo '        case $before in'
        echo "$choices" | while read -r option words; do echo "        $option) words=\"$words\" ;;"; done
        echo '        esac'
    fi
    echo '        ;;'
done
cat <<'END'
    esac
    if [ -n "$words" ]; then
        COMPREPLY=($(compgen -W "$words" -- "$word"))
    elif [ "${word:0:1}" = - ]; then
        COMPREPLY=($(compgen -W "$options" -- "$word"))
    else
        compopt -o filenames 2>/dev/null
        COMPREPLY=($(compgen -f -- "$word"))
    fi
}
complete -F _planlight planlight
END
