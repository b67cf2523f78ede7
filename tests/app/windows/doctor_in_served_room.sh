#!/bin/bash
# doctor_in_served_room.sh FOLDER: `planlight doctor` and `check --live` in the room served as hardware, on the display with two
# monitors that two_monitors.sh made: a room that is well, and rooms that are not. $PLANLIGHT is the program, $PLAN the plan.
. "$(dirname "$0")/serving.sh"
rm -rf "$folder"/{case,room,served,errors,*.json,*.txt}
prepare_case
doctor() {  # NAME ROOM OPTIONS...
  local name=$1 room=$2; shift 2
  "$PLANLIGHT" doctor --verbose --room "$room" "$@" >"$folder/$name.txt" 2>"$folder/errors"; code=$?
}
serve_patient "$folder/room" 1
measure_delay
cp "$folder/room/room.json" "$folder/room/whole.json"
name_projector_file "$folder/room/whole.json"
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
serve_patient "$folder/room" 1 --right-behind 1 --lose-packets 0.0003
doctor behind "$folder/room/room.json"
check "a camera that runs a frame behind is stopped by name" "$(is "$code == 6 && $(grep -c '^STOP  cameras, same moment.*right camera' "$folder/behind.txt") == 1")" "exit code $code: $(cat "$folder/behind.txt")"
check "frames that lose packets are said" "$(is "$(grep -v '^good' "$folder/behind.txt" | grep -c 'camera, loss') > 0")" "$(grep loss "$folder/behind.txt")"
end
