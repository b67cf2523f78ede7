#!/bin/sh
# man_page.sh PROGRAM [COMMAND]: the manual page of the program, or of one command, made from its --help, on standard output.
set -eu
program=$1
command=${2:-}
"$program" ${command:+"$command"} --help | awk -v command="$command" -v version="$("$program" --version)" '
function safe(text) {            # for the formatter: no escapes, no request at the beginning of a line
    gsub(/\\/, "\\e", text); gsub(/-/, "\\-", text)
    return text ~ /^[.\047]/ ? "\\&" text : text
}
function heading(text) { print ".SH " toupper(text) }
BEGIN {
    name = command == "" ? "planlight" : "planlight-" command
    printf ".TH %s 1 \"\" \"%s\" \"Planlight\"\n", toupper(safe(name)), version
}
part == "" && /^Usage:/ {
    gsub(/[ \n]+$/, "", what)
    heading("name"); print safe(name) " \\- " safe(what == "" ? "a surgical plan as light on the patient" : what)
    heading("synopsis"); sub(/^Usage: */, ""); print safe($0)
    if (command == "") {
        heading("description")
        print "Planlight shows a surgical plan as light on the patient. Each command has a page of its own: see"
        print ".BR planlight\\-demo (1), planlight\\-prepare (1)"
        print "and so on. The guide stands in /usr/share/doc/planlight/app/guide."
    }
    part = "usage"; next
}
part == "" { if ($0 != "") what = what (what == "" ? "" : " ") $0; next }
/^[A-Z][A-Za-z ]*:$/ { part = $0; sub(/:$/, "", part); heading(part); next }
/^Exit codes:/ { heading("exit status"); sub(/^Exit codes: */, ""); part = "text"; print safe($0); next }
/^ *$/ { next }
part == "Example" { sub(/^ +/, ""); print ".PP\n.EX"; print safe($0); print ".EE"; next }
/^  ?[^ ]/ && part != "text" && part != "usage" {   # an option, a positional or a command, and what follows two blanks
    line = substr($0, 3); at = match(line, /   */)
    head = at ? substr(line, 1, at - 1) : line; rest = at ? substr(line, at + RLENGTH) : ""
    print ".TP\n.B " safe(head); if (rest != "") print safe(rest); next
}
{ sub(/^ +/, ""); print safe($0) }
END {
    if (command != "") { heading("see also"); print ".BR planlight (1)" }
}'
