# Run by ctest; see tests.cmake. Stops at the first step that fails, with its output.
function(must_run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE out)
  if(NOT code EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}\nended with ${code}:\n${out}")
  endif()
  set(output "${out}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK})
must_run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)

set(flags "")
if(SANITIZE)
  set(flags -DCMAKE_CXX_FLAGS=-fsanitize=${SANITIZE})
endif()
must_run(${CMAKE_COMMAND} -S ${OUTSIDE} -B ${WORK}/build -G ${GENERATOR}
  -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_PREFIX_PATH=${WORK}/prefix ${flags})
must_run(${CMAKE_COMMAND} --build ${WORK}/build)

# Four lines: in the west corridor of the office, eyes 1.7 m above its floor, with several ways ahead.
must_run(${WORK}/build/first_walk ${SCENE})
string(REGEX MATCHALL "at \\([0-9.]+, 1\\.70, [0-9.]+\\), [0-9]+ ways ahead" frames "${output}")
list(LENGTH frames count)
if(NOT count EQUAL 4)
  message(FATAL_ERROR "expected four frames at eye height 1.70 m, got:\n${output}")
endif()
foreach(frame IN LISTS frames)
  string(REGEX MATCH "([0-9]+) ways" ways "${frame}")
  if(CMAKE_MATCH_1 LESS 3)
    message(FATAL_ERROR "expected at least three ways out of the corridor, got:\n${output}")
  endif()
endforeach()
