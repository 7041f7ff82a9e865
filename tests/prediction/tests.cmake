# Tests of prediction/, one forewalk_test() a file.
forewalk_test(prediction/predict_test.cpp LIBS forewalk::prediction)
forewalk_test(prediction/prediction_graph_test.cpp LIBS forewalk::prediction)
forewalk_test(prediction/allocation_test.cpp LIBS forewalk::prediction)
forewalk_test(prediction/dump_test.cpp LIBS forewalk::prediction_dump nlohmann_json::nlohmann_json)
forewalk_test(prediction/prediction_readme_test.cpp LIBS forewalk::prediction)
forewalk_test(prediction/tiles_test.cpp LIBS forewalk::prediction forewalk::navmesh_build)
