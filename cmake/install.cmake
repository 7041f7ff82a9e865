# cmake --install: headers, libraries and a package config for find_package(forewalk).
