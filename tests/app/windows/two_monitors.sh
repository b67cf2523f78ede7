#!/bin/bash
# two_monitors.sh PROGRAM CONF FOLDER none|openbox|picom: runs PROGRAM on an X server of its own with two monitors.
# With picom, a compositor, there is openbox beside it.
# $SECOND_MONITOR is the mode of the second monitor (default 1024x768). Exit code 77: the X server with the dummy driver cannot be started here.
program=$1 conf=$2 folder=$3 manager=$4
for needed in Xorg xrandr import; do command -v $needed >/dev/null || { echo "skipped: $needed is not installed"; exit 77; }; done
[ "$manager" = none ] || command -v "$manager" >/dev/null || { echo "skipped: $manager is not installed"; exit 77; }
mkdir -p "$folder"
server= wm=
trap '[ -z "$wm" ] || kill "$wm" 2>/dev/null; [ -z "$server" ] || { kill "$server" 2>/dev/null; wait "$server" 2>/dev/null; }' EXIT
for number in $(seq 70 99 | shuf); do
  [ -e /tmp/.X$number-lock ] && continue
  Xorg :$number -config "$conf" -noreset -nolisten tcp +extension GLX +extension RANDR -logfile "$folder/xorg.log" >/dev/null 2>&1 &
  server=$!
  export DISPLAY=:$number
  for i in $(seq 50); do
    kill -0 $server 2>/dev/null || break
    xrandr >/dev/null 2>&1 && break
    sleep 0.2
  done
  kill -0 $server 2>/dev/null && xrandr >/dev/null 2>&1 && break
  kill $server 2>/dev/null; server=
  tries=$((tries + 1)); [ $tries -ge 3 ] && break
done
[ -n "$server" ] || { echo "skipped: Xorg with the dummy driver does not start here (it needs root)"; exit 77; }
xrandr --output DUMMY0 --mode 1920x1080 --primary || exit 77
second=${SECOND_MONITOR:-1024x768}
xrandr --addmode DUMMY1 $second && xrandr --output DUMMY1 --mode $second --right-of DUMMY0 || exit 77
xrandr >/dev/null  # asks the driver again: only then does it call the second output connected
if [ "$manager" = picom ]; then openbox >/dev/null 2>&1 & sleep 0.5; fi  # it ends with its display
if [ "$manager" != none ]; then "$manager" >/dev/null 2>&1 & wm=$!; sleep 1; fi
export MANAGER=$manager MANAGER_PROCESS=$wm LIBGL_ALWAYS_SOFTWARE=1
timeout ${PROGRAM_SECONDS:-120} "$program" "$folder"
