#!/bin/bash
# walk_served_room.sh FOLDER: the whole way through the wire, on the display with two monitors that two_monitors.sh made, for $SEEDS rooms
# (default 3) one after the other: a guided calibration of a board that a simulated person carries about, the doctor with that rig, then scan,
# match and light with it, each beside the same room in process. $PLANLIGHT is the program, $PLAN the plan, $COMPARE and $SESSION the programs
# compare_rig and session_in_served_room. By hand, a quarter of an hour, nothing else running:
#   PROGRAM_SECONDS=2400 SECOND_MONITOR=800x600 PLANLIGHT=build/app/planlight PLAN=app/example/frontal_defect.mrk.json COMPARE=build/tests/app/windows/compare_rig \
#     SESSION=build/tests/app/windows/session_in_served_room tests/app/windows/two_monitors.sh tests/app/windows/walk_served_room.sh tests/app/windows/two_monitor_xorg.conf /tmp/walk none
. "$(dirname "$0")/serving.sh"
rm -rf "$folder"/{case,room,served,errors,projector.json}
prepare_case
seeds=${SEEDS:-3}
for seed in $(seq $seeds); do
  echo "seed $seed: guided calibration"
  SEEDS=1 FIRST_SEED=$seed "$(dirname "$0")/calibrate_served_room.sh" "$folder"; code=$?
  [ $code = 77 ] && exit 77
  check "seed $seed: the rig is as the simulator's" "$(is "$code == 0")" "exit code $code"
  serve_patient "$folder/room" $seed
  measure_delay; code=$?
  check "seed $seed: the projector's delay is measured" "$(is "$code == 0")" "exit code $code: $(tail -1 "$folder/errors")"
  name_projector_file "$folder/room/room.json"
  sed -i 's|"rig": "rig.json"|"rig": "'"$folder/guided-$seed.json"'"|' "$folder/room/room.json"
  "$PLANLIGHT" doctor --room "$folder/room/room.json" "$folder/case" >"$folder/doctor-$seed.txt" 2>"$folder/errors"; code=$?
  cat "$folder/doctor-$seed.txt"
  check "seed $seed: the doctor stops nothing, with the rig of the guided calibration" "$(is "$code == 0")" "exit code $code: $(tail -1 "$folder/errors")"
  stop_serving
  tail -1 "$folder/served"
done
echo "scan, match and light by these rigs, beside the rooms in process"
SEEDS=$seeds GUIDED="$folder" "$SESSION" "$folder"; code=$?
[ $code = 77 ] && [ $failed = 0 ] && exit 77
check "every patient is found, and lit as without a wire" "$(is "$code == 0")" "exit code $code"
end
