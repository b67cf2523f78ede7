#!/bin/bash
# To be sourced. recorded_room FOLDER: a room of recorded pictures whose projector is the second monitor, FOLDER/room.json; there is no rig.json.
# check WORDS 1|0 WHY: a line, and failed=1. is EXPRESSION: 1 where it holds, by awk.
failed=0
check() { if [ "$2" = 1 ]; then echo "ok   $1"; else echo "FAIL $1 ($3)"; failed=1; fi; }
is() { awk "BEGIN { print ($1) ? 1 : 0 }"; }
recorded_room() {
  local i side list=
  rm -rf "$1/frames" "$1"/*.png "$1"/*.json "$1"/*.txt
  mkdir -p "$1/frames/left" "$1/frames/right"
  for i in 0 1 2 3 4; do
    for side in left right; do convert -size 320x240 -seed $i plasma:grey30-grey70 -colorspace Gray "$1/frames/$side/$i.png" || exit 77; done
    list="$list${list:+, }{\"picture\": \"$i.png\", \"number\": $i, \"at_ns\": $((i * 40000000)), \"exposure_ns\": 5000000}"
  done
  echo "{\"format\": \"planlight frames\", \"version\": 1, \"frames\": [$list]}" >"$1/frames/frames.json"
  echo '{"format": "planlight room", "version": 1, "rig": "rig.json", "projector": {"monitor": "DUMMY1"}, "cameras": {"recorded": {"frames": "frames"}}}' >"$1/room.json"
}
