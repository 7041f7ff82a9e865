# Run by ctest; see tests.cmake.
file(READ ${README} readme)
foreach(part CMakeLists.txt first_walk.cpp)
  file(READ ${OUTSIDE}/${part} code)
  string(FIND "${readme}" "${code}" at)
  if(at EQUAL -1)
    message(FATAL_ERROR "README.md does not show ${OUTSIDE}/${part} as it is. Copy it there.")
  endif()
endforeach()
