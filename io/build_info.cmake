# Writes build_info.hpp for provenance.cpp, at every build because the git revision may have moved; the file
# keeps its time when nothing changed. Without git or outside a checkout of its own the revision is "unknown".
set(revision "unknown")
find_program(GIT git)
if(GIT)
  set(git ${GIT} -c safe.directory=* -C ${SOURCE_DIR})
  execute_process(COMMAND ${git} rev-parse --show-toplevel
                  OUTPUT_VARIABLE top OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(top STREQUAL SOURCE_DIR)  # not some other project's repository around an unpacked archive
    execute_process(COMMAND ${git} describe --always --dirty --abbrev=12 --exclude=*
                    OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    if(described)
      set(revision "${described}")
    endif()
  endif()
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT [[
#pragma once
#define HOURGLASS_VERSION "@VERSION@"
#define HOURGLASS_REVISION "@revision@"
#define HOURGLASS_COMPILER "@COMPILER@"
#define HOURGLASS_FLAGS "@FLAGS@"
#define HOURGLASS_BUILD_TYPE "@BUILD_TYPE@"
]] @ONLY)
