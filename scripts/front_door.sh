# shellcheck shell=bash disable=SC2154
# Sourced by ./hourglass and ./check, which set `root`: all that stands between a fresh Debian and a built tree.
# What the tools say goes to the log; what the user has to know goes to stderr. Standard output is not touched.
me=$(basename "$(readlink -f "$0")")
log=$root/build/$me.log

say() { echo "$me: $*" >&2; }

# quietly WHAT COMMAND...: if the command fails, shows the end of the log and exits 1.
quietly() {
  local what=$1 watcher='' status=0
  shift
  say "$what"
  echo "== $*" >>"$log"
  if [ -t 2 ]; then  # on a terminal, show that something moves
    while sleep 1 && kill -0 $$; do printf '\r\033[K%.78s' "$(tail -n 1 "$log")"; done >&2 &
    watcher=$!
  fi
  "$@" >>"$log" 2>&1 </dev/null || status=$?
  if [ -n "$watcher" ]; then
    kill "$watcher"
    printf '\r\033[K' >&2
  fi
  [ $status = 0 ] && return
  tail -n 40 "$log" >&2
  say "failed: $what (status $status; the whole log is $log)"
  exit 1
}

# need_packages program|all: installs what packages.txt names and this machine lacks; with `program`, without the
# packages below the marker "# tests". Where there is no dpkg, what is missing shows when CMake looks for it.
need_packages() {
  command -v dpkg-query >/dev/null || return 0
  local wanted missing as_root=()
  wanted=$(if [ "$1" = all ]; then cat "$root/packages.txt"; else sed '/^# tests/,$d' "$root/packages.txt"; fi |
    grep -v '^#' | LC_ALL=C sort)
  missing=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' | sed -n 's/^installed //p' | LC_ALL=C sort -u |
    LC_ALL=C comm -13 - <(echo "$wanted") | tr '\n' ' ')
  [ -n "$missing" ] || return 0
  if [ "$(id -u)" != 0 ]; then
    if ! sudo -n true 2>/dev/null; then
      say "these Debian packages are missing, and installing them needs root. As root, run"
      echo "  apt-get update && apt-get install --no-install-recommends $missing" >&2
      say "and then this command again."
      exit 1
    fi
    as_root=(sudo -n)
  fi
  # shellcheck disable=SC2086  # $missing is a list
  quietly "installing Debian packages: $missing" apt_install $missing
}

apt_install() {
  local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -y -o DPkg::Lock::Timeout=600)
  local install=("${apt[@]}" install --no-install-recommends "$@")
  "${install[@]}" || { "${apt[@]}" update && "${install[@]}"; }  # package lists may be empty or out of date
}

# build PRESET TARGET [OPTION...]: configures build/PRESET with the options if it is new, and builds TARGET.
build() {
  local tree=$root/build/$1 target=$2
  # A tree that moved with its checkout would build the old place.
  grep -qsxF "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$tree/CMakeCache.txt" || rm -rf "$tree"
  [ -f "$tree/build.ninja" ] || quietly "configuring $tree" cmake -S "$root" --preset "$1" "${@:3}"
  quietly "building $tree" cmake --build "$tree" --target "$target"
}

# Only one of us at a time; the lock goes when descriptor 9 is closed.
mkdir -p "$root/build"
exec 9>"$root/build/lock"
flock -n 9 || { say "waiting for another build to finish"; flock 9; }
: >"$log"
