#!/bin/bash
# doctor_in_served_room.sh FOLDER: `planlight doctor` and `check --live` in the room served as hardware, on the display with two
# monitors that two_monitors.sh made: a room that is well, and rooms that are not. $PLANLIGHT is the program, $PLAN the plan.
folder=$1 patient=/usr/share/doc/invesalius-examples/examples/Cranium.inv3
[ -e $patient ] || { echo "skipped: the package invesalius-examples is not installed"; exit 77; }
ip address add 127.0.0.2/8 dev lo 2>/dev/null
failed=0
check() { if [ "$2" = 1 ]; then echo "ok   $1"; else echo "FAIL $1 ($3)"; failed=1; fi; }
is() { awk "BEGIN { print ($1) ? 1 : 0 }"; }
rm -rf "$folder"/{case,room,served,errors,*.json,*.txt}
"$PLANLIGHT" prepare $patient --plan "$PLAN" --out "$folder/case" >/dev/null 2>"$folder/errors" || { cat "$folder/errors"; exit 1; }
serve() {  # OPTIONS...
  [ -z "$served" ] || { kill $served; wait $served 2>/dev/null; }
  "$PLANLIGHT" simulate $patient --plan "$PLAN" --preset paper --seed 1 --serve DUMMY1 --out "$folder/room" "$@" >"$folder/served" 2>&1 & served=$!
  for i in $(seq 300); do grep -q "cameras answer" "$folder/served" && return; kill -0 $served 2>/dev/null || break; sleep 0.1; done
  echo "skipped: $(cat "$folder/served")"; exit 77
}
trap '[ -z "$served" ] || { kill $served 2>/dev/null; wait $served 2>/dev/null; }' EXIT
doctor() {  # NAME ROOM OPTIONS...
  local name=$1 room=$2; shift 2
  "$PLANLIGHT" doctor --verbose --room "$room" "$@" >"$folder/$name.txt" 2>"$folder/errors"; code=$?
}
busy() { kill $served 2>/dev/null; wait $served 2>/dev/null; served=; awk '/could not keep up/ {print (10 * $7 > $1) ? 1 : 0}' "$folder/served" | tail -1; }
serve
"$PLANLIGHT" projector --room "$folder/room/room.json" --part latency --refresh-hz 60 --out "$folder/projector.json" >/dev/null 2>"$folder/errors"
sed 's|"monitor": "DUMMY1"|"monitor": "DUMMY1", "file": "'"$folder"'/projector.json"|' "$folder/room/room.json" >"$folder/room/whole.json"
doctor well "$folder/room/whole.json" "$folder/case"
cat "$folder/well.txt"
check "a room that is well has nothing that stops" "$(is "$code == 0")" "exit code $code"
"$PLANLIGHT" doctor --room "$folder/room/whole.json" "$folder/case" --window --operator DUMMY0 --screenshot "$folder/page.png" >"$folder/window.txt" 2>"$folder/errors"; code=$?
check "nor has it on the page" "$(is "$code == 0 && $(grep -c . "$folder/window.txt") >= $(grep -c . "$folder/well.txt") - 2")" "exit code $code: $(cat "$folder/window.txt")"
"$PLANLIGHT" check --live --room "$folder/room/whole.json" >"$folder/checked.txt" 2>&1; code=$?
check "check --live finds the rig good" "$(is "$code == 0")" "exit code $code: $(cat "$folder/checked.txt")"
sed 's/SIM-L/SIM-X/; s/SIM-R/SIM-L/; s/SIM-X/SIM-R/' "$folder/room/whole.json" >"$folder/room/exchanged.json"
doctor exchanged "$folder/room/exchanged.json"
check "left and right exchanged: stopped by name" "$(is "$code == 6 && $(grep -c '^STOP  left camera, identity' "$folder/exchanged.txt") == 1")" "exit code $code: $(grep STOP "$folder/exchanged.txt")"
"$PLANLIGHT" check --live --room "$folder/room/exchanged.json" >"$folder/checked.txt" 2>&1; code=$?
check "check --live refuses them as well" "$(is "$code == 6 && $(grep -c exchanged "$folder/checked.txt") > 0")" "exit code $code: $(cat "$folder/checked.txt")"
sed 's/"monitor": "DUMMY1"/"monitor": "HDMI-9"/' "$folder/room/room.json" >"$folder/room/dark.json"
doctor dark "$folder/room/dark.json"
check "a projector that is not there is stopped by name" "$(is "$code == 6 && $(grep -c 'there is no monitor HDMI-9' "$folder/dark.txt") == 1")" "exit code $code"
echo spoilt >>"$folder/case/skin.ply"
"$PLANLIGHT" doctor --room "$folder/room/dark.json" --json "$folder/case" >"$folder/case.txt" 2>"$folder/errors"; code=$?
check "a damaged case is stopped by name" "$(is "$code == 6 && $(grep -c 'skin.ply' "$folder/case.txt") > 0")" "exit code $code"
rm -rf "$folder/case"
late=$(busy)
serve --right-behind 1 --lose-packets 0.0003
doctor behind "$folder/room/room.json"
check "a camera that runs a frame behind is stopped by name" "$(is "$code == 6 && $(grep -c '^STOP  cameras, same moment.*right camera' "$folder/behind.txt") == 1")" "exit code $code: $(cat "$folder/behind.txt")"
check "frames that lose packets are said" "$(is "$(grep -v '^good' "$folder/behind.txt" | grep -c 'camera, loss') > 0")" "$(grep loss "$folder/behind.txt")"
[ "$(busy)" = 1 ] && late=1
if [ "$late" = 1 ] && [ $failed = 1 ]; then echo "skipped: this machine is too busy to serve the room in time"; exit 77; fi
exit $failed
