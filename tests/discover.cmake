# Run when a test executable has been linked: asks it for its test cases and writes the ctest entries.
# Own code and not Catch2's Catch.cmake (2.13), which stumbles over "[0, 1)" in the name of a test case, takes no
# labels from tags, and lets a case pass that it failed to find (here -w NoTests makes that an error).
# A CMake list splits at semicolons, but not between brackets: neither may stand in a name while it is in a list.
string(ASCII 1 open)
string(ASCII 2 close)
string(ASCII 3 semicolon)

# Cases run side by side, so each has a folder to itself: it starts there, and TMPDIR points there.
get_filename_component(scratch ${ENTRIES} DIRECTORY)
string(APPEND scratch /scratch/${SUITE})
file(REMOVE_RECURSE ${scratch})

set(number 0)
set(entries "")
set(cases_fast "~[slow]~[long]")
set(cases_slow "[slow]")
set(cases_long "[long]")
foreach(label fast slow long)
  set(timeout 1800)
  if(label STREQUAL fast)
    set(timeout 300)
  endif()
  execute_process(COMMAND ${EXECUTABLE} ${cases_${label}} --list-test-names-only OUTPUT_VARIABLE names RESULT_VARIABLE count)
  if(NOT count MATCHES "^[0-9]+$")  # the number of cases, or what killed it
    message(FATAL_ERROR "${EXECUTABLE} cannot list its test cases: ${count}")
  endif()
  string(REPLACE "[" "${open}" names "${names}")
  string(REPLACE "]" "${close}" names "${names}")
  string(REPLACE ";" "${semicolon}" names "${names}")
  string(REGEX MATCHALL "[^\n]+" names "${names}")
  foreach(name IN LISTS names)
    string(REPLACE "${open}" "[" name "${name}")
    string(REPLACE "${close}" "]" name "${name}")
    string(REPLACE "${semicolon}" ";" name "${name}")
    string(REGEX REPLACE "([][,\"~\\\\])" "\\\\\\1" pattern "${name}")  # for Catch2 to read as plain text
    math(EXPR number "${number} + 1")
    file(MAKE_DIRECTORY ${scratch}/${number})
    string(APPEND entries
           "add_test([==[${SUITE}: ${name}]==] [==[${EXECUTABLE}]==] [==[${pattern}]==] -w NoTests)\n"
           "set_tests_properties([==[${SUITE}: ${name}]==] PROPERTIES LABELS ${label} TIMEOUT ${timeout}\n"
           "  WORKING_DIRECTORY [==[${scratch}/${number}]==] ENVIRONMENT [==[TMPDIR=${scratch}/${number}]==])\n")
  endforeach()
endforeach()
file(WRITE ${ENTRIES} "${entries}")
