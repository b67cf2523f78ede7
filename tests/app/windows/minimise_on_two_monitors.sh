#!/bin/bash
# minimise_on_two_monitors.sh FOLDER: a session whose window is minimised, then on another workspace than the one that is
# shown, while its light is on the second monitor, on the display that two_monitors.sh made, with a window manager: the
# light goes out, and stays out until the window is back and somebody presses Track.
# $PLANLIGHT is the program, $PLAN the plan. Leaves screenshots in FOLDER.
folder=$1 patient=/usr/share/doc/invesalius-examples/examples/Cranium.inv3
[ -e $patient ] || { echo "skipped: the package invesalius-examples is not installed"; exit 77; }
for needed in xdotool xprop; do command -v $needed >/dev/null || { echo "skipped: $needed is not installed"; exit 77; }; done
failed=0
check() { if [ "$2" = 1 ]; then echo "ok   $1"; else echo "FAIL $1 ($3)"; failed=1; fi; }
photograph() { import -window root -crop 800x600+1920+0 +repage "$folder/$1.png"; }
measured() { photograph light; awk "BEGIN { exit !($(convert "$folder/light.png" -format "%[fx:$1]" info:) $2) }"; }
lit() { measured mean.g-mean.b '> 0.0003'; }  # the plan's green, and no stripes of white
bright() { measured maxima '> 0.05'; }
until_lit() { for i in $(seq 300); do lit && return 0; kill -0 $session 2>/dev/null || return 1; sleep 0.3; done; return 1; }
rm -rf "$folder/case" "$folder"/*.png
"$PLANLIGHT" prepare $patient --plan "$PLAN" --out "$folder/case" >/dev/null 2>"$folder/errors" || { cat "$folder/errors"; exit 1; }
"$PLANLIGHT" session "$folder/case" --volume $patient --preset paper --projector DUMMY1 --autoplay --end-after-s 120 \
  --record none 2>"$folder/errors" & session=$!
trap 'kill $session 2>/dev/null' EXIT
until_lit; check "light on the second monitor" $((1 - $?)) "$(cat "$folder/errors")"
window=$(xdotool search --name "^Planlight$" | tail -1)
expect_dark() { # WHILE
  sleep 1.5
  local dark=1
  for i in $(seq 8); do bright && dark=0; sleep 0.3; done
  check "dark while the window is $1" $dark "there is light"
}
expect_light_by_track() { # NAME
  sleep 1
  import -window root "$folder/$1.png"
  bright; check "and dark when it is back, until somebody presses Track" $?
  xdotool windowfocus "$window" key t
  until_lit; check "light again by that press" $((1 - $?)) "$(cat "$folder/errors")"
}
xdotool windowminimize "$window"
expect_dark minimised
xdotool windowmap "$window"
expect_light_by_track back
xdotool set_desktop 1
expect_dark "on another workspace"
xdotool set_desktop 0
expect_light_by_track back-from-workspace
# A compositing desktop keeps the windows of its other workspaces as they were: only its word tells.
xprop -root -f _NET_CURRENT_DESKTOP 32c -set _NET_CURRENT_DESKTOP 1
expect_dark "on another workspace, and still mapped"
xprop -root -f _NET_CURRENT_DESKTOP 32c -set _NET_CURRENT_DESKTOP 0
expect_light_by_track back-by-its-word
kill -INT $session; wait $session; code=$?
trap - EXIT
check "the session ends as asked" $((code == 0)) "exit code $code: $(cat "$folder/errors")"
exit $failed
