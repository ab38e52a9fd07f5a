#!/bin/bash
# ./hourglass on a project of one file that prints its arguments and returns 7: what it builds, when, and what it says.
set -eu
source=$(dirname "$(readlink -f "$0")")/..
home=$(mktemp -d)
trap 'rm -rf "$home"' EXIT
cp -r "$source/hourglass" "$source/scripts" "$source/CMakePresets.json" "$home"
cd "$home"
echo dpkg >packages.txt
cat >CMakeLists.txt <<'END'
cmake_minimum_required(VERSION 3.22)
project(hourglass CXX)
add_executable(hourglass main.cpp)
END
cat >main.cpp <<'END'
#include <cstdio>
int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) std::printf("[%s]", argv[i]);
  return 7;
}
END

fail() { echo "FAILED: $*; standard error was:"; cat "$home/said"; exit 1; }

# call STATUS OUTPUT COMMAND...: both have to match; what was said on stderr is in said.
call() {
  local status=0 output
  output=$("${@:3}" 2>"$home/said") || status=$?
  [ $status = "$1" ] || fail "${*:3}: status $status, not $1"
  [ "$output" = "$2" ] || fail "${*:3}: printed '$output', not '$2'"
}
builds() { grep -q 'building' said || fail "it did not build"; }
is_silent() { [ ! -s said ] || fail "it spoke"; }

call 7 '[run][a b][*][]' ./hourglass run 'a b' '*' ''
builds
call 7 '[again]' ./hourglass again
is_silent

ln -s "$home/hourglass" link
call 7 '[x]' env -C / "$home/link" x
is_silent

echo '// changed' >>main.cpp
call 7 '[x]' ./hourglass x
builds

echo '// changed for three at once' >>main.cpp
for k in 1 2 3; do (./hourglass $k >out.$k 2>said.$k || [ $? = 7 ]) & done
wait
[ "$(cat out.1 out.2 out.3)" = '[1][2][3]' ] || fail "three at once printed $(cat out.?)"
[ "$(cat said.? | grep -c building)" = 1 ] || fail "three at once built more than once: $(cat said.?)"

cp main.cpp sound.cpp
echo 'no C++' >>main.cpp
call 1 '' ./hourglass x
grep -q 'error:' said || fail "no sign of the compiler's error"
grep -q 'build/hourglass.log' said || fail "no word of the log"
mv sound.cpp main.cpp
call 7 '[x]' ./hourglass x

if [ "$(id -u)" != 0 ] && ! sudo -n true 2>/dev/null; then
  echo no-such-package >>packages.txt
  call 1 '' ./hourglass x
  grep -q 'apt-get install .*no-such-package' said || fail "it does not say what to install"
fi
echo "passed"
