# The frame side alone, by emscripten: navmesh queries, prediction, rdw and the C interface over them
# (service/wasm). Its packages are headers only, and come from a folder of their own: the system's
# include folder as a whole is another machine's.
set(headers ${PROJECT_BINARY_DIR}/headers)
file(MAKE_DIRECTORY ${headers})
foreach(package glm tl nlohmann fmt)
  if(NOT EXISTS /usr/include/${package})
    message(FATAL_ERROR "/usr/include/${package} is missing: ./forewalk.sh wasm installs what this needs.")
  endif()
  file(CREATE_LINK /usr/include/${package} ${headers}/${package} SYMBOLIC)
endforeach()

foreach(package glm::glm tl::expected nlohmann_json::nlohmann_json fmt::fmt)
  add_library(${package} INTERFACE IMPORTED GLOBAL)
  target_include_directories(${package} INTERFACE ${headers})
endforeach()
target_compile_definitions(fmt::fmt INTERFACE FMT_HEADER_ONLY=1)
add_compile_options(-fwasm-exceptions)
add_link_options(-fwasm-exceptions)

add_subdirectory(navmesh)
add_subdirectory(prediction)
add_subdirectory(rdw)
foreach(room navmesh prediction rdw)
  target_include_directories(${room} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
endforeach()
add_subdirectory(service/capi)
add_subdirectory(service/wasm)
