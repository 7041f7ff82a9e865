# Our own compile settings. Linked PRIVATE everywhere, so they never reach our users.
add_library(project_options INTERFACE)
target_compile_features(project_options INTERFACE cxx_std_20)
target_compile_options(project_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual
  -ffp-contract=off  # same input, same output, to the last bit (DESIGN.md section 2)
  -fno-math-errno    # sqrt is one instruction; results stay what they are
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>  # GCC 12 sees ghosts in "text" + std::string (GCC bug 105651)
  $<$<BOOL:${FOREWALK_WERROR}>:-Werror>)

if(FOREWALK_SANITIZE)
  add_compile_options(-fsanitize=${FOREWALK_SANITIZE} -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${FOREWALK_SANITIZE})
  if(FOREWALK_SANITIZE MATCHES thread)
    # Asio fences beside the locks that order its handlers; the sanitizer knows the locks only.
    add_compile_options($<$<CXX_COMPILER_ID:GNU>:-Wno-tsan>)
  endif()
  if(FOREWALK_SANITIZE MATCHES undefined)
    add_compile_options(-fno-sanitize-recover=all)
  endif()
endif()

if(FOREWALK_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link)  # coverage for libFuzzer, in our libraries too
endif()
