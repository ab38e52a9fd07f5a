# The engine as a shared library in three builds: for any x86-64, for AVX2 and for AVX-512. The dynamic loader takes the
# best that the machine can run: glibc (2.33 and later) looks into glibc-hwcaps/x86-64-v4 and -v3 of a directory first.
# Each build calls its own copies of the kernels (-Bsymbolic), never those that another file compiled for less.
set(lib ${PROJECT_BINARY_DIR}/lib)
function(add_engine name directory)  # add_engine(NAME DIRECTORY flags...)
  add_library(${name} SHARED ${solver_sources})
  target_link_libraries(${name} PUBLIC options Eigen3::Eigen fmt::fmt)
  target_compile_options(${name} PRIVATE ${ARGN})
  target_link_options(${name} PRIVATE -Wl,-Bsymbolic)
  set_target_properties(${name} PROPERTIES OUTPUT_NAME hourglass_solver LIBRARY_OUTPUT_DIRECTORY ${directory})
endfunction()
add_engine(hourglass_solver ${lib} -march=x86-64)
add_engine(hourglass_solver_v3 ${lib}/glibc-hwcaps/x86-64-v3 -march=x86-64-v3)
add_engine(hourglass_solver_v4 ${lib}/glibc-hwcaps/x86-64-v4 -march=x86-64-v4 -mprefer-vector-width=512)
add_dependencies(hourglass_solver hourglass_solver_v3 hourglass_solver_v4)
# A path that LD_LIBRARY_PATH can override, so that tests choose.
target_link_options(hourglass_solver INTERFACE -Wl,--enable-new-dtags)
