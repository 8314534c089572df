# shellcheck shell=bash
# Sourced by quickstart and run-tests: the packages of packages.txt, and the release build.

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

# Installs what packages.txt lists and this machine lacks. CALOMEL_PACKAGES=present takes the machine as it is.
install_packages() {
  [ "${CALOMEL_PACKAGES:-}" != present ] || return 0
  if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
    fail "Calomel's set-up needs a system with apt (it is made for Debian 12); there is none here." \
      "Install what stands for the packages in packages.txt, then run this again with CALOMEL_PACKAGES=present in the environment."
  fi
  local package
  missing=()
  while read -r package; do
    case $package in '' | '#'*) continue ;; esac
    if [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" != installed ]; then missing+=("$package"); fi
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

# build TARGET...: configures at the first call, with the words of CALOMEL_CONFIGURE; ninja then makes what has changed.
build() {
  local words
  read -ra words <<<"${CALOMEL_CONFIGURE:-}"
  [ -f "$build/build.ninja" ] || (cd "$root" && cmake --preset release -B "$build" ${words[@]+"${words[@]}"})
  ninja -C "$build" "$@"
}
