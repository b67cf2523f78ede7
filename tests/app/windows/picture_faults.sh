#!/bin/bash
# picture_faults.sh PLANLIGHT VOLUME FOLDER [PRESET]: a picture of each fault that the simulated room can show
# (FOLDER/FAULT.png): from above to below the operator window before the fault and each time that its banner had changed
# and stayed, beside it the projector's picture of that moment. On a slow machine SECONDS_A_FAULT=200, else the session
# ends before its fault (FAULTS="late frozen": these alone): then that is said, and the exit code is 1. Exit code 77: the tools are not installed.
set -u
planlight=$1 volume=$2 folder=$3 preset=${4:-paper} failed=0
for needed in xvfb-run montage; do command -v $needed >/dev/null || { echo "skipped: $needed is not installed"; exit 77; }; done
plan=$(dirname "$0")/../../../app/example/frontal_defect.mrk.json
mkdir -p "$folder" && "$planlight" prepare "$volume" --plan "$plan" --out "$folder/case" --replace >"$folder/prepare.txt" 2>&1 ||
  { cat "$folder/prepare.txt"; exit 1; }
for fault in ${FAULTS:-projector left-camera right-camera marker markers late no-picture frozen}; do
  rm -rf "$folder/$fault"
  LIBGL_ALWAYS_SOFTWARE=1 xvfb-run -a -s "-screen 0 1280x720x24" "$planlight" session "$folder/case" --volume "$volume" \
    --preset "$preset" --seed 1 --autoplay --fault "$fault" --end-after-s ${SECONDS_A_FAULT:-90} --record none --keep "$folder/$fault/kept" \
    --screenshots "$folder/$fault" >"$folder/$fault.txt" 2>&1 || { echo "FAIL $fault"; tail -3 "$folder/$fault.txt"; failed=1; continue; }
  mapfile -t windows < <(ls "$folder/$fault"/operator-*.png | sed -n '/-aligned/,$p' | head -4)
  [ ${#windows[@]} -gt 1 ] || { echo "FAIL $fault: nothing followed ALIGNED"; failed=1; }
  pairs=()
  for window in "${windows[@]}"; do
    light=${window/operator-/light-}
    [ -e "$light" ] || { light=$folder/dark.png; convert -size 800x600 xc:black "$light"; }
    pairs+=("$window" "$light")
  done
  montage "${pairs[@]}" -tile 2x -geometry 960x540+6+6 -background gray30 "$folder/$fault.png" && echo "$folder/$fault.png"
done
exit $failed
