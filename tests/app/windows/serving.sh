# Sourced by the scripts that operate in the room served as hardware, each called as SCRIPT FOLDER on the display with two monitors that
# two_monitors.sh made, with $PLANLIGHT the program and $PLAN the plan. Exit code 77: the room cannot be served here.
folder=$1 patient=/usr/share/doc/invesalius-examples/examples/Cranium.inv3
[ -e $patient ] || { echo "skipped: the package invesalius-examples is not installed"; exit 77; }
ip address add 127.0.0.2/8 dev lo 2>/dev/null
failed=0 late=0 served=
check() { if [ "$2" = 1 ]; then echo "ok   $1"; else echo "FAIL $1 ($3)"; failed=1; fi; }
is() { awk "BEGIN { print ($1) ? 1 : 0 }"; }

serve() {  # serve ROOM OPTIONS...: `simulate` serves into that folder until stop_serving; $served
  local room=$1; shift
  stop_serving
  "$PLANLIGHT" simulate "$@" --serve DUMMY1 --out "$room" >"$folder/served" 2>&1 & served=$!
  for i in $(seq 600); do grep -q "cameras answer" "$folder/served" && return; kill -0 $served 2>/dev/null || break; sleep 0.1; done
  echo "skipped: $(cat "$folder/served")"; exit 77
}
serve_patient() {  # serve_patient ROOM SEED OPTIONS...
  local room=$1 seed=$2; shift 2
  serve "$room" $patient --plan "$PLAN" --preset paper --seed $seed "$@"
}
prepare_case() { "$PLANLIGHT" prepare $patient --plan "$PLAN" --out "$folder/case" >/dev/null 2>"$folder/errors" || { cat "$folder/errors"; exit 1; }; }
measure_delay() {  # of the projector of $folder/room/room.json, into $folder/projector.json, said in $folder/latency; the exit code
  "$PLANLIGHT" projector --room "$folder/room/room.json" --part latency --refresh-hz 60 --out "$folder/projector.json" >"$folder/latency" 2>"$folder/errors"
}
name_projector_file() {  # name_projector_file ROOM.JSON: the delay in force is that of $folder/projector.json
  sed -i 's|"monitor": "DUMMY1"|"monitor": "DUMMY1", "file": "'"$folder"'/projector.json"|' "$1"
}
stop_serving() {  # $late is 1 from then on where a tenth of the pictures or more was late
  [ -n "$served" ] || return 0
  kill $served 2>/dev/null; wait $served 2>/dev/null; served=
  [ "$(awk '/could not keep up/ { print (10 * $7 > $1) ? 1 : 0 }' "$folder/served" | tail -1)" = 1 ] && late=1
  return 0
}
trap '[ -z "$session" ] || kill $session 2>/dev/null; stop_serving' EXIT
end() {  # a failure says nothing where pictures were late
  stop_serving
  tail -1 "$folder/served"
  if [ $late = 1 ] && [ $failed = 1 ] && [ -z "$LEAK" ]; then echo "skipped: this machine is too busy to serve the room in time"; exit 77; fi
  exit $failed
}
