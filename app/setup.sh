# Sourced by app/demo and tests/run: installs the packages of app/packages.txt that are missing, configures, builds.
# `planlight_build TARGET...` builds into $PLANLIGHT_BUILD (default: build/ in the checkout).

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
PLANLIGHT_BUILD=${PLANLIGHT_BUILD:-$root/build}

planlight_packages() {
    local wanted missing
    wanted=$(sed 's/#.*//' "$root/app/packages.txt" | xargs)
    missing=$(for package in $wanted; do
        [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || echo "$package"
    done | xargs)
    [ -n "$missing" ] || return 0
    local as_root=
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null || {
            echo "Missing packages: $missing. Install them as root, or install sudo." >&2
            return 1
        }
        as_root=sudo
    fi
    echo "Installing: $missing" >&2
    $as_root apt-get update -qq
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >&2
}

planlight_build() {
    planlight_packages || return 1
    local together=OFF
    if [ "${CI:-}" = true ]; then together=ON; fi
    [ -f "$PLANLIGHT_BUILD/build.ninja" ] ||
        cmake -S "$root" -B "$PLANLIGHT_BUILD" -G Ninja -DCMAKE_BUILD_TYPE=Release \
            -DPLANLIGHT_TESTS_TOGETHER=$together >&2 || return 1
    if [ "${CI:-}" != true ]; then
        ninja -C "$PLANLIGHT_BUILD" "$@" >&2
        return
    fi
    # Two files of one unit (app/unity.cmake) that do not bear each other must not stop a check of everything else.
    local log=$PLANLIGHT_BUILD/build.log units
    (set -o pipefail; ninja -k 0 -C "$PLANLIGHT_BUILD" "$@" 2>&1 | tee "$log" >&2) && return 0
    units=$(sed -n 's|^FAILED: .*/Unity/unity_\(.*\)_cxx\.cxx\.o.*|\1|p' "$log" | sort -u | paste -sd';')
    [ -n "$units" ] || return 1
    echo "To be mended; once more, each file of these units by itself: $units" >&2
    cmake -S "$root" -B "$PLANLIGHT_BUILD" -DPLANLIGHT_SPLIT="$units" >&2 || return 1
    ninja -C "$PLANLIGHT_BUILD" "$@" >&2
}
