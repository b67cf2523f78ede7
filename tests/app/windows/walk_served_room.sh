#!/bin/bash
# walk_served_room.sh FOLDER: the whole way through the wire, on the display with two monitors that two_monitors.sh made, for $SEEDS rooms
# (default 3) one after the other: a guided calibration of a board that a simulated person carries about, the doctor with that rig, then scan,
# match and light with it, each beside the same room in process. $PLANLIGHT is the program, $PLAN the plan, $COMPARE and $SESSION the programs
# compare_rig and session_in_served_room. By hand, a quarter of an hour, nothing else running:
#   PROGRAM_SECONDS=2400 SECOND_MONITOR=800x600 PLANLIGHT=build/app/planlight PLAN=app/example/frontal_defect.mrk.json COMPARE=build/tests/app/windows/compare_rig \
#     SESSION=build/tests/app/windows/session_in_served_room tests/app/windows/two_monitors.sh tests/app/windows/walk_served_room.sh tests/app/windows/two_monitor_xorg.conf /tmp/walk none
folder=$1 here=$(dirname "$0") patient=/usr/share/doc/invesalius-examples/examples/Cranium.inv3
[ -e $patient ] || { echo "skipped: the package invesalius-examples is not installed"; exit 77; }
ip address add 127.0.0.2/8 dev lo 2>/dev/null
failed=0
check() { if [ "$2" = 1 ]; then echo "ok   $1"; else echo "FAIL $1 ($3)"; failed=1; fi; }
is() { awk "BEGIN { print ($1) ? 1 : 0 }"; }
trap '[ -z "$served" ] || { kill $served 2>/dev/null; wait $served 2>/dev/null; }' EXIT
rm -rf "$folder"/{case,room,served,errors,projector.json}
"$PLANLIGHT" prepare $patient --plan "$PLAN" --out "$folder/case" >/dev/null 2>"$folder/errors" || { cat "$folder/errors"; exit 1; }
seeds=${SEEDS:-3}
for seed in $(seq $seeds); do
  echo "seed $seed: guided calibration"
  SEEDS=1 FIRST_SEED=$seed "$here/calibrate_served_room.sh" "$folder"; code=$?
  [ $code = 77 ] && exit 77
  check "seed $seed: the rig is as the simulator's" "$(is "$code == 0")" "exit code $code"
  "$PLANLIGHT" simulate $patient --plan "$PLAN" --preset paper --seed $seed --serve DUMMY1 --out "$folder/room" >"$folder/served" 2>&1 & served=$!
  for i in $(seq 600); do grep -q "cameras answer" "$folder/served" && break; kill -0 $served 2>/dev/null || break; sleep 0.1; done
  grep -q "cameras answer" "$folder/served" || { echo "skipped: $(cat "$folder/served")"; exit 77; }
  "$PLANLIGHT" projector --room "$folder/room/room.json" --part latency --refresh-hz 60 --out "$folder/projector.json" >/dev/null 2>"$folder/errors"; code=$?
  check "seed $seed: the projector's delay is measured" "$(is "$code == 0")" "exit code $code: $(tail -1 "$folder/errors")"
  sed -i 's|"monitor": "DUMMY1"|"monitor": "DUMMY1", "file": "'"$folder"'/projector.json"|; s|"rig": "rig.json"|"rig": "'"$folder/guided-$seed.json"'"|' "$folder/room/room.json"
  "$PLANLIGHT" doctor --room "$folder/room/room.json" "$folder/case" >"$folder/doctor-$seed.txt" 2>"$folder/errors"; code=$?
  cat "$folder/doctor-$seed.txt"
  check "seed $seed: the doctor stops nothing, with the rig of the guided calibration" "$(is "$code == 0")" "exit code $code: $(tail -1 "$folder/errors")"
  kill $served; wait $served 2>/dev/null; served=
  tail -1 "$folder/served"
done
echo "scan, match and light by these rigs, beside the rooms in process"
SEEDS=$seeds GUIDED="$folder" "$SESSION" "$folder"; code=$?
[ $code = 77 ] && [ $failed = 0 ] && exit 77
check "every patient is found, and lit as without a wire" "$(is "$code == 0")" "exit code $code"
exit $failed
