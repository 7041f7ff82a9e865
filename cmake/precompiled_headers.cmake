# Headers that most files of the rooms or the tests include, parsed once for each set of flags.
#
# Only headers from outside: to change one of ours rebuilds no more than it did. Every file still includes what
# it uses; builds through ccache, which needs looser settings to cache beside a precompiled header, do
# without, and so would tell of one that does not.
if(CMAKE_CXX_COMPILER_LAUNCHER MATCHES ccache)
  set(CMAKE_DISABLE_PRECOMPILE_HEADERS ON)
elseif(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  # Out of a precompiled header GCC 12 forgets that the standard library is not ours to mend, and reports what its
  # optimiser imagines there. Builds without one keep these as errors.
  add_compile_options(-Wno-error=array-bounds -Wno-error=stringop-overflow -Wno-error=stringop-overread)
endif()

# forewalk_precompile(room_headers LIBS fmt::fmt HEADERS <vector> ...) makes what others then take with
# target_precompile_headers(navmesh REUSE_FROM room_headers). Their flags must be those of this target: position
# independent as in a library or, with PROGRAMS, as in a program.
function(forewalk_precompile name)
  cmake_parse_arguments(arg "PROGRAMS" "" "LIBS;HEADERS" ${ARGN})
  set(source ${PROJECT_BINARY_DIR}/${name}.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT "// Only so that the headers have a target.\n")
  add_library(${name} OBJECT EXCLUDE_FROM_ALL ${source})
  target_link_libraries(${name} PRIVATE ${arg_LIBS} project_options)
  if(arg_PROGRAMS)
    set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
    target_compile_options(${name} PRIVATE -fPIE)
  endif()
  target_precompile_headers(${name} PRIVATE ${arg_HEADERS})
endfunction()

set(forewalk_common_headers
  <algorithm> <cmath> <filesystem> <functional> <limits> <memory> <optional> <random> <span> <string>
  <string_view> <vector> <glm/glm.hpp> <tl/expected.hpp>)
