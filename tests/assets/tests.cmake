# Tests of assets/, one forewalk_test() a file.
forewalk_test(assets/generator_test.cpp LIBS scene_generator)
forewalk_test(assets/scenario_test.cpp LIBS forewalk::navmesh_build forewalk::prediction nlohmann_json::nlohmann_json)
