# shellcheck shell=bash
# Sourced by quickstart and run-tests: installs the packages of packages.txt and configures the release build.

set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=${CALOMEL_BUILD:-$root/build/release}  # CALOMEL_BUILD: another folder

fail() {
  printf '%s\n' "$@" >&2
  exit 1
}

as_root() {
  if [ "$(id -u)" -eq 0 ]; then
    env DEBIAN_FRONTEND=noninteractive "$@"
  elif command -v sudo >/dev/null; then
    sudo env DEBIAN_FRONTEND=noninteractive "$@"
  else
    fail "These packages are missing: ${missing[*]}" "Run this once as root, or install sudo."
  fi
}

# install_packages HEADING...: installs what packages.txt lists below these headings and this machine lacks. CALOMEL_PACKAGES=present takes the machine as it is.
install_packages() {
  [ "${CALOMEL_PACKAGES:-}" != present ] || return 0
  if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
    fail "Calomel's set-up needs a system with apt (it is made for Debian 12); there is none here." \
      "Install what stands for the packages in packages.txt, then run this again with CALOMEL_PACKAGES=present in the environment."
  fi
  local first heading wanted=no
  missing=()
  while read -r first heading; do
    case $first in
      '') ;;
      '#') case " $* " in *" $heading "*) wanted=yes ;; *) wanted=no ;; esac ;;
      *)
        [ "$wanted" = yes ] || continue
        if [ "$(dpkg-query -W -f '${db:Status-Status}' "$first" 2>/dev/null)" != installed ]; then missing+=("$first"); fi
        ;;
    esac
  done <"$root/packages.txt"
  [ ${#missing[@]} -gt 0 ] || return 0
  echo "installing: ${missing[*]}"
  local install=(apt-get install -y -q --no-install-recommends "${missing[@]}")
  # The lists are fetched when they are absent or so old that a package is no longer where they say.
  if ! apt-get install -s -q --no-install-recommends "${missing[@]}" >/dev/null 2>&1 || ! as_root "${install[@]}"; then
    as_root apt-get update -q
    as_root "${install[@]}"
  fi
}

# configure ON|OFF: makes the build folder, with or without tests, with the words of CALOMEL_CONFIGURE. A folder that is there stays as it is, except that tests
# are added where they are wanted. The program is compiled in the same way with and without tests (tests/one_build), so that nothing of it is built again.
configure() {
  local words
  read -ra words <<<"${CALOMEL_CONFIGURE:-}"
  if [ ! -f "$build/build.ninja" ]; then
    (cd "$root" && cmake --preset release -B "$build" -DCALOMEL_TESTS="$1" ${words[@]+"${words[@]}"})
  elif [ "$1" = ON ] && grep -q '^CALOMEL_TESTS:BOOL=OFF$' "$build/CMakeCache.txt"; then
    cmake -DCALOMEL_TESTS=ON "$build"
  fi
}
